#include "reduce/part_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "base/huge_pages.h"
#include "base/parallel.h"

namespace tufa::reduce {
namespace {

// Vertices of which a cut asks for its quantile. Parts then differ in size by a few percent.
constexpr std::size_t kAsked = 1024;
// Voxels on both sides of a plane that count as flat, if one in so many of those asked lies there.
constexpr float kFlat = 0.01f;
constexpr std::size_t kFewOfFlat = 16;
// Vertices that a thread sorts to the two sides of a cut at a time.
constexpr Index kBlock = 16384;
// A part of the tree from which on its two sides are split at the same time.
constexpr Index kEnough = 1 << 16;

Box3f everywhere() {
  Box3f all;
  std::swap(all.lower, all.upper);
  return all;
}

std::array<Box3f, 2> halves(const Box3f& box, int axis, float plane) {
  std::array<Box3f, 2> half{box, box};
  half[0].upper[axis] = plane, half[1].lower[axis] = plane;
  return half;
}

// Mixes the bits of a number (the finalizer of MurmurHash3).
std::uint32_t mixed(std::uint32_t bits) {
  bits = (bits ^ bits >> 16) * 0x85ebca6bu;
  bits = (bits ^ bits >> 13) * 0xc2b2ae35u;
  return bits ^ bits >> 16;
}

class Splitter {
 public:
  Splitter(std::span<const Vec3f> positions, base::Job& job) : positions_(positions), job_(job) {
    base::resizeLarge(order_, positions.size(), job);
    base::resizeLarge(scratch_, positions.size(), job);
    std::iota(order_.begin(), order_.end(), Index{0});
  }

  PartTree split(std::span<const Index> samplesAt, const PartSize& size, float share) {
    samplesAt_ = samplesAt, size_ = size, share_ = share;
    Box3f extent;
    for (const Vec3f& p : positions_) extent.add(p);
    PartTree tree = split({0, count(), extent}, everywhere());
    tree.ranges.insert(tree.ranges.begin(), 0);
    tree.vertices = std::move(order_);
    return tree;
  }

  PartTree splitAlong(const std::vector<PartTree::Node>& nodes) {
    PartTree tree;
    tree.nodes = nodes;
    tree.boxes.resize(nodes.size() / 2 + 1);
    tree.ranges.resize(tree.boxes.size() + 1);
    splitAlong(tree, 0, {0, count(), {}}, everywhere());
    tree.vertices = std::move(order_);
    return tree;
  }

 private:
  // Some of the order, and the box of the vertices there.
  struct Some {
    Index begin, end;
    Box3f extent;
    [[nodiscard]] Index size() const { return end - begin; }
  };

  [[nodiscard]] Index count() const { return static_cast<Index>(order_.size()); }
  [[nodiscard]] float at(Index place, int axis) const { return positions_[order_[place]][axis]; }

  PartTree split(const Some& some, const Box3f& box);
  static Index add(const PartTree& part, PartTree& tree);
  void splitAlong(PartTree& tree, Index node, const Some& some, const Box3f& box);
  [[nodiscard]] bool isPart(const Some& some) const;
  [[nodiscard]] float quantile(const Some& some, int axis) const;
  [[nodiscard]] static float besideFlat(float at, const std::vector<float>& coordinates);
  [[nodiscard]] float leastAbove(const Some& some, int axis) const;
  std::array<Some, 2> sides(const Some& some, int axis, float plane);
  std::array<Some, 2> sidesOfBlock(const Some& block, int axis, float plane);
  // Runs both, at the same time where there is enough to do.
  template <class First, class Second>
  static void both(const Some& some, const First& first, const Second& second) {
    if (some.size() >= kEnough) return base::runBoth(first, second);
    first();
    second();
  }

  std::span<const Vec3f> positions_;
  base::Job& job_;
  std::vector<Index> order_, scratch_;
  std::span<const Index> samplesAt_;
  PartSize size_;
  float share_ = 0;
};

bool Splitter::isPart(const Some& some) const {
  if (some.size() > size_.vertices) return false;
  if (samplesAt_.empty() || some.size() <= size_.leastVertices) return true;
  std::size_t samples = 0;
  for (Index i = some.begin; i < some.end; ++i) samples += samplesAt_[order_[i]];
  return samples <= size_.samples;
}

// The coordinate that `share_` of the vertices are below, as far as some that are spread over the
// order tell.
float Splitter::quantile(const Some& some, int axis) const {
  const std::size_t count = some.size(), asked = std::min(count, kAsked);
  std::vector<float> coordinates(asked);
  for (std::size_t i = 0; i < asked; ++i) {
    const std::size_t begin = i * count / asked, end = (i + 1) * count / asked;
    const std::size_t place = begin + mixed(static_cast<std::uint32_t>(i)) % (end - begin);
    coordinates[i] = at(some.begin + static_cast<Index>(place), axis);
  }
  const auto middle =
      coordinates.begin() + static_cast<std::ptrdiff_t>(static_cast<float>(asked) * share_);
  std::nth_element(coordinates.begin(), middle, coordinates.end());
  return besideFlat(*middle, coordinates);
}

// A coordinate, or one beside it if a flat face lies there whose vertices rounding has moved off
// their plane: a cut between them would part the face, and none of its vertices could move.
float Splitter::besideFlat(float at, const std::vector<float>& coordinates) {
  std::size_t near = 0, same = 0;
  bool isLowest = true, isHighest = true;
  for (const float x : coordinates) {
    near += std::abs(x - at) <= kFlat ? 1 : 0;
    same += x == at ? 1 : 0;
    isLowest &= x >= at - kFlat, isHighest &= x <= at + kFlat;
  }
  if (near == same || near * kFewOfFlat < coordinates.size() || (isLowest && isHighest)) return at;
  return isLowest ? at + kFlat : at - kFlat;
}

// The least coordinate that is not the least of all.
float Splitter::leastAbove(const Some& some, int axis) const {
  float least = some.extent.upper[axis];
  for (Index i = some.begin; i < some.end; ++i) {
    const float x = at(i, axis);
    if (x > some.extent.lower[axis]) least = std::min(least, x);
  }
  return least;
}

// The lower side first. Vertices on the plane are the upper side's. The order stays as it is on
// either side, so that vertices that are neighbours stay neighbours in memory.
std::array<Splitter::Some, 2> Splitter::sides(const Some& some, int axis, float plane) {
  const std::size_t blocks = (some.size() + kBlock - 1) / kBlock;
  std::vector<std::array<Some, 2>> of(blocks);
  const auto forBlocks = [&](const auto& body) {
    if (blocks == 1) return body(0);
    job_.forRanges(blocks, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  };
  forBlocks([&](std::size_t i) {
    const Index begin = some.begin + static_cast<Index>(i) * kBlock;
    of[i] = sidesOfBlock({begin, std::min(begin + kBlock, some.end), {}}, axis, plane);
  });
  std::array<Some, 2> all{Some{some.begin, some.begin, {}}, Some{}};
  for (const auto& block : of) all[0].end += block[0].size();
  all[1] = {all[0].end, some.end, {}};
  std::vector<std::array<Index, 2>> to(blocks);
  std::array<Index, 2> next{all[0].begin, all[1].begin};
  for (std::size_t i = 0; i < blocks; ++i) {
    to[i] = next;
    for (std::size_t side = 0; side < 2; ++side) {
      next[side] += of[i][side].size();
      all[side].extent.add(of[i][side].extent);
    }
  }
  forBlocks([&](std::size_t i) {
    for (std::size_t side = 0; side < 2; ++side) {
      const Some& from = of[i][side];
      std::copy(scratch_.begin() + from.begin, scratch_.begin() + from.end,
                order_.begin() + to[i][side]);
    }
  });
  return all;
}

// Leaves the sides of a block in the scratch memory, in its place there.
std::array<Splitter::Some, 2> Splitter::sidesOfBlock(const Some& block, int axis, float plane) {
  Box3f lower, upper;
  Index low = block.begin, high = block.end;
  for (Index i = block.begin; i < block.end; ++i) {
    const Vec3f& p = positions_[order_[i]];
    if (p[axis] < plane) {
      scratch_[low++] = order_[i];
      lower.add(p);
    } else {
      scratch_[--high] = order_[i];
      upper.add(p);
    }
  }
  std::reverse(scratch_.begin() + high, scratch_.begin() + block.end);
  return {Some{block.begin, low, lower}, Some{high, block.end, upper}};
}

PartTree Splitter::split(const Some& some, const Box3f& box) {
  const Vec3f d = some.extent.upper - some.extent.lower;
  const int axis = d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
  if (isPart(some) || !(d[axis] > 0)) return {{{-1, 0, 0, 0}}, {box}, {some.end}, {}};
  job_.checkCancelled(0, 1);
  float plane = quantile(some, axis);
  if (plane == some.extent.lower[axis]) plane = leastAbove(some, axis);
  const std::array<Some, 2> side = sides(some, axis, plane);
  // On the plane of the vertices of a face across the axis, these could not move.
  const float most = side[0].extent.upper[axis], least = side[1].extent.lower[axis];
  const float middle = most + (least - most) / 2;
  if (middle > most) plane = middle;
  const std::array<Box3f, 2> half = halves(box, axis, plane);
  std::array<PartTree, 2> trees;
  both(
      some, [&] { trees[0] = split(side[0], half[0]); },
      [&] { trees[1] = split(side[1], half[1]); });
  PartTree tree{{{axis, plane, 0, 0}}, {}, {}, {}};
  tree.nodes[0].low = add(trees[0], tree);
  tree.nodes[0].high = add(trees[1], tree);
  return tree;
}

// Returns where the root of the added tree is now.
Index Splitter::add(const PartTree& part, PartTree& tree) {
  const auto root = static_cast<Index>(tree.nodes.size()), parts = static_cast<Index>(tree.size());
  for (PartTree::Node node : part.nodes) {
    node.low += node.axis < 0 ? parts : root;
    node.high += node.axis < 0 ? 0 : root;
    tree.nodes.push_back(node);
  }
  tree.boxes.insert(tree.boxes.end(), part.boxes.begin(), part.boxes.end());
  tree.ranges.insert(tree.ranges.end(), part.ranges.begin(), part.ranges.end());
  return root;
}

void Splitter::splitAlong(PartTree& tree, Index node, const Some& some, const Box3f& box) {
  const PartTree::Node n = tree.nodes[node];
  if (n.axis < 0) {
    tree.boxes[n.low] = box, tree.ranges[n.low + 1] = some.end;
    return;
  }
  const std::array<Some, 2> side = sides(some, n.axis, n.at);
  const std::array<Box3f, 2> half = halves(box, n.axis, n.at);
  both(
      some, [&] { splitAlong(tree, n.low, side[0], half[0]); },
      [&] { splitAlong(tree, n.high, side[1], half[1]); });
}

}  // namespace

PartTree splitIntoParts(std::span<const Vec3f> positions, std::span<const Index> samplesAt,
                        const PartSize& size, float share, base::Job& job) {
  return Splitter(positions, job).split(samplesAt, size, share);
}

PartTree splitAlong(std::span<const Vec3f> positions, const std::vector<PartTree::Node>& nodes,
                    base::Job& job) {
  return Splitter(positions, job).splitAlong(nodes);
}

}  // namespace tufa::reduce
