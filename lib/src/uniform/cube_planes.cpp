#include "uniform/cube_planes.h"

#include <algorithm>
#include <cmath>

namespace tufa::uniform {

using grid::BlockSamples;

namespace {

// A gradient's length may differ from 1 by this, and the samples from linear by this many voxels:
// what a curvature radius of two or three voxels does.
constexpr float kLengthTolerance = 0.06F;
constexpr float kLargestResidual = 0.06F;

}  // namespace

const CubePlane* CubePlanes::at(int x, int y, int z) {
  const int index = ((x + 1) * kSize + y + 1) * kSize + z + 1;
  if (states_[index] == State::Unknown) {
    const std::optional<CubePlane> plane = fit(x, y, z);
    states_[index] = plane ? State::Plane : State::None;
    if (plane) planes_[index] = *plane;
  }
  return states_[index] == State::Plane ? &planes_[index] : nullptr;
}

std::optional<CubePlane> CubePlanes::fit(int x, int y, int z) const {
  std::array<float, 8> values;
  float mean = 0;
  Vector gradient{};
  for (int corner = 0; corner < 8; ++corner) {
    const int dx = corner >> 2, dy = (corner >> 1) & 1, dz = corner & 1;
    const float value = samples_[BlockSamples::index(x + dx, y + dy, z + dz)];
    if (!(value > scale_.bandInside && value < scale_.bandOutside)) return {};
    values[corner] = value;
    mean += value / 8;
    gradient[0] += (dx != 0 ? value : -value) / 4;
    gradient[1] += (dy != 0 ? value : -value) / 4;
    gradient[2] += (dz != 0 ? value : -value) / 4;
  }
  const float unit = std::sqrt(scale_.squaredLength(gradient[0], gradient[1], gradient[2]));
  if (std::abs(unit - 1) > kLengthTolerance) return {};
  CubePlane plane;
  for (int corner = 0; corner < 8; ++corner) {
    const float dx = static_cast<float>(corner >> 2) - 0.5F;
    const float dy = static_cast<float>((corner >> 1) & 1) - 0.5F;
    const float dz = static_cast<float>(corner & 1) - 0.5F;
    const float linear = mean + gradient[0] * dx + gradient[1] * dy + gradient[2] * dz;
    plane.residual = std::max(plane.residual, std::abs(values[corner] - linear));
  }
  if (plane.residual > kLargestResidual) return {};
  const float length = std::sqrt(dot(gradient, gradient));
  const std::array<float, 3> middle = {static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F,
                                       static_cast<float>(z) + 0.5F};
  for (int i = 0; i < 3; ++i) {
    plane.normal[i] = gradient[i] / length;
    plane.foot[i] = middle[i] - mean / length * plane.normal[i];
  }
  return plane;
}

}  // namespace tufa::uniform
