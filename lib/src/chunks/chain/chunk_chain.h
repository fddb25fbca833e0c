#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "base/job.h"
#include "base/packed_normals.h"
#include "base/triangle_array.h"
#include "base/vec3f.h"
#include "chunks/cut/cut_mesh.h"
#include "grid/affine.h"
#include "octree/cut_rule.h"
#include "reduce/reduction.h"
#include "refine/local_frame.h"

namespace tufa::chunks {

/// One LOD of the whole surface, and what its chunks need to meet those of the next one.
struct ChainLevel {
  /// As they are written. Behind the LOD's own vertices are those of the next LOD's curves that are
  /// at none of their places.
  std::vector<Position> positions;
  std::size_t own = 0;  ///< number of the LOD's own vertices
  std::vector<Normal> normals;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> chunkOf;  ///< of each triangle, a place in CutMesh::chunks
  /// For each vertex its number in the cut mesh if it is on a plane's curve, else kNone.
  std::vector<VertexIndex> cutVertex;
  /// For each vertex on a curve its number among all vertices that curves have at any LOD: the same
  /// at LODs where it is at the same place; else kNone.
  std::vector<VertexIndex> curveVertex;
  std::vector<std::uint8_t> isEnd;  ///< of a curve
  /// For each vertex the one of this LOD that stands for it beside the next LOD.
  std::vector<VertexIndex> into;
  std::vector<std::uint32_t> intoPlane;  ///< where that is another one, the plane it is for
  std::vector<double> errors;            ///< of each chunk, voxels
  std::vector<double> transitionErrors;  ///< with all curves as the next LOD has them
  /// Whether a search has found no triangles that intersect, of the LOD itself, and of it with all
  /// curves as the next LOD has them.
  bool isSearched = false, isChangedSearched = false;
  static constexpr VertexIndex kNone = ~VertexIndex{0};
};

/// Some triangles of a cut mesh that were reduced by themselves.
struct ReducedBand {
  struct Placed {
    Position at;  ///< counted from Affine::origin()
    Normal normal;
  };
  reduce::Surface surface;
  std::vector<Placed> placed;            ///< its vertices
  std::vector<VertexIndex> vertices;     ///< of the mesh: those of its triangles, rising
  std::vector<std::uint32_t> triangles;  ///< of the mesh, rising
};

/// LODs of a cut mesh. Each is reduced from the one before in two steps: its curves on planes
/// first, whose vertices may move in their plane, and then all else, with the curves as they are.
///
/// What comes of the first step is a whole mesh that has passed all guards: the finer LOD with the
/// coarser one's curves. So the strips between LODs are triangles of that mesh. No triangle changes
/// in two planes at a time, and none in its new form meets another one in its old form that changes
/// in another plane: reduction guards that too.
class ChunkChain {
 public:
  /// The other arguments must outlive this. A cut mesh with errors is taken for LOD 0 as it is,
  /// whatever tolerance the first call of next() has.
  ChunkChain(CutMesh cut, const grid::Affine& affine, const octree::CutRule& rule, int chunkSize,
             bool singlePrecision, base::Job& job);

  /// Makes the next LOD, and completes the one before with what stands for its vertices.
  [[nodiscard]] ChainLevel next(double tolerance, ChainLevel* before);
  /// Puts bands in the place of their triangles, and has all triangles of some chunks stay, which
  /// are marked by a number other than 0. Curves of bands beside such chunks keep all their bits.
  /// To be called first.
  void replace(std::vector<ReducedBand> bands, const std::vector<std::uint8_t>& isHeld);
  /// LOD 0 alone, as a cut mesh again. To be called in place of next().
  [[nodiscard]] CutMesh reduceAlone(double tolerance);
  /// LOD 0 of a band; its `vertices` and `triangles` are left to the caller. To be called in place
  /// of next(), and last.
  [[nodiscard]] ReducedBand reduceBand(double tolerance);
  /// The cut mesh, without triangles and normals.
  [[nodiscard]] const CutMesh& cut() const { return cut_; }
  /// The same, when all LODs are made.
  [[nodiscard]] CutMesh takeCut() { return std::move(cut_); }

 private:
  using Placed = ReducedBand::Placed;

  [[nodiscard]] reduce::Regions regionsOf() const;
  [[nodiscard]] double leftOf(double tolerance) const;
  [[nodiscard]] bool hasScales(double tolerance) const;
  [[nodiscard]] std::vector<float> scalesOf(const octree::CutRule& rule) const;
  void reduce(double tolerance, reduce::LineMode lines);
  [[nodiscard]] std::vector<reduce::Index> findIntersecting(const reduce::ReducedMesh& reduced);
  [[nodiscard]] Position written(const Position& p) const;
  [[nodiscard]] Placed place(const reduce::ReducedMesh& reduced, VertexIndex v) const;
  [[nodiscard]] ChainLevel extract(const ChainLevel* before) const;
  void add(ChainLevel& level, const reduce::ReducedMesh& reduced, VertexIndex v) const;
  void setInto(ChainLevel& level);
  [[nodiscard]] std::vector<double> errorsOf(const reduce::Certificate& certificate) const;

  CutMesh cut_;  ///< without triangles and normals
  base::TriangleArray faces_;
  base::PackedNormals normals_;
  const grid::Affine& affine_;
  int chunkSize_;
  bool singlePrecision_;
  base::Job& job_;
  refine::LocalFrame frame_;             ///< of the cut mesh
  std::vector<reduce::LineKind> kinds_;  ///< of each vertex of the cut mesh
  /// The vertices of bands, by their places in the frame.
  std::map<std::array<float, 3>, Placed> placed_;
  VertexIndex curveVertices_;  ///< numbers in use, see ChainLevel::curveVertex
  bool isScaled_;              ///< tolerances differ from place to place
  double mostMoved_ = 0;       ///< of CutMesh::movedAt
  double tolerance_;           ///< of the last reduction, or of the first one to come
  std::optional<reduce::Reduction> reduction_;
  bool isSearched_ = false;  ///< the reduction's mesh for intersections, and none was found
};

}  // namespace tufa::chunks
