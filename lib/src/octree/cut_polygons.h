#pragma once

#include <tufa/mesh.h>

#include "base/job.h"
#include "base/polygons.h"
#include "grid/affine.h"
#include "octree/cluster_forest.h"
#include "octree/cut.h"

namespace tufa::octree {

/// A mesh taken from a cut, and the uniform quads that its polygons come from.
struct CutMesh {
  Mesh mesh;
  std::vector<std::uint32_t> quadSources;      ///< uniform quad of each quad
  std::vector<std::uint32_t> triangleSources;  ///< uniform quad of each triangle

  [[nodiscard]] std::uint32_t sourceOf(base::PolygonIndex polygon) const {
    return polygon < quadSources.size() ? quadSources[polygon]
                                        : triangleSources[polygon - quadSources.size()];
  }
};

/// The mesh of a cut: of every uniform quad the distinct vertices of the cut in their order; four
/// make a quad, three a triangle, fewer nothing. Quads start at an end of their better diagonal.
[[nodiscard]] CutMesh meshCut(const ClusterForest& forest, const Cut& cut, const Mesh& base,
                              const grid::Affine& affine, base::Job& job);
/// The same for other quads than those of the uniform mesh, between its vertices.
[[nodiscard]] CutMesh meshCut(const ClusterForest& forest, const Cut& cut, const Mesh& base,
                              const std::vector<Quad>& quads, const grid::Affine& affine,
                              base::Job& job);

}  // namespace tufa::octree
