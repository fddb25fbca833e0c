#pragma once

#include <vector>

#include "distance/certifier.h"
#include "octree/cut.h"
#include "octree/cut_polygons.h"
#include "refine/repair/repair.h"

namespace tufa::refine {

/// How self-intersections of meshes taken from cuts are removed.
struct Repair {
  std::vector<std::uint32_t> candidates;  ///< of the uniform mesh, see intersect::findCandidates()
  Source source;                          ///< of the uniform mesh
  const grid::Affine* affine;             ///< to world space
};

/// A mesh that stands for the uniform mesh, and what was found on it.
struct Measured {
  octree::Cut cut;
  octree::CutMesh made;
  std::vector<intersect::PolygonIndex>
      candidates;  ///< polygons; each intersecting pair contains one
  RepairReport repaired;
  std::vector<VertexIndex> altered;  ///< vertices of the polygons that repair changed
  distance::Deviation deviation;
  std::vector<VertexIndex> meeting;  ///< of polygons that still intersect; sorted
};

/// The candidates of a mesh: polygons such that each intersecting pair contains one. They are the
/// candidates of the uniform mesh that are left, and all polygons at vertices of larger cells and
/// at `altered` ones.
[[nodiscard]] std::vector<intersect::PolygonIndex> candidatesOf(
    const octree::CutMesh& made, const octree::Cut& cut,
    const std::vector<std::uint32_t>& uniformCandidates,
    const std::vector<VertexIndex>& altered = {});

/// Repairs a mesh by small moves of what is not of the uniform mesh, unless `repair` is null, and
/// measures it. `fresh`: for each vertex, whether something around it is not as in a mesh without
/// pairs; only candidates there are searched. Empty: all.
void repairAndMeasure(distance::Certifier& certifier, const Repair* repair, Measured& mesh,
                      base::Job& job, const std::vector<std::uint8_t>& fresh = {});

}  // namespace tufa::refine
