#include "base/bvh.h"

#include <cmath>
#include <functional>

#include "base/bits.h"
#include "base/huge_pages.h"
#include "base/parallel.h"
#include "base/parallel_sort.h"

namespace tufa::base {
namespace {

/// The place of a box's centre on the Morton curve through `all`. One scale serves all axes, so
/// that neighbours on the curve are neighbours in a flat volume too.
std::uint64_t mortonCode(const Box& box, const Box& all, double scale) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double centre = 0.5 * box.lower[axis] + 0.5 * box.upper[axis];
    const double place = std::clamp((centre - all.lower[axis]) * scale, 0.0, 2097151.0);
    // Coordinates near the largest double overflow to NaN here; any place will do for them.
    const auto cell = std::isfinite(place) ? static_cast<std::uint64_t>(place) : 0;
    code |= spreadBits(cell) << axis;
  }
  return code;
}

}  // namespace

Bvh::Bvh(std::vector<Box> boxes, Job& job) {
  if (boxes.empty()) return;
  resizeLarge(items_, boxes.size(), job);
  resizeLarge(boxes_, boxes.size(), job);
  Box all = Box::empty();
  for (const Box& box : boxes) all.add(box);
  const Vec3 size = all.upper - all.lower;
  const double largest = std::max({size[0], size[1], size[2]});
  const double scale = largest > 0 ? 2097151.0 / largest : 0;

  std::vector<std::pair<std::uint64_t, std::uint32_t>> codes;
  resizeLarge(codes, boxes.size(), job);
  job.forRanges(boxes.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      codes[i] = {mortonCode(boxes[i], all, scale), static_cast<std::uint32_t>(i)};
    }
  });
  parallelSort(codes.begin(), codes.end(), std::less<>());
  job.forRanges(boxes.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      items_[i] = codes[i].second;
      boxes_[i] = boxes[items_[i]];
    }
  });
  resizeLarge(nodes_, 2 * leafCount() - 1, job);
  fill(root());
}

void Bvh::fill(const Node& node) {
  Box box = Box::empty();
  if (node.leaves == 1) {
    const std::size_t end = std::min((node.firstLeaf + 1) * kLeafSize, items_.size());
    for (std::size_t i = node.firstLeaf * kLeafSize; i < end; ++i) box.add(boxes_[i]);
  } else {
    constexpr std::size_t kSequentialLeaves = 4096;
    if (node.leaves > kSequentialLeaves) {
      runBoth([&] { fill(left(node)); }, [&] { fill(right(node)); });
    } else {
      fill(left(node));
      fill(right(node));
    }
    box.add(boxOf(left(node)));
    box.add(boxOf(right(node)));
  }
  nodes_[node.index] = box;
}

}  // namespace tufa::base
