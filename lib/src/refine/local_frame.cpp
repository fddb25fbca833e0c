#include "refine/local_frame.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/box.h"
#include "base/sort_unique.h"

namespace tufa::refine {
namespace {

// Voxels. A mesh no larger is taken as it is: its rounding is that of the sums that distances are.
constexpr double kNear = 4096;
// A void is found by cells of so many voxels that hold nothing. So many of them stay: no vertex
// moves by more than the largest tolerance, a quarter of them.
constexpr double kCell = 512;
constexpr std::int64_t kLeftCells = 8;
constexpr double kLargestAmongVoids = kCell * kLeftCells / 4;
// From here on, voxels from the middle, single precision tells places apart by a 32nd of a voxel,
// and triangles would lose their shapes: nothing is reduced.
constexpr double kLargestFrame = 262144;

double lastDigitOf(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(std::nextafter(f, std::numeric_limits<float>::infinity()) - f);
}

}  // namespace

LocalFrame::LocalFrame(const std::vector<Position>& positions, double voxelSize, base::Job& job,
                       const base::TriangleView& longTriangles)
    : voxelSize_(voxelSize), perVoxel_(1 / voxelSize) {
  base::Box box = base::Box::empty();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    job.pollCancelled(i);
    box.add(Vec3(positions[i]));
  }
  if (box.isEmpty()) return;
  size_ = box.size().length() * perVoxel_;
  for (int axis = 0; axis < 3; ++axis) {
    if (box.size()[axis] * perVoxel_ <= 2 * kNear) continue;
    findVoids(positions, longTriangles, axis, box.lower[axis], job);
    if (!voids_[axis].empty()) box.upper[axis] -= voids_[axis].back().by;
  }
  middle_ = box.centre();
  const Vec3 half = box.size() * (0.5 * perVoxel_);
  const double farthest = std::max({half[0], half[1], half[2]});
  isTooLarge_ = farthest >= kLargestFrame;
  // Half of the last digit along each axis, of each of the two meshes.
  if (farthest >= kNear) rounding_ = std::sqrt(3.0) * lastDigitOf(farthest);
}

double LocalFrame::within(double tolerance) const {
  if (isTooLarge_) return 0;
  const double most = hasVoids_ ? std::min(tolerance, kLargestAmongVoids) : tolerance;
  return std::max(0.0, most - rounding_);
}

// Into the frame, but for its scale, or out of it.
Vec3 LocalFrame::moved(Vec3 p, const Voids& voids, double direction) const {
  if (direction < 0) p = p - middle_;
  for (int axis = 0; axis < 3; ++axis) {
    if (voids[axis].empty()) continue;
    const double at = direction < 0 ? p[axis] + middle_[axis] : p[axis];
    const auto above = std::upper_bound(voids[axis].begin(), voids[axis].end(), at,
                                        [](double x, const Void& v) { return x < v.at; });
    if (above != voids[axis].begin()) p[axis] += direction * (above - 1)->by;
  }
  return p;
}

void LocalFrame::findVoids(const std::vector<Position>& positions,
                           const base::TriangleView& longTriangles, int axis, double lower,
                           base::Job& job) {
  constexpr std::size_t kEnough = std::size_t{1} << 20;
  const double cell = kCell * voxelSize_;
  std::vector<std::int64_t> cells;  // that hold something
  std::size_t sorted = 0;
  const auto cellOf = [&](VertexIndex v) {
    return static_cast<std::int64_t>((Vec3(positions[v])[axis] - lower) / cell);
  };
  const auto add = [&](std::int64_t at) {
    if (!cells.empty() && cells.back() == at) return;
    cells.push_back(at);
    if (cells.size() < 2 * sorted + kEnough) return;
    base::sortUnique(cells);
    sorted = cells.size();
  };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    job.pollCancelled(i);
    add(cellOf(static_cast<VertexIndex>(i)));
  }
  for (std::size_t t = 0; t < longTriangles.size(); ++t) {
    job.pollCancelled(t);
    const auto v = longTriangles[t].vertices;
    const auto [low, high] = std::minmax({cellOf(v[0]), cellOf(v[1]), cellOf(v[2])});
    for (std::int64_t at = low; at <= high; ++at) add(at);
  }
  base::sortUnique(cells);
  double by = 0;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const std::int64_t empty = cells[i] - cells[i - 1] - 1;
    if (empty <= kLeftCells) continue;
    const double left = static_cast<double>(kLeftCells) * cell;
    const double end = lower + static_cast<double>(cells[i]) * cell;
    by += static_cast<double>(empty - kLeftCells) * cell;
    hasVoids_ = true;
    voids_[axis].push_back({end - left / 2, by});
    closedVoids_[axis].push_back({end - by - left / 2, by});
  }
}

}  // namespace tufa::refine
