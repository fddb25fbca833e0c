#pragma once

#include <tufa/mesh.h>
#include <array>
#include <unordered_map>
#include <vector>

#include "base/vec3.h"
#include "refine/repair/local_mesh.h"

namespace tufa::refine {

/// Fallback positions for the polygons of all pairs. Vertices without a mass point stay.
struct FallbackPositions {
  std::unordered_map<VertexIndex, Position> massPoints;
  std::unordered_map<intersect::PolygonIndex, Position> crossings;
  double voxelSize = 1;
  bool singlePrecision = false;
};

/// The changes to a group; of each element the final state.
struct Changes {
  std::vector<std::pair<VertexIndex, Position>> moves;
  std::vector<intersect::PolygonIndex> turns;
  std::vector<std::pair<intersect::PolygonIndex, Position>> fans;
  std::vector<intersect::PolygonIndex>
      polygons;  ///< all that are not as they were, but for fans' triangles
};

/// Repairs the pairs of one group, each by the change of least harm that leaves fewer pairs than
/// before. Harm is how far the surface moves off itself, in voxels; so a vertex on a crease slides
/// along it before it leaves it. Cost: each edit tried tests the polygons it touches against all of
/// the group, boxes first.
class PairGroup {
 public:
  PairGroup(LocalMesh mesh, const std::vector<intersect::PolygonPair>& pairs,
            const FallbackPositions& fallbacks);

  /// If `lastResort`, polygons of a pair that no such change helps go to their mass points, and if
  /// they are there already they are fanned, whatever that does to others.
  Changes repairIntersections(bool lastResort);

 private:
  using Local = LocalMesh::Local;
  using Pair = std::array<Local, 2>;

  struct Edit {
    double harm = 0;
    std::vector<std::pair<Local, Position>> moves;
    std::vector<Local> turns;
    std::vector<Local> fans;
  };

  [[nodiscard]] Vec3 placeOf(Local polygon) const;
  [[nodiscard]] std::vector<Edit> editsFor(const Pair& pair) const;
  void addFlip(Local polygon, std::vector<Edit>& edits) const;
  void addFan(Local polygon, std::vector<Edit>& edits) const;
  void addMoves(Local vertex, std::vector<Edit>& edits) const;
  [[nodiscard]] Edit retreat(const Pair& pair) const;
  [[nodiscard]] bool isEdge(Local a, Local b, Local apart) const;
  [[nodiscard]] bool canMove(Local vertex) const;
  [[nodiscard]] bool canFan(Local polygon) const;

  bool improve(const Pair& pair);
  bool takeLastResort(const Pair& pair);
  // Applies an edit, and undoes it unless it leaves fewer pairs and no triangle without area.
  bool attempt(const Edit& edit, const Pair& pair);
  void apply(const Edit& edit);
  void undo(const Edit& edit);
  [[nodiscard]] std::vector<Local> touchedBy(const Edit& edit) const;
  [[nodiscard]] std::vector<Pair> pairsOf(const std::vector<Local>& polygons) const;
  void accept(const Edit& edit, const std::vector<Local>& touched, const std::vector<Pair>& pairs);
  [[nodiscard]] Changes changes() const;

  LocalMesh mesh_;
  const FallbackPositions& fallbacks_;
  std::vector<Pair> pairs_;
  std::vector<std::pair<Local, Position>> undoMoves_;
  std::vector<std::pair<Local, Quad>> undoFans_;
  std::vector<Local> moved_, turned_, touched_;
  std::vector<std::pair<Local, Position>> fans_;
};

}  // namespace tufa::refine
