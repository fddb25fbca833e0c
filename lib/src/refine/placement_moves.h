#pragma once

#include <cstdint>
#include <vector>

#include "uniform/uniform_surface.h"

namespace tufa::refine {

/// A place that a vertex may go to.
struct PlacementMove {
  VertexIndex vertex;
  Position to;
  std::uint8_t step;  ///< places that it then has left
  double cost;        ///< the square of the way; of a slide, less
  bool isSlide = false;
  bool isFallback = false;  ///< may be made even if it settles nothing
};

/// The moves of vertices at and beside creases: along the crease or over the sheet, which leaves
/// the surface where it was; part of the way to the point of the QEF or to the mass point; and all
/// of it. From there, inside the cell. Each vertex makes few of them, so withdrawals end.
class PlacementMoves {
 public:
  explicit PlacementMoves(const uniform::UniformSurface& surface)
      : surface_(surface), steps_(surface.mesh.positions.size(), 0) {}

  /// Adds those that a vertex has. `plain`, `mass`: its point by the QEF and its mass point.
  void add(VertexIndex vertex, const Position& plain, const Position& mass,
           std::vector<PlacementMove>& moves) const;
  /// Adds slides over the sheet of a vertex that lies on one, beside a crease. Folds are settled
  /// so; pairs gain little for the time.
  void addSlidesOnSheet(VertexIndex vertex, std::vector<PlacementMove>& moves) const;
  /// Adds moves of a vertex at its mass point that keep it inside its cell: over the sheet, and
  /// towards the cell's middle. Where the surface passes close to samples on both sides of them,
  /// mass points crowd there, and faces between them may be folds.
  void addMovesInCell(VertexIndex vertex, const Position& mass,
                      std::vector<PlacementMove>& moves) const;
  /// To the mass point at once.
  [[nodiscard]] static PlacementMove toMassPoint(VertexIndex vertex, const Position& mass);
  /// Whether a vertex has come to its mass point, and has moved inside its cell only since then.
  [[nodiscard]] bool wasAtMassPoint(VertexIndex vertex) const;
  /// Whether a vertex has left the crease by a move.
  [[nodiscard]] static bool leavesCrease(const PlacementMove& move);
  /// Notes that a move was made. Whether it is the vertex's first.
  bool note(const PlacementMove& move);

 private:
  [[nodiscard]] Vec3 alongCrease(VertexIndex vertex) const;
  void addSlides(VertexIndex vertex, std::vector<PlacementMove>& moves) const;
  /// Calls add(place, length) for places over a sheet of normal `normal` around one.
  template <class Add>
  void forSlidesOnSheet(const Vec3& from, const Vec3& normal, const Add& add) const;

  const uniform::UniformSurface& surface_;
  std::vector<std::uint8_t> steps_;  ///< places that each vertex has left
};

}  // namespace tufa::refine
