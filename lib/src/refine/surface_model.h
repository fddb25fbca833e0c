#pragma once

#include <tufa/contour.h>

#include <vector>

#include "base/job.h"
#include "base/triangle_array.h"
#include "intersect/surface.h"
#include "octree/cluster_forest.h"
#include "octree/cut_rule.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {

/// One grid, or a box of its blocks, and what its meshes are taken from: the uniform surface
/// without self-intersections, and the clusters of all levels. Neither copied nor moved, as its
/// parts refer to each other.
class SurfaceModel {
 public:
  /// Runs the stages of the uniform mesh. Throws Error as contour() does.
  SurfaceModel(grid::Volume volume, const ContourOptions& options, const uniform::StageEnds& ends,
               base::Job& job);
  SurfaceModel(const SurfaceModel&) = delete;
  SurfaceModel& operator=(const SurfaceModel&) = delete;

  /// The faces of the mesh, which has none from then on. What is known of cells is freed, another
  /// dozen bytes a cell: neither view() nor buildClusters() may be called any more.
  [[nodiscard]] base::TriangleArray takeFaces(base::Job& job);
  /// The normals of the mesh, which has none from then on.
  [[nodiscard]] std::vector<Normal> takeNormals() { return std::move(surface_.mesh.normals); }
  /// Frees the positions of the mesh.
  void releasePositions();
  /// The surface with what is known of its cells, which is made again if it was released; quads are
  /// not.
  [[nodiscard]] const uniform::UniformSurface& withCells(base::Job& job);
  /// Builds the clusters. To be called once, before forest().
  void buildClusters(const octree::CutRule& rule, base::Job& job);

  [[nodiscard]] const uniform::UniformSurface& surface() const { return surface_; }
  [[nodiscard]] uniform::SurfaceView view() const { return surface_.view(); }
  [[nodiscard]] const Mesh& mesh() const { return surface_.mesh; }
  [[nodiscard]] const grid::Affine& affine() const { return surface_.affine(); }
  /// Pairs of quads of the uniform mesh; all that still intersect, even after rounding, are among
  /// them. Sorted.
  [[nodiscard]] const std::vector<intersect::PolygonPair>& closePairs() const {
    return closePairs_;
  }
  /// Whether intersections are to be repaired.
  [[nodiscard]] bool repairs() const { return repairs_; }
  /// What was read and found, without the times of stages.
  [[nodiscard]] const ContourReport& report() const { return report_; }
  [[nodiscard]] const octree::ClusterForest& forest() const { return forest_; }
  /// The uniform mesh, for a caller that needs nothing else.
  [[nodiscard]] Mesh takeMesh() { return std::move(surface_.mesh); }

 private:
  bool repairs_;
  bool hasCells_ = true;
  Ambiguity ambiguity_;
  bool cap_;
  uniform::UniformSurface surface_;
  std::vector<intersect::PolygonPair> closePairs_;
  ContourReport report_;
  octree::ClusterForest forest_;
};

}  // namespace tufa::refine
