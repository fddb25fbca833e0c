#pragma once

#include <vector>

#include "distance/certifier.h"
#include "octree/cut.h"
#include "octree/cut_polygons.h"
#include "refine/repair/repair.h"

namespace tufa::refine {

/// How the self-intersections of cuts are taken out.
struct Repair {
  std::vector<std::uint32_t> candidates;  ///< of the base mesh, see intersect::findSuspects()
  Source source;                          ///< of the base mesh
};

/// A mesh that stands for the base mesh, and what was found on it.
struct Measured {
  octree::Cut cut;
  octree::CutMesh made;
  std::vector<intersect::PolygonIndex>
      candidates;  ///< polygons, of which each pair that meets has one
  RepairReport repaired;
  std::vector<VertexIndex> altered;  ///< vertices of the polygons that mending changed
  distance::Deviation deviation;
  std::vector<VertexIndex> meeting;  ///< of polygons that still meet; sorted
};

/// Polygons of which each pair that meets has one: the suspects of the base mesh that are left, and
/// what is not of the base mesh, at vertices of larger cells and at `altered` ones.
[[nodiscard]] std::vector<intersect::PolygonIndex> candidatesOf(
    const octree::CutMesh& made, const octree::Cut& cut,
    const std::vector<std::uint32_t>& uniformCandidates,
    const std::vector<VertexIndex>& altered = {});

/// Mends a mesh by small moves of what is not of the base mesh, if `repair`, and measures it.
/// `fresh`: for each vertex, whether something around it is not as in a mesh that had no pairs that
/// meet; empty: all.
void repairAndMeasure(distance::Certifier& certifier, const Repair* repair, Measured& mesh,
                      base::Job& job, const std::vector<std::uint8_t>& fresh = {});

}  // namespace tufa::refine
