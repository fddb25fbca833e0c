#include "refine/placement_moves.h"

#include <algorithm>
#include <cmath>

#include "base/vec3f.h"

namespace tufa::refine {
namespace {

// Parts of the way to the next place, which are tried first.
constexpr double kParts[] = {0.05, 0.1, 0.2, 0.4};
// Voxels that a vertex may slide along its crease, and what their square counts beside other moves.
// The last ones only along an acute edge, where normals of its sheets have a smaller cosine than
// kAcute: many vertices crowd there.
constexpr double kSlides[] = {0.05, 0.1, 0.2, 0.3, 0.5, 0.8};
constexpr double kFarthestSlide = 0.3;
constexpr double kAcute = -0.3;
constexpr double kCostOfSlide = 0.05;
// And over a sheet, in these directions.
constexpr double kSlidesOnSheet[] = {0.1, 0.25, 0.5};
constexpr double kDiagonal = 0.70710678;
constexpr double kDirections[][2] = {
    {1, 0},  {kDiagonal, kDiagonal},   {0, 1},  {-kDiagonal, kDiagonal},
    {-1, 0}, {-kDiagonal, -kDiagonal}, {0, -1}, {kDiagonal, -kDiagonal}};
// What a vertex has come to: it may take so many parts of the way to its plain point, or slides,
// and as many from there to its mass point, and then so many inside its cell. At the end it is back
// at the mass point, if it was in the way of other surface.
constexpr std::uint8_t kMostParts = 6, kMostInCell = 4;
constexpr std::uint8_t kAtPlain = kMostParts + 1, kAtMassPoint = 2 * kAtPlain;
constexpr std::uint8_t kBackAtMassPoint = kAtMassPoint + kMostInCell + 1;
// Parts of the way to the middle of the cell. The last one is made if nothing else helps.
constexpr double kInwards[] = {0.1, 0.2, 0.4};
// Voxels from the faces of a cell: what is nearer may be outside.
constexpr double kInside = 1e-5;

}  // namespace

void PlacementMoves::add(VertexIndex vertex, const Position& plain, const Position& mass,
                         std::vector<PlacementMove>& moves) const {
  const Position& from = surface_.mesh.positions[vertex];
  const Vec3 at(from);
  const auto addTo = [&](const Vec3& to, std::uint8_t step) {
    const double distance2 = (to - at).squaredLength();
    const bool isWhole = step == kAtPlain || step == kAtMassPoint || step == kBackAtMassPoint;
    if (distance2 > 0) {
      moves.push_back({vertex, {to[0], to[1], to[2]}, step, distance2, false, isWhole});
    }
  };
  if (wasAtMassPoint(vertex)) return addTo(Vec3(mass), kBackAtMassPoint);
  const bool isPlaced = steps_[vertex] < kAtPlain && !(plain == from);
  if (isPlaced) addSlides(vertex, moves);
  const std::uint8_t step = isPlaced ? steps_[vertex] : std::max(steps_[vertex], kAtPlain);
  if (step != kAtPlain - 1 && step != kAtMassPoint - 1) {
    for (const double share : kParts) {
      const auto next = static_cast<std::uint8_t>(step + 1);
      if (isPlaced) addTo(at + (Vec3(plain) - at) * share, next);
      addTo(at + (Vec3(mass) - at) * share, next);
    }
  }
  if (isPlaced) addTo(Vec3(plain), kAtPlain);
  addTo(Vec3(mass), kAtMassPoint);
}

void PlacementMoves::addSlides(VertexIndex vertex, std::vector<PlacementMove>& moves) const {
  if (steps_[vertex] >= kMostParts) return;
  const Vec3 at(surface_.mesh.positions[vertex]), along = alongCrease(vertex);
  const uniform::MeetingSheets sheets = surface_.sheets.sheets(surface_.mesh, vertex);
  if (!(along.squaredLength() > 0)) return;
  const auto step = static_cast<std::uint8_t>(steps_[vertex] + 1);
  const bool isAcute = Vec3(sheets.normals[0]).dot(Vec3(sheets.normals[1])) < kAcute;
  for (const double slide : kSlides) {
    if (slide > kFarthestSlide && !isAcute) break;
    for (const double way : {slide, -slide}) {
      const Vec3 to = at + along * way;
      const double cost = kCostOfSlide * (to - at).squaredLength();
      moves.push_back({vertex, {to[0], to[1], to[2]}, step, cost, true});
    }
  }
}

// Over the sheet that a vertex is on, in several directions: as far as the sheet is flat, the
// surface stays where it was.
void PlacementMoves::addSlidesOnSheet(VertexIndex vertex, std::vector<PlacementMove>& moves) const {
  if (steps_[vertex] >= kMostParts) return;
  if (surface_.sheets.kind(vertex) != uniform::VertexSheets::Kind::Near) return;
  const uniform::MeetingSheets sheets = surface_.sheets.sheets(surface_.mesh, vertex);
  if (sheets.count != 1) return;
  const auto step = static_cast<std::uint8_t>(steps_[vertex] + 1);
  const auto add = [&](const Position& to, double length) {
    moves.push_back({vertex, to, step, kCostOfSlide * length * length, true});
  };
  forSlidesOnSheet(Vec3(surface_.mesh.positions[vertex]), Vec3(sheets.normals[0]), add);
}

template <class Add>
void PlacementMoves::forSlidesOnSheet(const Vec3& from, const Vec3& normal, const Add& add) const {
  const base::Frame frame = base::frameAbout(base::Vec3f(normal));
  for (const double slide : kSlidesOnSheet) {
    const double length = slide * surface_.affine().voxelSize();
    for (const auto& [x, y] : kDirections) {
      const Vec3 to = from + (Vec3(frame.x) * x + Vec3(frame.y) * y) * length;
      add(Position{to[0], to[1], to[2]}, length);
    }
  }
}

void PlacementMoves::addMovesInCell(VertexIndex vertex, const Position& mass,
                                    std::vector<PlacementMove>& moves) const {
  if (!wasAtMassPoint(vertex) || steps_[vertex] >= kAtMassPoint + kMostInCell) return;
  const grid::Affine& affine = surface_.affine();
  const Vec3 home = affine.latticePoint(mass, affine.origin());
  const Vec3 cell(std::floor(home[0]), std::floor(home[1]), std::floor(home[2]));
  const auto isInCell = [&](const Position& p) {
    const Vec3 at = affine.latticePoint(p, affine.origin()) - cell;
    return std::min({at[0], at[1], at[2]}) > kInside &&
           std::max({at[0], at[1], at[2]}) < 1 - kInside;
  };
  if (!isInCell(mass)) return;
  const Vec3 at(surface_.mesh.positions[vertex]);
  const auto step = static_cast<std::uint8_t>(steps_[vertex] + 1);
  const uniform::MeetingSheets sheets = surface_.sheets.sheets(surface_.mesh, vertex);
  if (sheets.count == 1) {
    forSlidesOnSheet(at, Vec3(sheets.normals[0]), [&](const Position& to, double length) {
      if (isInCell(to)) {
        moves.push_back({vertex, to, step, kCostOfSlide * length * length, true});
      }
    });
  }
  const Vec3 middle(affine.position(affine.origin(), cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5));
  for (const double share : kInwards) {
    const Vec3 to = at + (middle - at) * share;
    const bool isLast = share == *std::rbegin(kInwards);
    const double cost = (to - at).squaredLength();
    moves.push_back({vertex, {to[0], to[1], to[2]}, step, cost, true, isLast});
  }
}

// One voxel along the crease that a vertex is on; 0 if it is on none, or at a corner.
Vec3 PlacementMoves::alongCrease(VertexIndex vertex) const {
  const uniform::MeetingSheets sheets = surface_.sheets.sheets(surface_.mesh, vertex);
  if (sheets.count != 2) return Vec3(0);
  Vec3 along = Vec3(sheets.normals[0]).cross(Vec3(sheets.normals[1]));
  if (!along.normalize()) return Vec3(0);
  return along * surface_.affine().voxelSize();
}

PlacementMove PlacementMoves::toMassPoint(VertexIndex vertex, const Position& mass) {
  return {vertex, mass, kAtMassPoint, 0};
}

bool PlacementMoves::wasAtMassPoint(VertexIndex vertex) const {
  return steps_[vertex] >= kAtMassPoint;
}

bool PlacementMoves::leavesCrease(const PlacementMove& move) { return move.step >= kAtPlain; }

bool PlacementMoves::note(const PlacementMove& move) {
  const bool isFirst = steps_[move.vertex] == 0;
  steps_[move.vertex] = move.step;
  return isFirst;
}

}  // namespace tufa::refine
