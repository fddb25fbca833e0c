#pragma once

#include <vector>

#include "uniform/cube_planes.h"
#include "uniform/qef.h"
#include "uniform/sample_balls.h"

namespace tufa::uniform {

/// Where the vertex of a cell near a crease lies, and on which sheets.
struct CreasePlacement {
  Vector point{};   ///< in voxels from the middle of the cell
  Vector normal{};  ///< outward unit normal: the sheet's, or the mean of those that meet
  std::array<Vector, 3> sheets{};  ///< normals of the sheets that meet
  bool outOfCell = false;          ///< the point may lie out of the cell
  int planes = 0;  ///< 1: on one smooth sheet; 2: on a crease; 3: on a corner; 0: unknown
};

/// The plane normal . p = offset.
struct TangentPlane {
  Vector normal{};
  float offset = 0;
};

/// Places the vertex of a cell near a crease from the tangent planes of the 27 cubes around it.
///
/// The planes whose feet lie near the cell are sorted into smooth sheets; each is a plane that
/// bends as the normals of its members change from foot to foot. The vertex is the first of these
/// that exists: the corner of three sheets in the cell; the point of the crease of two sheets in
/// the cell nearest to the mass point; a corner or crease up to a voxel outside, or two if it is
/// acute, if crossings of the cell lie on all its sheets, as then no cell with a vertex holds it; a
/// point of the one sheet that passes nearest to the mass point.
///
/// Why a candidate is believed: the surface enters no ball around a sample whose radius is the
/// sample's distance. A point where only continuations of the planes meet, and not the sheets
/// themselves, lies in such a ball. If no candidate passes this test, the cell keeps its QEF's
/// vertex. It is a heuristic: where sharp edges are closer than about two voxels, too few cubes see
/// one sheet alone. Cost: the planes are shared by the cells of a block; the sheets of a cell by
/// none.
class CreaseCell {
 public:
  CreaseCell(const grid::BlockSamples& samples, const grid::FieldScale& scale)
      : samples_(samples), scale_(scale), planes_(samples, scale) {}

  /// To be called when the samples change to another block. With `balls`, counted from the block's
  /// first lattice point, a vertex may go as far as kFarthestAcute out of its cell, onto acute
  /// edges. They must outlive what is placed with them.
  void reset(const SampleBalls* balls = nullptr) {
    planes_.reset();
    balls_ = balls;
  }

  /// Places the vertex of one cell. `x`, `y`, `z` are its place in the block, 0..7; `massPoint` is
  /// in voxels from the middle of the cell.
  [[nodiscard]] CreasePlacement place(int x, int y, int z, const Vector& massPoint);

 private:
  /// A smooth sheet near the cell: the plane normal . p = offset, and how it bends.
  struct Sheet {
    Vector normal{};
    float offset = 0;
    float weight = 0;
    bool crossed = false;  ///< a crossing of the cell lies on it
    float residual = 0;    ///< mean of its cubes', in voxels
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
  // Both search in the cell, or, if `beyond`, around it among the sheets that the crossings lie on.
  [[nodiscard]] bool placeOnCorner(const Vector& massPoint, bool beyond,
                                   CreasePlacement& placement) const;
  [[nodiscard]] bool placeOnCrease(const Vector& massPoint, bool beyond,
                                   CreasePlacement& placement) const;
  [[nodiscard]] bool placeOnSide(const Vector& massPoint, CreasePlacement& placement) const;
  [[nodiscard]] TangentPlane planeOf(int sheet) const {
    return {sheets_[sheet].normal, sheets_[sheet].offset};
  }
  // How far out of the cell, in voxels, a place on two sheets may lie.
  [[nodiscard]] float mostBeyond(int a, int b) const;
  // Whether a place on sheets that its crossings lie on is believed.
  [[nodiscard]] bool isBelieved(const Vector& point) const;
  void bendSide(Sheet& sheet) const;
  // The tangent plane of a bent sheet near a point.
  [[nodiscard]] static TangentPlane tangentAt(const Sheet& sheet, const Vector& point);
  // Moves a point where the planes of some sheets meet to where the bent sheets meet.
  void followBends(Vector& point, std::initializer_list<int> sheets) const;
  void setNormal(CreasePlacement& placement, std::initializer_list<int> sheets) const;

  const grid::BlockSamples& samples_;
  const grid::FieldScale& scale_;
  CubePlanes planes_;
  std::vector<CubePlane> near_;  ///< feet in voxels from the middle of the cell
  std::vector<float> weights_;   ///< of near_
  std::vector<Sheet> sheets_;
  std::vector<std::size_t> members_;  ///< of near_: those of the sheet at hand
  /// Squared radii of the balls around the 64 samples nearest to the cell that the surface does not
  /// enter.
  std::array<std::array<float, 4>, 16> squaredBalls_{};
  std::array<int, 3> cell_{};
  const SampleBalls* balls_ = nullptr;
};

}  // namespace tufa::uniform
