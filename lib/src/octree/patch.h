#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/vec3.h"
#include "octree/patch_planes.h"
#include "uniform/case_table.h"

namespace tufa::octree {

/// A cone of directions: every unit normal gathered is within `angle` of `axis`.
struct NormalCone {
  Vec3 axis{0.0};    ///< of any length
  double angle = 0;  ///< radians, at most pi

  /// Makes this a cone around both. The new axis is the sum of both, so the angle is an upper bound
  /// by the triangle inequality on the sphere, not the least one.
  void add(const NormalCone& other);
};

/// The surface of one cluster while the forest is being built, with all that is needed to join it
/// to others: where it crosses the cell's edges, its planes, and its normals. Cost: over 200 bytes,
/// so patches are kept for one level at a time.
struct Patch {
  static constexpr std::int32_t kNoCrossing = std::numeric_limits<std::int32_t>::min();

  /// Where the surface patch crosses each of the cell's 12 edges (uniform::kEdges): the lattice
  /// coordinate, along the edge, of the lattice edge that is crossed.
  std::array<std::int32_t, uniform::kEdges> crossings;
  PatchPlanes
      planes;  ///< counted from the lower corner of the block, above level 3 from that of the cell
  NormalCone cone;

  Patch() { crossings.fill(kNoCrossing); }
};

/// Joins the patches of the eight children of a cell to those of the cell itself, and decides
/// whether the cell may become a leaf.
///
/// Patches of two children are one if they share a crossing on the face between them. A cell may
/// become a leaf only if each of its patches is a disk that meets each neighbour in one piece
/// (Schaefer, Ju and Warren 2007): its Euler characteristic is 1, it has at most one crossing on
/// each edge of the cell, none or two on the boundary of each face, and three at least.
///
/// The children alone give the characteristic, as each child patch is a disk and counts 1. Gluing
/// two surfaces along a curve takes off one for the curve, an arc with both ends; every face
/// between two children takes one off for each curve on it, which shows as two shared crossings on
/// the boundary of that face. A crossing on one of the six lattice lines from the middle of the
/// cell lies in four patches and ends four such curves: it is counted four times, taken off four
/// times, and therefore added once more. A closed curve inside a face does not occur: it would
/// bound a child patch without any crossing on the child's edges, and such a child is not safe.
///
/// Cost: one union-find over the children's patches; no field value and no mesh is read.
class PatchJoiner {
 public:
  using Children = std::array<std::span<const Patch>, uniform::kCorners>;

  /// Children in the order of a cell's corners, see uniform/case_table.h. Returns whether the cell
  /// may become a leaf; if so, the results below hold its patches, without planes and cones.
  [[nodiscard]] bool join(const Children& children);

  [[nodiscard]] std::vector<Patch>& patches() { return patches_; }
  /// For each patch of the children, child by child, the patch of the cell that holds it.
  [[nodiscard]] const std::vector<std::uint32_t>& parents() const { return parents_; }

 private:
  void joinAcross(const Children& children, int lower, int upper, int axis);
  [[nodiscard]] std::uint32_t root(std::uint32_t patch);
  [[nodiscard]] bool addCrossings(Patch& patch, const Patch& child, int position);

  std::array<std::uint32_t, uniform::kCorners + 1> first_{};
  std::vector<std::uint32_t> parents_;
  std::vector<int> shared_;  ///< crossings shared across faces, at the joined roots
  std::vector<int> sums_;    ///< Euler characteristics at the roots, times 4
  std::vector<std::uint32_t> numbers_;
  std::vector<Patch> patches_;
};

}  // namespace tufa::octree
