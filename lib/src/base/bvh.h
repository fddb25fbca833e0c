#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/box.h"
#include "base/box_ray.h"
#include "base/job.h"
#include "base/vec3.h"

namespace tufa::base {

/// A binary tree of boxes over any items that have boxes. Built from the Morton order of their
/// centres, so building is one parallel sort and one pass; the same for any number of threads.
///
/// Nodes lie in preorder and every node halves its leaves, so children need no pointers: a node
/// with n leaves is followed by its left child (n/2 leaves), and 2*(n/2) nodes later by its right
/// child.
class Bvh {
 public:
  static constexpr std::size_t kLeafSize = 4;
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// `boxes[i]` is the box of item i. At most 2^32 - 2 items.
  Bvh(std::vector<Box> boxes, Job& job);

  [[nodiscard]] bool empty() const { return items_.empty(); }
  [[nodiscard]] std::size_t leafCount() const {
    return (items_.size() + kLeafSize - 1) / kLeafSize;
  }

  /// Calls visit(a, b) for items whose boxes overlap, a being in leaf `leaf`. Over all leaves, each
  /// pair of items is visited once.
  template <class Visit>
  void pairsOfLeaf(std::size_t leaf, const Visit& visit) const {
    Box own = Box::empty();
    const std::size_t ownBegin = leaf * kLeafSize;
    const std::size_t ownEnd = std::min(ownBegin + kLeafSize, items_.size());
    for (std::size_t i = ownBegin; i < ownEnd; ++i) own.add(boxes_[i]);
    const auto enter = [&](const Node& node) {
      return node.firstLeaf + node.leaves > leaf && boxOf(node).meets(own);
    };
    walk(enter, [&](std::size_t j) {
      for (std::size_t i = ownBegin; i < ownEnd && i < j; ++i) {
        if (boxes_[i].meets(boxes_[j])) visit(items_[i], items_[j]);
      }
    });
  }

  /// Calls visit(item, its box) for each item whose box overlaps `box`.
  template <class Visit>
  void itemsMeeting(const Box& box, const Visit& visit) const {
    walk([&](const Node& node) { return boxOf(node).meets(box); },
         [&](std::size_t i) {
           if (boxes_[i].meets(box)) visit(items_[i], boxes_[i]);
         });
  }

  /// Calls visit(item) for items whose boxes overlap `box`, until it returns true.
  template <class Visit>
  void itemsMeetingUntil(const Box& box, const Visit& visit) const {
    bool done = false;
    walk([&](const Node& node) { return !done && boxOf(node).meets(box); },
         [&](std::size_t i) {
           if (!done && boxes_[i].meets(box)) done = visit(items_[i]);
         });
  }

  /// Calls visit(item) for items whose boxes a ray may pass before `to`, nearer parts of the tree
  /// first. visit() may lower `to`: what begins behind it is left out.
  template <class Visit>
  void itemsAlong(const BoxRay& ray, double& to, const Visit& visit) const {
    if (empty()) return;
    // Boxes that the ray misses are entered at infinity.
    to = std::min(to, std::numeric_limits<double>::max());
    std::array<Passed, kMaxDepth> stack;
    std::size_t depth = 0;
    stack[depth++] = {root(), ray.entry(boxOf(root()), to)};
    while (depth > 0) {
      const auto [node, entry] = stack[--depth];
      if (!(entry <= to)) continue;
      if (node.leaves == 1) {
        const std::size_t end = std::min((node.firstLeaf + 1) * kLeafSize, items_.size());
        for (std::size_t i = node.firstLeaf * kLeafSize; i < end; ++i) {
          if (ray.entry(boxes_[i], to) <= to) visit(items_[i]);
        }
        continue;
      }
      Passed near{left(node), ray.entry(boxOf(left(node)), to)};
      Passed far{right(node), ray.entry(boxOf(right(node)), to)};
      if (far.entry < near.entry) std::swap(near, far);
      stack[depth++] = far;
      stack[depth++] = near;
    }
  }

  /// The item of least distanceSquared(item) among those nearer than `best`; kNone if there is
  /// none. `best` becomes the squared distance found.
  template <class DistanceSquared>
  std::uint32_t nearest(const Vec3& point, double& best,
                        const DistanceSquared& distanceSquared) const {
    std::uint32_t found = kNone;
    if (empty()) return found;
    std::array<Candidate, kMaxDepth> stack;
    std::size_t depth = 0;
    stack[depth++] = {root(), boxOf(root()).distanceSquared(point)};
    while (depth > 0) {
      const auto [node, bound] = stack[--depth];
      if (bound >= best) continue;
      if (node.leaves == 1) {
        const std::size_t end = std::min((node.firstLeaf + 1) * kLeafSize, items_.size());
        for (std::size_t i = node.firstLeaf * kLeafSize; i < end; ++i) {
          if (boxes_[i].distanceSquared(point) >= best) continue;
          const double d = distanceSquared(items_[i]);
          if (d < best) {
            best = d;
            found = items_[i];
          }
        }
        continue;
      }
      Candidate near{left(node), boxOf(left(node)).distanceSquared(point)};
      Candidate far{right(node), boxOf(right(node)).distanceSquared(point)};
      if (far.bound < near.bound) std::swap(near, far);
      stack[depth++] = far;
      stack[depth++] = near;
    }
    return found;
  }

 private:
  // Every level halves at most 2^30 leaves, and each leaves one sibling on the stack.
  static constexpr std::size_t kMaxDepth = 64;

  struct Node {
    std::size_t index;
    std::size_t firstLeaf;
    std::size_t leaves;
  };
  /// A node still to be searched; no item in it is nearer than the root of `bound`.
  struct Candidate {
    Node node;
    double bound;
  };
  /// A node that a ray may pass, and where it enters it.
  struct Passed {
    Node node;
    double entry;
  };
  [[nodiscard]] Node root() const { return {0, 0, leafCount()}; }
  [[nodiscard]] static Node left(const Node& node) {
    return {node.index + 1, node.firstLeaf, node.leaves / 2};
  }
  [[nodiscard]] static Node right(const Node& node) {
    const std::size_t half = node.leaves / 2;
    return {node.index + 2 * half, node.firstLeaf + half, node.leaves - half};
  }
  [[nodiscard]] const Box& boxOf(const Node& node) const { return nodes_[node.index]; }

  void fill(const Node& node);

  /// Calls visit(i) for the places i of all items in leaves that `enter` lets pass.
  template <class Enter, class Visit>
  void walk(const Enter& enter, const Visit& visit) const {
    if (empty()) return;
    std::array<Node, kMaxDepth> stack;
    std::size_t depth = 0;
    stack[depth++] = root();
    while (depth > 0) {
      const Node node = stack[--depth];
      if (!enter(node)) continue;
      if (node.leaves > 1) {
        stack[depth++] = right(node);
        stack[depth++] = left(node);
        continue;
      }
      const std::size_t end = std::min((node.firstLeaf + 1) * kLeafSize, items_.size());
      for (std::size_t i = node.firstLeaf * kLeafSize; i < end; ++i) visit(i);
    }
  }

  std::vector<std::uint32_t> items_;  ///< in Morton order
  std::vector<Box> boxes_;            ///< of items_
  std::vector<Box> nodes_;            ///< in preorder
};

}  // namespace tufa::base
