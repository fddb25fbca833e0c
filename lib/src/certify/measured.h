#pragma once

#include <vector>

#include "certify/certificate.h"
#include "cut/cut.h"
#include "mend/mend.h"
#include "polygons/cut_polygons.h"

namespace tufa::certify {

/// How the self-intersections of cuts are taken out.
struct Repair {
  std::vector<std::uint32_t> suspects;  ///< of the base mesh, see polygons::findSuspects()
  mend::Source source;                  ///< of the base mesh
};

/// A mesh that stands for the base mesh, and what was found on it.
struct Measured {
  cut::Cut cut;
  polygons::CutMesh made;
  std::vector<mend::PolygonIndex> suspects;  ///< polygons, of which each pair that meets has one
  mend::MendReport mended;
  std::vector<VertexIndex> altered;  ///< vertices of the polygons that mending changed
  Deviation deviation;
  std::vector<VertexIndex> meeting;  ///< of polygons that still meet; sorted
};

/// Polygons of which each pair that meets has one: the suspects of the base mesh that are left, and
/// what is not of the base mesh, at vertices of larger cells and at `altered` ones.
[[nodiscard]] std::vector<mend::PolygonIndex> suspectsOf(
    const polygons::CutMesh& made, const cut::Cut& cut,
    const std::vector<std::uint32_t>& baseSuspects, const std::vector<VertexIndex>& altered = {});

/// Mends a mesh by small moves of what is not of the base mesh, if `repair`, and measures it.
/// `fresh`: for each vertex, whether something around it is not as in a mesh that had no pairs that
/// meet; empty: all.
template <class TreeT>
void mendAndMeasure(Certifier<TreeT>& certifier, const Repair* repair, Measured& mesh,
                    base::Job& job, const std::vector<std::uint8_t>& fresh = {});

}  // namespace tufa::certify
