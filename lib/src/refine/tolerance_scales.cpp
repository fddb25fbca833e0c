#include "refine/tolerance_scales.h"

#include <algorithm>
#include <limits>

#include "base/box.h"

namespace tufa::refine {

namespace {

// A tolerance of the mesh's whole size allows all that a larger one does.
double largestScale(const Mesh& mesh, const grid::Affine& affine, double tolerance) {
  if (!(tolerance > 0)) return std::numeric_limits<float>::max();
  base::Box box = base::Box::empty();
  for (const Position& p : mesh.positions) box.add(Vec3(p));
  return std::max(1.0, box.size().length() / affine.voxelSize() / tolerance);
}

}  // namespace

double toleranceAt(const octree::CutRule& rule, const grid::Affine& affine, const Vec3& point) {
  if (!rule.scale) return rule.tolerance;
  const Coord& origin = affine.origin();
  return rule.toleranceAt(affine.latticePoint({point[0], point[1], point[2]}, origin) +
                          Vec3(origin));
}

std::vector<float> scalesOf(const Mesh& mesh, const grid::Affine& affine,
                            const octree::CutRule& rule, base::Job& job) {
  if (!rule.scale) return {};
  octree::CutRule one = rule;
  one.tolerance = 1;
  const double most = largestScale(mesh, affine, rule.tolerance);
  std::vector<float> scales(mesh.positions.size());
  job.forRanges(scales.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double scale = toleranceAt(one, affine, Vec3(mesh.positions[i]));
      scales[i] = static_cast<float>(std::clamp(scale, 0.0, most));
    }
  });
  return scales;
}

}  // namespace tufa::refine
