#include "uniform/crease_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "uniform/acute.h"
#include "uniform/case_table.h"

namespace tufa::uniform {

using grid::BlockSamples;

namespace {

// Planes whose normals differ by less than this (18 degrees) may be of one sheet.
constexpr float kSameSide = 0.95F;
// Planes farther than this from each other, in voxels at the foot of one, are of two sheets.
constexpr float kSameSheet = 0.25F;
// A plane whose foot is farther than this from the cell, in voxels, tells nothing of it.
constexpr float kReach = 1.25F;
constexpr float kCellFace = 0.5F;
// How far a vertex may leave its cell, in voxels, where its crossings lie on sheets that meet
// outside.
constexpr float kBeyond = 1.0F;
// And onto an acute edge by kFarthestAcute, if its sheets are flat for sure: their cubes are linear
// to so many voxels.
constexpr float kFlat = 0.01F;
// A vertex this deep in its cell, in voxels, is in it whatever the rounding.
constexpr float kSureInside = 1e-3F;
// A vertex on one sheet may leave its cell by this, in voxels.
constexpr float kSideSlack = 0.02F;
constexpr int kProjections = 8;
// Slack of a crossing's place on its edge.
constexpr float kEdgeSlack = 0.01F;
constexpr int kMostSheets = 5;
// Planes are nearly parallel if the square of the sine of their angle, or the volume that three
// normals span, is less.
constexpr float kLeastSquaredSine = 0.05F;
constexpr float kLeastVolume = 0.1F;
// Damping of a bend, in squared voxels: feet that spread less than a third of a voxel tell little
// of it.
constexpr float kBendDamping = 0.02F;
constexpr int kBendRounds = 3;
// A bend that moves a point farther than this, in voxels, is not trusted.
constexpr float kFarthestBend = 0.5F;
// A sheet within this angle (radians) and distance (voxels) of lying between two others is a blend.
constexpr float kBlendAngle = 0.15F;
constexpr float kBlendDistance = 0.2F;

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector cornerPoint(int corner) {
  return {static_cast<float>(corner >> 2) - 0.5F, static_cast<float>((corner >> 1) & 1) - 0.5F,
          static_cast<float>(corner & 1) - 0.5F};
}

Vector plus(const Vector& a, const Vector& b, float scale) {
  return {a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]};
}

Vector bent(const std::array<float, 6>& bend, const Vector& step) {
  return {bend[0] * step[0] + bend[1] * step[1] + bend[2] * step[2],
          bend[1] * step[0] + bend[3] * step[1] + bend[4] * step[2],
          bend[2] * step[0] + bend[4] * step[1] + bend[5] * step[2]};
}

// Each moves a point the shortest way; false if the planes are nearly parallel.
bool moveOnto(const TangentPlane& plane, Vector& point) {
  point = plus(point, plane.normal, plane.offset - dot(plane.normal, point));
  return true;
}

bool moveOntoBoth(const TangentPlane& a, const TangentPlane& b, Vector& point) {
  const float cosine = dot(a.normal, b.normal);
  const float squared = 1 - cosine * cosine;
  if (squared < kLeastSquaredSine) return false;
  const float da = a.offset - dot(a.normal, point), db = b.offset - dot(b.normal, point);
  point = plus(point, a.normal, (da - cosine * db) / squared);
  point = plus(point, b.normal, (db - cosine * da) / squared);
  return true;
}

bool moveOntoAll(const std::array<TangentPlane, 3>& planes, Vector& point) {
  const auto& [a, b, c] = planes;
  const Vector ab = cross(a.normal, b.normal);
  const float volume = dot(ab, c.normal);
  if (std::abs(volume) < kLeastVolume) return false;
  point = plus({}, cross(b.normal, c.normal), a.offset / volume);
  point = plus(point, cross(c.normal, a.normal), b.offset / volume);
  point = plus(point, ab, c.offset / volume);
  return true;
}

float outside(const Vector& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) - kCellFace;
}

// Moves a point along a line into the cube of that half size around the cell's middle; false if the
// line misses it.
bool slideInto(float half, const Vector& direction, Vector& point) {
  float from = -std::numeric_limits<float>::infinity(), to = -from;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1e-6F) {
      if (std::abs(point[axis]) > half) return false;
      continue;
    }
    const float s = (-half - point[axis]) / direction[axis];
    const float t = (half - point[axis]) / direction[axis];
    from = std::max(from, std::min(s, t));
    to = std::min(to, std::max(s, t));
  }
  if (from > to) return false;
  point = plus(point, direction, std::clamp(0.0F, from, to));
  return true;
}

}  // namespace

// See the class for the order of the candidates.
CreasePlacement CreaseCell::place(int x, int y, int z, const Vector& massPoint) {
  CreasePlacement placement;
  cell_ = {x, y, z};
  collectPlanes();
  sortIntoSheets();
  dropBlendedSheets();
  readBalls();
  markCrossedSheets();
  if (placeOnCorner(massPoint, false, placement) || placeOnCrease(massPoint, false, placement) ||
      placeOnCorner(massPoint, true, placement) || placeOnCrease(massPoint, true, placement) ||
      placeOnSide(massPoint, placement)) {
    placement.outOfCell = outside(placement.point) > -kSureInside;
    return placement;
  }
  return {};
}

void CreaseCell::collectPlanes() {
  near_.clear();
  weights_.clear();
  const auto [x, y, z] = cell_;
  const Vector middle = {static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F,
                         static_cast<float>(z) + 0.5F};
  for (int cube = 0; cube < 27; ++cube) {
    const CubePlane* plane = planes_.at(x + cube / 9 - 1, y + cube / 3 % 3 - 1, z + cube % 3 - 1);
    if (plane == nullptr) continue;
    CubePlane local = *plane;
    local.foot = plus(local.foot, middle, -1);
    const float away = std::max(0.0F, outside(local.foot));
    if (away > kReach) continue;
    near_.push_back(local);
    const float quality = local.residual * local.residual + 1e-6F;
    weights_.push_back(1 / (quality * (1 + 16 * away * away)));
  }
}

// Greedy: the best plane left starts a sheet, and all planes that agree with it join. Planes are
// weighted by how linear the samples are and how near the foot is to the cell.
void CreaseCell::sortIntoSheets() {
  sheets_.clear();
  while (static_cast<int>(sheets_.size()) < kMostSheets) {
    const auto best = std::max_element(weights_.begin(), weights_.end());
    if (best == weights_.end() || *best <= 0) break;
    const CubePlane seed = near_[static_cast<std::size_t>(best - weights_.begin())];
    Sheet sheet;
    Vector point{};
    members_.clear();
    for (std::size_t i = 0; i < near_.size(); ++i) {
      if (weights_[i] <= 0 || dot(near_[i].normal, seed.normal) < kSameSide) continue;
      const Vector apart = plus(near_[i].foot, seed.foot, -1);
      if (std::abs(dot(seed.normal, apart)) > kSameSheet) continue;
      sheet.normal = plus(sheet.normal, near_[i].normal, weights_[i]);
      point = plus(point, near_[i].foot, weights_[i]);
      sheet.weight += weights_[i];
      sheet.residual += weights_[i] * near_[i].residual;
      members_.push_back(i);
    }
    const float length = std::sqrt(dot(sheet.normal, sheet.normal));
    for (float& n : sheet.normal) n /= length;
    sheet.offset = dot(sheet.normal, point) / sheet.weight;
    sheet.residual /= sheet.weight;
    for (int i = 0; i < 3; ++i) sheet.middle[i] = point[i] / sheet.weight;
    bendSide(sheet);
    for (const std::size_t member : members_) weights_[member] = 0;
    sheets_.push_back(sheet);
  }
}

// The bend of a sheet: the matrix H of least squares in n_i - n = H (f_i - m), over the feet f_i
// and normals n_i, damped where the feet do not spread, and made symmetric. It is the shape
// operator up to sign; a surface of that bend through m is n . (p - m) + (p - m) H (p - m) / 2 = 0.
void CreaseCell::bendSide(Sheet& sheet) const {
  std::array<float, 6> spread{};  // xx, xy, xz, yy, yz, zz
  std::array<Vector, 3> turn{};   // turn[i][j]: change of normal i with step j
  for (const std::size_t member : members_) {
    const float weight = weights_[member] / sheet.weight;
    const Vector step = plus(near_[member].foot, sheet.middle, -1);
    const Vector change = plus(near_[member].normal, sheet.normal, -1);
    for (int i = 0, k = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) turn[i][j] += weight * change[i] * step[j];
      for (int j = i; j < 3; ++j) spread[k++] += weight * step[i] * step[j];
    }
  }
  spread[0] += kBendDamping;
  spread[3] += kBendDamping;
  spread[5] += kBendDamping;
  // The rows of the inverse of a symmetric matrix are cross products of its rows.
  const Vector r0 = {spread[0], spread[1], spread[2]}, r1 = {spread[1], spread[3], spread[4]},
               r2 = {spread[2], spread[4], spread[5]};
  const std::array<Vector, 3> adjoint = {cross(r1, r2), cross(r2, r0), cross(r0, r1)};
  const float determinant = dot(r0, adjoint[0]);
  for (int i = 0, k = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      sheet.bend[k++] = (dot(turn[i], adjoint[j]) + dot(turn[j], adjoint[i])) / (2 * determinant);
    }
  }
  for (const std::size_t member : members_) {
    const Vector step = plus(near_[member].foot, sheet.middle, -1);
    sheet.rise += weights_[member] / sheet.weight * 0.5F * dot(step, bent(sheet.bend, step));
  }
}

TangentPlane CreaseCell::tangentAt(const Sheet& sheet, const Vector& point) {
  const Vector step = plus(point, sheet.middle, -1);
  const Vector turn = bent(sheet.bend, step);
  const float value = dot(sheet.normal, step) + 0.5F * dot(step, turn) - sheet.rise;
  TangentPlane plane{plus(sheet.normal, turn, 1), 0};
  const float length = std::sqrt(dot(plane.normal, plane.normal));
  for (float& n : plane.normal) n /= length;
  plane.offset = dot(plane.normal, point) - value / length;
  return plane;
}

// Newton's method: the point of the tangent planes at the last point. Back to the start if a step
// leaves the range in which bends are trusted.
void CreaseCell::followBends(Vector& point, std::initializer_list<int> sheets) const {
  const Vector start = point;
  for (int round = 0; round < kBendRounds; ++round) {
    std::array<TangentPlane, 3> planes;
    int count = 0;
    for (const int sheet : sheets) planes[count++] = tangentAt(sheets_[sheet], point);
    const bool found = count == 1   ? moveOnto(planes[0], point)
                       : count == 2 ? moveOntoBoth(planes[0], planes[1], point)
                                    : moveOntoAll(planes, point);
    const Vector way = plus(point, start, -1);
    if (!found || dot(way, way) > kFarthestBend * kFarthestBend) {
      point = start;
      return;
    }
  }
}

// Whether a sheet is a blend of two others. Beyond a convex edge the nearest surface point is on
// the edge itself, so planes seen there touch the edge at angles between those of the two sheets;
// they are no sheet of their own.
bool CreaseCell::isBlend(const Sheet& sheet, const Sheet& a, const Sheet& b) const {
  if (sheet.weight > a.weight || sheet.weight > b.weight) return false;
  // sheet.normal = s a.normal + t b.normal, with s and t positive, up to a few degrees.
  const float cosine = dot(a.normal, b.normal);
  const float squared = 1 - cosine * cosine;
  if (squared < 0.05F) return false;
  const float da = dot(sheet.normal, a.normal), db = dot(sheet.normal, b.normal);
  const float s = (da - cosine * db) / squared, t = (db - cosine * da) / squared;
  if (s < 0 || t < 0) return false;
  const Vector between = plus(plus({}, a.normal, s), b.normal, t);
  const Vector apart = plus(sheet.normal, between, -1);
  return dot(apart, apart) < kBlendAngle * kBlendAngle &&
         std::abs(sheet.offset - s * a.offset - t * b.offset) < kBlendDistance;
}

void CreaseCell::dropBlendedSheets() {
  std::array<bool, kMostSheets> drop{};
  for (std::size_t k = 0; k < sheets_.size(); ++k) {
    for (std::size_t i = 0; i < sheets_.size(); ++i) {
      for (std::size_t j = i + 1; j < sheets_.size(); ++j) {
        if (i != k && j != k && isBlend(sheets_[k], sheets_[i], sheets_[j])) drop[k] = true;
      }
    }
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < sheets_.size(); ++k) {
    if (!drop[k]) sheets_[kept++] = sheets_[k];
  }
  sheets_.resize(kept);
}

// A sheet is crossed where its plane meets a crossed edge of the cell in a point of the surface.
void CreaseCell::markCrossedSheets() {
  for (int edge = 0; edge < kEdges; ++edge) {
    const auto [lower, upper] = edgeCorners(edge);
    if ((sampleAt(lower) < 0) == (sampleAt(upper) < 0)) continue;
    const Vector from = cornerPoint(lower);
    const int axis = edge / 4;
    for (Sheet& sheet : sheets_) {
      if (sheet.crossed || std::abs(sheet.normal[axis]) < 1e-3F) continue;
      const float along = (sheet.offset - dot(sheet.normal, from)) / sheet.normal[axis];
      if (along < -kEdgeSlack || along > 1 + kEdgeSlack) continue;
      Vector point = from;
      point[axis] += along;
      sheet.crossed = isOnSurface(point);
    }
  }
}

float CreaseCell::sampleAt(int corner) const {
  return samples_[BlockSamples::index(cell_[0] + (corner >> 2), cell_[1] + ((corner >> 1) & 1),
                                      cell_[2] + (corner & 1))];
}

// A sample outside the narrow band is clamped, and so is its ball: smaller than it might be, never
// larger.
void CreaseCell::readBalls() {
  const auto [x, y, z] = cell_;
  for (int row = 0; row < 16; ++row) {
    const float* samples =
        samples_.data() + BlockSamples::index(x + row / 4 - 1, y + row % 4 - 1, z - 1);
    for (int i = 0; i < 4; ++i) {
      const float radius = std::min(std::abs(samples[i]), scale_.bandOutside) - SampleBalls::kSlack;
      squaredBalls_[row][i] = radius > 0 ? radius * radius : 0;
    }
  }
}

// Whether the point lies in none of the balls that the surface does not enter. Without branches: 64
// balls are tested in a few vector instructions.
bool CreaseCell::isOnSurface(const Vector& point) const {
  std::array<std::array<float, 4>, 3> squared;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 4; ++i) {
      const float apart = static_cast<float>(i) - 1.5F - point[axis];
      squared[axis][i] = apart * apart;
    }
  }
  int inBalls = 0;
  for (int row = 0; row < 16; ++row) {
    const float across = squared[0][row / 4] + squared[1][row % 4];
    for (int i = 0; i < 4; ++i) {
      inBalls |= static_cast<int>(across + squared[2][i] < squaredBalls_[row][i]);
    }
  }
  return inBalls == 0;
}

void CreaseCell::setNormal(CreasePlacement& placement, std::initializer_list<int> sheets) const {
  Vector sum{};
  int count = 0;
  for (const int sheet : sheets) {
    const Vector normal = tangentAt(sheets_[sheet], placement.point).normal;
    sum = plus(sum, normal, 1);
    placement.sheets[count++] = normal;
  }
  const float length = std::sqrt(dot(sum, sum));
  for (int i = 0; i < 3; ++i) placement.normal[i] = length > 0 ? sum[i] / length : 0;
  placement.planes = static_cast<int>(sheets.size());
}

float CreaseCell::mostBeyond(int a, int b) const {
  if (balls_ == nullptr) return kBeyond;
  const Sheet &one = sheets_[a], &other = sheets_[b];
  const bool isFlat = std::max(one.residual, other.residual) < kFlat;
  const bool isFar = isFlat && isAcute(double{dot(one.normal, other.normal)});
  return isFar ? static_cast<float>(kFarthestAcute) : kBeyond;
}

bool CreaseCell::isBelieved(const Vector& point) const {
  if (!isOnSurface(point)) return false;
  if (balls_ == nullptr || outside(point) <= kBeyond) return true;
  const Vec3 middle(cell_[0] + 0.5, cell_[1] + 0.5, cell_[2] + 0.5);
  return balls_->admit(middle + Vec3(point[0], point[1], point[2]));
}

bool CreaseCell::placeOnCorner(const Vector& massPoint, bool beyond,
                               CreasePlacement& placement) const {
  float nearest = std::numeric_limits<float>::infinity();
  const int count = static_cast<int>(sheets_.size());
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      for (int k = j + 1; k < count; ++k) {
        if (beyond && !(sheets_[i].crossed && sheets_[j].crossed && sheets_[k].crossed)) continue;
        Vector point{};
        if (!moveOntoAll({planeOf(i), planeOf(j), planeOf(k)}, point)) continue;
        const float most =
            beyond ? std::max({mostBeyond(i, j), mostBeyond(i, k), mostBeyond(j, k)}) : 0;
        if (outside(point) > most + kFarthestBend) continue;
        followBends(point, {i, j, k});
        if (outside(point) > most) continue;
        const Vector apart = plus(point, massPoint, -1);
        if (dot(apart, apart) >= nearest || !isBelieved(point)) continue;
        nearest = dot(apart, apart);
        placement.point = point;
        setNormal(placement, {i, j, k});
      }
    }
  }
  return placement.planes != 0;
}

bool CreaseCell::placeOnCrease(const Vector& massPoint, bool beyond,
                               CreasePlacement& placement) const {
  float nearest = std::numeric_limits<float>::infinity();
  const int count = static_cast<int>(sheets_.size());
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      if (beyond && !(sheets_[i].crossed && sheets_[j].crossed)) continue;
      // The point of both planes nearest to the mass point, then along the crease into the cell.
      Vector point = massPoint;
      if (!moveOntoBoth(planeOf(i), planeOf(j), point)) continue;
      followBends(point, {i, j});
      const Vector direction =
          cross(tangentAt(sheets_[i], point).normal, tangentAt(sheets_[j], point).normal);
      const Vector before = point;
      if (!slideInto(kCellFace + (beyond ? mostBeyond(i, j) : 0), direction, point)) continue;
      if (point != before) followBends(point, {i, j});
      const Vector apart = plus(point, massPoint, -1);
      if (dot(apart, apart) >= nearest || !isBelieved(point)) continue;
      nearest = dot(apart, apart);
      placement.point = point;
      setNormal(placement, {i, j});
    }
  }
  return placement.planes != 0;
}

bool CreaseCell::placeOnSide(const Vector& massPoint, CreasePlacement& placement) const {
  float nearest = std::numeric_limits<float>::infinity();
  for (int i = 0; i < static_cast<int>(sheets_.size()); ++i) {
    const float away = std::abs(sheets_[i].offset - dot(sheets_[i].normal, massPoint));
    if (away >= nearest) continue;
    // Into the cell and onto the plane alternately: converges to a point of both, if there is one.
    Vector point = massPoint;
    for (int step = 0; step < kProjections; ++step) {
      for (float& p : point) p = std::clamp(p, -kCellFace, kCellFace);
      point = plus(point, sheets_[i].normal, sheets_[i].offset - dot(sheets_[i].normal, point));
    }
    if (outside(point) > kSideSlack) continue;
    followBends(point, {i});
    if (!isOnSurface(point)) continue;
    nearest = away;
    placement.point = point;
    setNormal(placement, {i});
  }
  return placement.planes != 0;
}

}  // namespace tufa::uniform
