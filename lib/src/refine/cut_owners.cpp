#include "refine/cut_owners.h"

#include <algorithm>

#include "base/huge_pages.h"
#include "octree/cluster_forest.h"
#include "refine/tolerance_scales.h"

namespace tufa::refine {
namespace {

// Voxels; faces need no tighter bound, as rounding may take as much.
constexpr float kRounding = 1e-4f;

}  // namespace

CutOwners::CutOwners(const uniform::SurfaceView& view, const LocalFrame& theFrame,
                     const octree::CutRule& rule, base::Job& theJob)
    : base(view),
      job(theJob),
      tolerance(static_cast<float>(rule.tolerance)),
      minLevel(rule.minLevel),
      scales(scalesOf(view.mesh, view.affine, rule, theJob)),
      frame(theFrame) {
  const std::size_t count = base.mesh.positions.size();
  base::resizeLarge(owner, count, job, octree::kNone);
  base::resizeLarge(distance, count, job);
  base::resizeLarge(faceBound, 2 * base.mesh.quads.size(), job);
}

float CutOwners::limitOf(const Triangle& face) const {
  float least = kFarOff;
  for (const VertexIndex v : face.vertices) least = std::min(least, toleranceAt(v));
  return std::max(least, kRounding);
}

}  // namespace tufa::refine
