#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/job.h"
#include "base/packed_normals.h"
#include "base/shared_array.h"
#include "base/triangle_array.h"
#include "base/vec3.h"
#include "base/vec3f.h"
#include "octree/cut_rule.h"
#include "reduce/reduction.h"
#include "refine/adapt.h"
#include "refine/local_frame.h"
#include "refine/surface_model.h"

namespace tufa::refine {

/// The uniform mesh of a surface model, reduced to one tolerance after the other, see
/// reduce/reduction.h. Rounding to single precision comes after it and moves vertices by
/// kMostRounding at most; so the result is the same wherever in the world the grid lies.
///
/// Positions are kept in single precision, see LocalFrame. Where vertices of the uniform mesh are
/// to stay as they are, in double precision too: on open borders, beside which another mesh may go
/// on, where the tolerance is 0, or may be in places, in a mesh so large that rounding counts, and
/// those of polygons so close to each other that the last bit tells whether they intersect once
/// they are rounded.
class SurfaceReduction {
 public:
  /// The rule's scale holds for all tolerances. All arguments must outlive this. Releases the
  /// model's cells and normals, and its positions.
  SurfaceReduction(SurfaceModel& model, const octree::CutRule& rule, base::Job& job);

  /// As few triangles as can be found within a tolerance, voxels. `drop`: leave out components
  /// smaller than the tolerance where they lie, but for the largest one.
  [[nodiscard]] AdaptiveMesh toTolerance(double tolerance, bool drop);

  /// At most `triangles`, at the least tolerance that allows so few; more if the topology does not
  /// allow so few. `drop`: then leave out as many components as necessary, the smallest first.
  [[nodiscard]] AdaptiveMesh toCount(std::size_t triangles, bool drop);

 private:
  struct Component {
    Vec3 centre{0.0};
    double size = 0;      ///< diagonal of the box of its uniform vertices, voxels
    double scale = 0;     ///< the least of the rule at one of its uniform vertices
    bool isTold = false;  ///< that it was left out
  };

  void takePositions(const std::vector<Position>& exact);
  [[nodiscard]] Position positionOf(const reduce::ReducedMesh& reduced, std::size_t vertex) const;
  [[nodiscard]] Normal normalOf(const reduce::ReducedMesh& reduced, std::size_t vertex) const;
  [[nodiscard]] std::vector<reduce::Index> findIntersecting(const reduce::ReducedMesh& reduced);
  [[nodiscard]] reduce::ReducedMesh extract(AdaptiveMesh& adaptive) const;
  void findComponents();
  [[nodiscard]] std::vector<std::size_t> trianglesOfComponents(
      const reduce::ReducedMesh& reduced) const;
  void drop(const std::vector<std::uint8_t>& isDropped, const reduce::ReducedMesh& reduced,
            AdaptiveMesh& adaptive);
  [[nodiscard]] std::uint32_t componentAt(const reduce::ReducedMesh& reduced,
                                          std::size_t vertex) const;

  const SurfaceModel& model_;
  const octree::CutRule& rule_;
  base::Job& job_;
  LocalFrame frame_;  ///< of the mesh
  // Of the uniform mesh; positions in the frame.
  base::SharedArray<base::Vec3f> positions_;
  base::TriangleArray faces_;
  base::PackedNormals normals_;
  bool keepsExact_ = true;  ///< the model has positions still
  // Else those of vertices of close polygons; the vertices rising.
  std::vector<VertexIndex> closeVertices_;
  std::vector<Position> closePositions_;
  std::optional<reduce::Reduction> reduction_;
  bool isSearched_ = false;  ///< the reduction's mesh for intersections, and none was found
  std::vector<std::uint32_t> componentOf_;  ///< of each uniform vertex
  std::vector<Component> components_;       ///< empty until needed
};

}  // namespace tufa::refine
