#pragma once

#include <vector>

#include "uniform/patch_planes.h"
#include "uniform/qef.h"

namespace tufa::uniform {

/// What the surface is like in a cell near a crease.
struct CreasePlacement {
  Vector point{};   ///< in voxels from the middle of the cell
  Vector normal{};  ///< outward unit normal: of the plane, or the mean of those that meet
  std::array<Vector, 3> sheets{};  ///< normals of the planes that meet
  bool outOfCell = false;          ///< the point may lie outside of the cell
  int planes = 0;  ///< 1: the cell lies on one smooth side; 2: a crease; 3: a corner; 0: unknown
};

/// The plane normal . p = offset.
struct TangentPlane {
  Vector normal{};
  float offset = 0;
};

/// Places the vertex of a cell near a crease from the tangent planes of the cubes around it.
///
/// The planes whose feet lie near the cell are sorted into smooth sides, each a plane that bends as
/// the normals of its members change from foot to foot. If three sides meet in the
/// cell the vertex is their corner; if two do, the point of their crease nearest to the mass point.
/// If none meet in the cell but its crossings lie on two or three sides, the crease or corner just
/// outside is taken, up to a voxel away: the cell there has no vertex of its own. Else the vertex
/// lies on the one side that passes the mass point. A point counts only if no sample around it is
/// farther from the surface than from the point: that proves that the planes meet there, and not
/// only their continuations.
class CreaseCell {
 public:
  CreaseCell(const grid::BlockSamples& samples, const grid::FieldScale& scale)
      : samples_(samples), scale_(scale), planes_(samples, scale) {}

  void reset() { planes_.reset(); }

  /// `x`, `y`, `z` are the cell's place in the block, 0..7; `massPoint` is in voxels from the
  /// middle of the cell.
  [[nodiscard]] CreasePlacement place(int x, int y, int z, const Vector& massPoint);

 private:
  /// A smooth side of the surface near the cell: the plane normal . p = offset, and how that bends.
  struct Sheet {
    Vector normal{};
    float offset = 0;
    float weight = 0;
    bool crossed = false;  ///< a crossing of the cell lies on it
    Vector middle{};       ///< mean of the feet
    /// Change of the normal for each step away from the middle: xx, xy, xz, yy, yz, zz.
    std::array<float, 6> bend{};
    float rise = 0;  ///< mean of the bent surface's height over the plane at the feet
  };
  void collectPlanes();
  void sortIntoSheets();
  void dropBlendedSheets();
  [[nodiscard]] bool isBlend(const Sheet& sheet, const Sheet& a, const Sheet& b) const;
  void markCrossedSheets();
  void readBalls();
  [[nodiscard]] float sampleAt(int corner) const;
  [[nodiscard]] bool isOnSurface(const Vector& point) const;
  // Both search in the cell, or, if `beyond`, around it among the sides that the crossings lie on.
  [[nodiscard]] bool placeOnCorner(const Vector& massPoint, bool beyond,
                                   CreasePlacement& placement) const;
  [[nodiscard]] bool placeOnCrease(const Vector& massPoint, bool beyond,
                                   CreasePlacement& placement) const;
  [[nodiscard]] bool placeOnSide(const Vector& massPoint, CreasePlacement& placement) const;
  [[nodiscard]] TangentPlane planeOf(int sheet) const {
    return {sheets_[sheet].normal, sheets_[sheet].offset};
  }
  void bendSide(Sheet& sheet) const;
  // The tangent plane of a side near a point.
  [[nodiscard]] static TangentPlane tangentAt(const Sheet& sheet, const Vector& point);
  // Moves a point of the planes of some sides to where the bent sides meet.
  void followBends(Vector& point, std::initializer_list<int> sheets) const;
  void setNormal(CreasePlacement& placement, std::initializer_list<int> sheets) const;

  const grid::BlockSamples& samples_;
  const grid::FieldScale& scale_;
  PatchPlanes planes_;
  std::vector<PatchPlane> near_;  ///< feet in voxels from the middle of the cell
  std::vector<float> weights_;    ///< of near_
  std::vector<Sheet> sheets_;
  std::vector<std::size_t> members_;  ///< of near_: those of the side at hand
  /// Squared radii of the balls around the 64 samples nearest to the cell that the surface does not
  /// enter.
  std::array<std::array<float, 4>, 16> squaredBalls_{};
  std::array<int, 3> cell_{};
};

}  // namespace tufa::uniform
