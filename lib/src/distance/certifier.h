#pragma once

#include <tufa/mesh.h>
#include <array>
#include <vector>

#include "base/flat_triangle.h"
#include "base/job.h"
#include "base/vec3.h"
#include "distance/reference.h"
#include "octree/cluster_forest.h"
#include "octree/cut.h"
#include "octree/cut_polygons.h"

namespace tufa::distance {

/// How far a mesh is from the uniform mesh, both ways, and where it is too far.
struct Deviation {
  double largest = 0;               ///< voxels; of the distances within the tolerance
  double worst = 0;                 ///< voxels; of all distances
  double mean = 0;                  ///< voxels, over the vertices and quads of the uniform mesh
  std::vector<VertexIndex> coarse;  ///< vertices whose cells must be split, sorted
  /// The two directions apart. Points of the uniform mesh too far from the mesh: vertices by their
  /// index and, behind them, quads by their middles. Vertices of polygons too far from the uniform
  /// mesh, sorted.
  std::vector<std::uint64_t> farPoints;
  std::vector<VertexIndex> protruding;
};

/// The rule's tolerance at a point of the mesh, voxels.
[[nodiscard]] double toleranceAt(const octree::CutRule& rule, const grid::Affine& affine,
                                 const Vec3& point);

/// Measures meshes taken from cuts against the uniform mesh they come from: every uniform vertex
/// and the middle of every uniform quad to the polygons around its own clusters; the vertices of
/// every polygon and samples inside it to the uniform polygons below it. The bound is the rule's
/// tolerance.
///
/// Promised: each distance is that to a point found, so none is too small; it may be slightly too
/// large. Clusters know their uniform vertices, so nothing is searched globally, and no sheet is
/// compared with another that happens to be near. Between samples nothing is measured: this is no
/// bound on the Hausdorff distance. From one mesh to the next only what changed is measured again.
class Certifier {
 public:
  /// `base` and `surface` are the uniform mesh. They, and `job`, must outlive this object.
  Certifier(const uniform::SurfaceView& base, const UniformReference& surface,
            const octree::CutRule& rule, base::Job& job);
  /// Replaces the rule for all later calls; it may differ in its tolerance only.
  void setRule(const octree::CutRule& rule) { rule_ = rule; }

  /// For all later calls: a flag for each uniform quad whose middle the meshes do not reach; empty:
  /// none.
  void setIgnored(std::vector<std::uint8_t> quads) { ignored_ = std::move(quads); }

  /// World distance from a point of a mesh whose normal there is `facing` to the uniform mesh;
  /// infinite if that is nowhere near. A place nearer than `enough` ends the search.
  [[nodiscard]] double distanceToBase(const Vec3& point, const Vec3& facing, double enough) const {
    return surface_.distance(point, facing, reachOf(enough / base_.affine.voxelSize()), enough);
  }

  /// Measures the next mesh, that of a cut or one whose vertices were joined further. `altered`:
  /// vertices of polygons that are not as the cut alone would have them. `largest` also covers what
  /// was measured on the meshes before, as what did not change is not measured again.
  [[nodiscard]] Deviation measure(const octree::Cut& cut, const octree::CutMesh& made,
                                  const std::vector<VertexIndex>& altered = {});
  /// For the mesh measured last, if it was the first: for each vertex the largest distance of
  /// samples of its polygons and of the uniform points that it stands for; voxels. The middle of a
  /// quad counts at all its corners.
  [[nodiscard]] std::vector<float> errorsAtVertices() const;

 private:
  // A triangle of the mesh that is not one of the uniform mesh.
  struct NewTriangle {
    // The corners of its polygon: the triangle's first, then a quad's fourth or the first again.
    std::array<VertexIndex, 4> corners;
    std::uint32_t source;  ///< the uniform quad its polygon comes from
    base::FlatTriangle shape;
  };
  // Results of a range of points or triangles.
  struct Part {
    double largest = 0;
    double worst = 0;
    double sum = 0;
    std::vector<VertexIndex> coarse;
    std::vector<std::uint64_t> farPoints;
  };

  [[nodiscard]] bool isFine(VertexIndex vertex) const {
    return cut_->clusters[vertex].level == 0 && altered_[vertex] == 0;
  }
  void collectNewTriangles();
  void findChanges();
  void measureVertex(std::size_t index, Part& part);
  void measureQuad(std::size_t index, Part& part);
  void measureNewTriangle(std::size_t index, Part& part);
  void measureCorner(VertexIndex vertex, Part& part);
  [[nodiscard]] bool findAround(VertexIndex vertex, const Vec3& point, double enough,
                                double& squared, std::uint32_t& nearest) const;
  void walkNearer(const Vec3& point, double enough, double& squared, std::uint32_t& nearest) const;
  [[nodiscard]] float distanceAround(const VertexIndex* vertices, int count, const Vec3& point,
                                     std::uint8_t& wandered, Part& part) const;
  void note(const Vec3& point, double voxels, const VertexIndex* corners, int count,
            Part& part) const;
  [[nodiscard]] Vec3 facing(const VertexIndex* vertices, int count) const;
  void noteFar(std::uint64_t index, const Vec3& point, double voxels, Part& part) const;
  [[nodiscard]] double toleranceAt(const Vec3& point) const;
  [[nodiscard]] double distanceBelow(const Vec3& point, const Vec3& outward,
                                     std::uint32_t source) const;
  [[nodiscard]] static int reachOf(double voxels);
  template <class Body>
  void forChunks(std::size_t count, const Body& body, Deviation& total, double& sum);

  const uniform::SurfaceView base_;
  const UniformReference& surface_;
  octree::CutRule rule_;
  std::vector<std::uint8_t> ignored_;
  base::Job& job_;
  const octree::Cut* cut_ = nullptr;
  const octree::CutMesh* made_ = nullptr;
  std::vector<std::uint8_t> altered_;      ///< vertices that are not as the cut has them
  std::vector<Position> positions_;        ///< of the mesh before
  std::vector<VertexIndex> vertexOf_;      ///< of the mesh before
  std::vector<std::uint8_t> alteredKept_;  ///< of the mesh before
  std::vector<std::uint8_t> changed_;      ///< vertices that are not as in the mesh before
  std::vector<std::uint8_t> touched_;      ///< these and their neighbours
  std::vector<float> vertexErrors_;        ///< of the uniform vertices, voxels
  /// Uniform vertices, then quads, whose distance led beyond the polygons around their clusters:
  /// what lies there is not covered by touched_, so they are measured each time.
  std::vector<std::uint8_t> wandered_;
  std::vector<float> quadErrors_;  ///< of the uniform quads, voxels
  double largestKept_ = 0;         ///< within the tolerance, over all meshes
  std::vector<NewTriangle> newTriangles_;
  std::vector<float> newTriangleErrors_;    ///< of those measured last, voxels
  std::vector<float> cornerErrors_;         ///< of the vertices measured last, voxels
  std::vector<std::uint32_t> firstAround_;  ///< of each vertex, its triangles in around_
  std::vector<std::uint32_t> around_;
};

}  // namespace tufa::distance
