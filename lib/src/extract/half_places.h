#pragma once

#include <array>

#include "extract/derive_tetrahedra.h"
#include "grid/samples.h"
#include "grid/volume.h"
#include "uniform/crossings.h"

namespace tufa::extraction {

/// The lattice points around a half place: one for each even coordinate, two for each odd one.
struct PointsAround {
  std::array<int, 8> steps{};  ///< to be added to the BlockSamples index of the cell
  int count = 1;
  std::array<int, 3> upperBit{};  ///< of the index of a step, set where it is up on that axis

  constexpr PointsAround() = default;
  constexpr explicit PointsAround(const HalfPlace& place) {
    for (int axis = 0; axis < 3; ++axis) {
      const int stride = grid::BlockSamples::stride(axis);
      const bool between = (place[axis] & 1) != 0;
      const int lower = (place[axis] - (between ? 1 : 0)) / 2;
      for (int i = 0; i < count; ++i) steps[i] += lower * stride;
      if (!between) continue;
      upperBit[axis] = count;
      for (int i = 0; i < count; ++i) steps[count + i] = steps[i] + stride;
      count *= 2;
    }
  }
};

/// The mean of the samples around a half place of a cell, always summed in the same order.
template <PointsAround kAround>
float valueAt(const grid::BlockSamples& samples, int cell) {
  constexpr float kShare = 1 / static_cast<float>(kAround.count);
  float sum = 0;
  for (int i = 0; i < kAround.count; ++i) sum += kShare * samples[cell + kAround.steps[i]];
  return sum;
}

/// The gradient at a half place: the mean of differences across it on the axes where it is between
/// lattice points, of central differences on the others.
template <PointsAround kAround>
uniform::Vector gradientAt(const grid::BlockSamples& samples, int cell) {
  uniform::Vector gradient{};
  for (int axis = 0; axis < 3; ++axis) {
    const int stride = grid::BlockSamples::stride(axis);
    const int upper = kAround.upperBit[axis];
    float sum = 0;
    for (int i = 0; i < kAround.count; ++i) {
      const int at = cell + kAround.steps[i];
      if (upper == 0) {
        sum += samples[at + stride] - samples[at - stride];
      } else {
        sum += (i & upper) != 0 ? 2 * samples[at] : -2 * samples[at];
      }
    }
    gradient[axis] = sum / static_cast<float>(2 * kAround.count);
    if (upper != 0) gradient[axis] *= 2;
  }
  return gradient;
}

/// Places the vertices of the edges of one kind, which is known to the compiler: Split::kEdges
/// holds it at `kKind`.
template <class Split, int kKind>
class EdgePlacer {
 public:
  EdgePlacer(const grid::Volume& volume, const grid::BlockSamples& samples)
      : volume_(volume), samples_(samples) {}

  /// Writes the position of the crossing of the edge of a cell, by linear interpolation, and if
  /// there is room for it the normal, by that of the gradients at both ends.
  void place(const Coord& origin, const std::array<int, 3>& cell, std::size_t vertex,
             Mesh& mesh) const {
    const int lowest = grid::BlockSamples::index(cell[0], cell[1], cell[2]);
    const float a = valueAt<kFrom>(samples_, lowest);
    const float b = valueAt<kTo>(samples_, lowest);
    using Finder = uniform::CrossingFinder;
    const float along = Finder::keptOffEnds(Finder::linearRoot(a, b));
    std::array<double, 3> at;
    for (int axis = 0; axis < 3; ++axis) {
      const int step = kEdge.to[axis] - kEdge.from[axis];
      at[axis] = cell[axis] + 0.5 * (kEdge.from[axis] + step * static_cast<double>(along));
    }
    mesh.positions[vertex] = volume_.affine.position(origin, at[0], at[1], at[2]);
    if (mesh.normals.empty()) return;
    const uniform::Vector ga = gradientAt<kFrom>(samples_, lowest);
    const uniform::Vector gb = gradientAt<kTo>(samples_, lowest);
    uniform::Vector g;
    for (int i = 0; i < 3; ++i) g[i] = ga[i] + along * (gb[i] - ga[i]);
    mesh.normals[vertex] = volume_.affine.normal(g[0], g[1], g[2]);
  }

 private:
  static constexpr EdgeKind kEdge = Split::kEdges.kinds[kKind];
  static constexpr PointsAround kFrom{kEdge.from}, kTo{kEdge.to};

  const grid::Volume& volume_;
  const grid::BlockSamples& samples_;
};

}  // namespace tufa::extraction
