#pragma once

#include <tufa/contour.h>
#include <cstdint>
#include <vector>

#include "base/affine.h"
#include "base/job.h"
#include "blocks/blocks.h"
#include "blocks/field.h"
#include "components/topology.h"
#include "creases/vertex_sides.h"
#include "forest/forest.h"
#include "mend/mend.h"
#include "polygons/base_quads.h"

namespace tufa::level0 {

/// The end of a call's progress that each stage reaches.
struct StageEnds {
  double blocks, topology, vertices, polygons, creases, repair;
};

/// The farthest that the rounding of world positions to single precision may move them, in voxels.
inline constexpr double kMostRounding = 5e-4;

/// The uniform mesh of a grid and all that is known of its cells: what every mesh of the grid is
/// taken from. Positions are counted from affine().origin().
///
/// Self-intersections are taken out unless ContourOptions::repair says otherwise, as far as that
/// can be done without further vertices.
template <class TreeT>
class Level0 {
 public:
  /// Runs the stages. Throws Error as contour() does.
  Level0(const openvdb::Grid<TreeT>& grid, const ContourOptions& options, const StageEnds& ends,
         base::Job& job);
  /// The same for the blocks of a box alone, see blocks::Blocks; all that is read from the whole
  /// grid is given. Positions are counted from the same point for every box.
  Level0(const openvdb::math::Transform& transform, const blocks::Blocks<TreeT>& whole,
         const openvdb::CoordBBox& box, const blocks::FieldScale& scale,
         const ContourOptions& options, const StageEnds& ends, base::Job& job);
  Level0(const Level0&) = delete;
  Level0& operator=(const Level0&) = delete;

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  /// The mesh before the repair, which may reach far, without normals; of a part only. Its vertices
  /// depend on what is near them alone.
  [[nodiscard]] const Mesh& meshBeforeRepair() const { return before_; }
  [[nodiscard]] const base::Affine& affine() const { return affine_; }
  [[nodiscard]] const components::Topology& topology() const { return topology_; }
  [[nodiscard]] polygons::QuadContext<TreeT> quads() const {
    return {blocks_, topology_, scale_, affine_, sides_};
  }
  /// What the forest is built on; `angles` if the angles between normals matter.
  [[nodiscard]] forest::Base<TreeT> base(bool angles) const {
    return {blocks_, topology_, affine_, mesh_, sides_, angles};
  }
  /// Quads of the mesh of which each pair that meets, even after rounding, has one. Sorted.
  [[nodiscard]] const std::vector<std::uint32_t>& suspects() const { return suspects_; }
  /// What mending asks, of the elements of this mesh and in its positions.
  [[nodiscard]] mend::Source source(base::Job& job) const;
  /// What was read and found, but for the stages' times.
  [[nodiscard]] const ContourReport& report() const { return report_; }
  /// The mesh, for one that needs nothing else.
  [[nodiscard]] Mesh takeMesh() { return std::move(mesh_); }

 private:
  void makeMesh(const ContourOptions& options, const StageEnds& ends, base::Job& job);
  void repair(base::Job& job);
  void mendSuspects(base::Job& job);
  bool putBackPieces(base::Job& job);
  void addSuspects(const std::vector<mend::PolygonIndex>& polygons);

  blocks::IsoChoice iso_;
  blocks::Blocks<TreeT> blocks_;
  blocks::FieldScale scale_;
  components::Topology topology_;
  base::Affine affine_;
  Mesh mesh_;
  Mesh before_;
  creases::VertexSides sides_;
  std::vector<std::uint32_t> suspects_;
  ContourReport report_;
};

}  // namespace tufa::level0
