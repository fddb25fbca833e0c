#include "refine/conflict_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "base/collect.h"
#include "base/parallel_sort.h"
#include "base/sort_unique.h"
#include "intersect/candidates.h"
#include "uniform/block_ranges.h"
#include "uniform/quads.h"

namespace tufa::refine {
namespace {

// Faces whose normals have a smaller cosine (140 degrees) make a fold.
constexpr double kFold = -0.766;
// An edge folded by more than 140 degrees has a face more than 70 degrees off the normal of each
// of its ends. Cosine of slightly less.
constexpr double kOffNormal = 0.36;
// Vertices nearer to each other than this, in voxels, stand for the same point of a crease.
constexpr double kSamePoint = 0.03;
// And than this if a face between them is turned over, as where the surface lies on a plane of
// samples: the cells on both sides have the same crease. One of two vertices goes so far away.
constexpr double kSameCrease = 0.15;
// Square voxels; a smaller face that is folded over, as beside vertices that stand close together
// on a crease, is let be: to move them off the crease would change the surface more.
constexpr double kLeastFace = 0.02;
// Sheets of a smaller cosine (140 degrees apart) may have faces that are a fold.
constexpr double kAcuteSheets = -0.766;
// And a fold sharper than they are by less than this, in its cosine: 3 degrees at 145.
constexpr double kAsSharp = 0.03;
// A face within this cosine (45 degrees) of a sheet lies on it.
constexpr double kOnSheet = 0.7;

void addPairs(const std::vector<intersect::PolygonPair>& pairs, std::vector<Conflict>& conflicts) {
  conflicts.reserve(conflicts.size() + pairs.size());
  for (const intersect::PolygonPair& pair : pairs) {
    conflicts.push_back({Conflict::Kind::Pair, {pair.a, pair.b}, {}});
  }
}

}  // namespace

// A face at an edge, the edge's ends in rising order.
struct ConflictFinder::EdgeFace {
  VertexIndex low, high;
  std::uint32_t face;  // twice the quad, plus 1 for its second triangle
  friend auto operator<=>(const EdgeFace&, const EdgeFace&) = default;
};

ConflictFinder::ConflictFinder(uniform::UniformSurface& surface, double margin, base::Job& job)
    : surface_(surface),
      mesh_(surface.mesh),
      margin_(margin),
      job_(job),
      polygons_(mesh_, job),
      marks_(mesh_.positions.size(), 0) {}

std::vector<Conflict> ConflictFinder::findCoincident() {
  const uniform::VertexSheets& sheets = surface_.sheets;
  if (sheets.sharpCount() == 0) return {};
  const auto coincide = [&](std::uint32_t quad, VertexIndex a, VertexIndex b) {
    return (sheets.isOutOfCell(a) || sheets.isOutOfCell(b)) && sheets.isSharp(a) &&
           sheets.isSharp(b) && isWithin(kSameCrease, a, b) &&
           (isWithin(kSamePoint, a, b) || isTurnedOver(quad));
  };
  std::vector<Conflict> conflicts;
  const auto visit = [&](std::uint32_t quad, const auto& found) {
    const auto& v = mesh_.quads[quad].vertices;
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        if (coincide(quad, v[i], v[j])) found(v[i], v[j]);
      }
    }
  };
  const auto add = [&](std::size_t begin, std::size_t end, std::vector<std::uint32_t>& found) {
    for (auto quad = static_cast<std::uint32_t>(begin); quad < end; ++quad) {
      bool any = false;
      visit(quad, [&](VertexIndex, VertexIndex) { any = true; });
      if (any) found.push_back(quad);
    }
  };
  for (const std::uint32_t quad : base::collectSorted(job_, mesh_.quads.size(), add)) {
    visit(quad, [&](VertexIndex a, VertexIndex b) {
      conflicts.push_back({Conflict::Kind::SamePoint, {quad, quad}, {a, b}});
    });
  }
  return conflicts;
}

std::vector<Conflict> ConflictFinder::findEverywhere() {
  std::vector<Conflict> conflicts;
  if (!mesh_.normals.empty()) {
    const auto add = [&](std::size_t begin, std::size_t end, std::vector<std::uint32_t>& off) {
      for (auto quad = static_cast<std::uint32_t>(begin); quad < end; ++quad) addOff(quad, off);
    };
    addFolds(base::collectSorted(job_, mesh_.quads.size(), add), conflicts);
  }
  candidates_ = intersect::findCandidates(surface_.view(), mesh_, margin_, job_);
  pairs_ = intersect::findClosePairs(polygons_, candidates_, margin_, job_);
  addPairs(pairs_.intersecting, conflicts);
  return conflicts;
}

// Without normals diagonals are not chosen by the sheets, and stay.
void ConflictFinder::noteMoved(const std::vector<VertexIndex>& vertices) {
  touched_ = quadsAt(vertices);
  if (!mesh_.normals.empty()) uniform::splitAgain(surface_.view(), touched_, mesh_, job_);
  for (const std::uint32_t quad : touched_) polygons_.update(quad);
}

// The triangle that is off may be the one beside a quad that was touched.
std::vector<Conflict> ConflictFinder::findAroundMoved(Pairs which) {
  std::vector<Conflict> conflicts;
  if (!mesh_.normals.empty()) {
    std::vector<std::uint32_t> off;
    for (const std::uint32_t quad : quadsAt(intersect::verticesOf(mesh_, touched_)))
      addOff(quad, off);
    addFolds(off, conflicts);
  }
  std::vector<std::uint32_t> others, all;
  std::set_difference(candidates_.begin(), candidates_.end(), touched_.begin(), touched_.end(),
                      std::back_inserter(others));
  const std::vector<std::uint32_t> fresh =
      which == Pairs::All
          ? touched_
          : intersect::findCandidatesAmong(touched_, surface_.view(), mesh_, margin_, job_);
  std::set_union(others.begin(), others.end(), fresh.begin(), fresh.end(), std::back_inserter(all));
  candidates_ = std::move(all);
  const auto isCandidate = [&](std::uint32_t quad) {
    return std::binary_search(candidates_.begin(), candidates_.end(), quad);
  };
  const intersect::ClosePairs found = intersect::findClosePairs(
      polygons_, touched_, margin_, job_,
      [&](std::uint32_t a, std::uint32_t b) { return isCandidate(a) || isCandidate(b); });
  intersect::renewPairsOf(touched_, found, pairs_);
  addPairs(found.intersecting, conflicts);
  return conflicts;
}

// Edges between a triangle that is off, one of `off`, and any other one.
void ConflictFinder::addFolds(const std::vector<std::uint32_t>& off,
                              std::vector<Conflict>& conflicts) {
  if (off.empty()) return;
  std::vector<VertexIndex> vertices;
  for (const std::uint32_t face : off) {
    const auto& v = cornersOf(face).vertices;
    vertices.insert(vertices.end(), v.begin(), v.end());
  }
  base::sortUnique(vertices);
  const std::vector<std::uint32_t> quads = quadsAt(vertices);
  mark(vertices, 1);
  std::vector<EdgeFace> edges;
  for (const std::uint32_t quad : quads) {
    for (const std::uint32_t face : {2 * quad, 2 * quad + 1}) {
      const auto& v = cornersOf(face).vertices;
      for (int i = 0; i < 3; ++i) {
        const VertexIndex a = v[i], b = v[(i + 1) % 3];
        if (marks_[a] != 0 && marks_[b] != 0)
          edges.push_back({std::min(a, b), std::max(a, b), face});
      }
    }
  }
  mark(vertices, 0);
  base::parallelSort(edges.begin(), edges.end(), std::less<>());
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const EdgeFace& a = edges[i];
    const EdgeFace& b = edges[i + 1];
    if (a.low != b.low || a.high != b.high || !isFold(a, b)) continue;
    conflicts.push_back({Conflict::Kind::Fold, {a.face, b.face}, {a.low, a.high}});
  }
}

std::vector<std::uint32_t> ConflictFinder::quadsAt(const std::vector<VertexIndex>& vertices) {
  mark(vertices, 1);
  std::vector<std::uint32_t> quads =
      uniform::quadsAt(surface_.topology, mesh_, vertices, marks_, job_);
  mark(vertices, 0);
  return quads;
}

void ConflictFinder::mark(const std::vector<VertexIndex>& vertices, std::uint8_t value) {
  for (const VertexIndex vertex : vertices) marks_[vertex] = value;
}

Triangle ConflictFinder::cornersOf(std::uint32_t face) const {
  const auto& v = mesh_.quads[face / 2].vertices;
  return face % 2 == 0 ? Triangle{v[0], v[1], v[2]} : Triangle{v[0], v[2], v[3]};
}

Vec3 ConflictFinder::normalOf(std::uint32_t face, const Trial& trial) const {
  const Triangle t = cornersOf(face);
  const Vec3 a = pointOf(t.vertices[0], trial);
  return (pointOf(t.vertices[1], trial) - a).cross(pointOf(t.vertices[2], trial) - a);
}

// Which of a quad's triangles are more than 70 degrees off the normal of one of their vertices.
ConflictFinder::Off ConflictFinder::offIn(std::uint32_t quad, const Trial& trial) const {
  const auto& v = mesh_.quads[quad].vertices;
  const Vec3 a = pointOf(v[0], trial), diagonal = pointOf(v[2], trial) - a;
  const std::array<Vec3, 2> normals = {(pointOf(v[1], trial) - a).cross(diagonal),
                                       diagonal.cross(pointOf(v[3], trial) - a)};
  const Vec3 first(mesh_.normals[v[0]]), third(mesh_.normals[v[2]]);
  Off off{};
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec3& normal = normals[i];
    const Vec3 own(mesh_.normals[v[2 * i + 1]]);
    const double least = std::min({normal.dot(first), normal.dot(third), normal.dot(own)});
    off[i] = least <= 0 || least * least < kOffNormal * kOffNormal * normal.squaredLength();
  }
  return off;
}

void ConflictFinder::addOff(std::uint32_t quad, std::vector<std::uint32_t>& faces) const {
  const Off off = offIn(quad);
  for (std::uint32_t i = 0; i < 2; ++i) {
    if (off[i]) faces.push_back(2 * quad + i);
  }
}

bool ConflictFinder::isWithin(double voxels, VertexIndex a, VertexIndex b,
                              const Trial& trial) const {
  const double distance = voxels * surface_.affine().voxelSize();
  return (pointOf(a, trial) - pointOf(b, trial)).squaredLength() < distance * distance;
}

bool ConflictFinder::isTurnedOver(std::uint32_t quad, const Trial& trial) const {
  if (mesh_.normals.empty()) return false;
  const Off off = offIn(quad, trial);
  return off[0] || off[1];
}

bool ConflictFinder::isFold(const EdgeFace& a, const EdgeFace& b, const Trial& trial) const {
  const Vec3 na = normalOf(a.face, trial), nb = normalOf(b.face, trial);
  const double least = 2 * kLeastFace * std::pow(surface_.affine().voxelSize(), 2);
  if (std::min(na.squaredLength(), nb.squaredLength()) < least * least) return false;
  const double cosine = na.dot(nb);
  if (cosine >= 0 || cosine * cosine < kFold * kFold * na.squaredLength() * nb.squaredLength())
    return false;
  return !isSharpAt(a.low, na, nb) || !isSharpAt(a.high, na, nb);
}

// Whether the two faces lie on two of the sheets known at a vertex, and fold no more than these.
bool ConflictFinder::isSharpAt(VertexIndex vertex, const Vec3& na, const Vec3& nb) const {
  const uniform::MeetingSheets sheets = surface_.sheets.sheets(mesh_, vertex);
  if (sheets.count < 2) return false;
  const auto sheetOf = [&](const Vec3& normal) {
    int best = -1;
    double most = kOnSheet * normal.length();
    for (int i = 0; i < sheets.count; ++i) {
      const double along = normal.dot(Vec3(sheets.normals[i]));
      if (along < most) continue;
      most = along;
      best = i;
    }
    return best;
  };
  const int first = sheetOf(na), second = sheetOf(nb);
  if (first < 0 || second < 0 || first == second) return false;
  const double sharp = Vec3(sheets.normals[first]).dot(Vec3(sheets.normals[second]));
  return sharp < kAcuteSheets && na.dot(nb) > (sharp - kAsSharp) * na.length() * nb.length();
}

Involved ConflictFinder::involvedIn(const Conflict& conflict) const {
  Involved out;
  for (const std::uint32_t part : conflict.parts) {
    if (conflict.kind == Conflict::Kind::Fold) {
      for (const VertexIndex vertex : cornersOf(part).vertices) out.add(vertex);
    } else if (conflict.kind == Conflict::Kind::Pair) {
      for (const VertexIndex vertex : mesh_.quads[part].vertices) out.add(vertex);
    }
  }
  if (conflict.kind == Conflict::Kind::SamePoint) {
    for (const VertexIndex vertex : conflict.edge) out.add(vertex);
  }
  return out;
}

bool ConflictFinder::isConflict(const Conflict& conflict, const Trial& trial) const {
  switch (conflict.kind) {
    case Conflict::Kind::SamePoint:
      return isWithin(kSameCrease, conflict.edge[0], conflict.edge[1], trial);
    case Conflict::Kind::Fold:
      return isFold({conflict.edge[0], conflict.edge[1], conflict.parts[0]},
                    {conflict.edge[0], conflict.edge[1], conflict.parts[1]}, trial);
    case Conflict::Kind::Pair:
      break;
  }
  return intersect(conflict.parts[0], conflict.parts[1], trial);
}

// In a copy of the two quads, of which one corner may be somewhere else.
bool ConflictFinder::intersect(std::uint32_t a, std::uint32_t b, const Trial& trial) const {
  std::array<Position, 8> positions;
  std::array<VertexIndex, 8> vertices;
  std::size_t count = 0;
  const auto copyOf = [&](const Quad& quad) {
    Quad own;
    for (std::size_t i = 0; i < 4; ++i) {
      const VertexIndex v = quad.vertices[i];
      const auto* const known = std::find(vertices.begin(), vertices.begin() + count, v);
      own.vertices[i] = static_cast<VertexIndex>(known - vertices.begin());
      if (known != vertices.begin() + count) continue;
      positions[count] = v == trial.vertex ? trial.to : mesh_.positions[v];
      vertices[count++] = v;
    }
    return own;
  };
  const Quad first = copyOf(mesh_.quads[a]), second = copyOf(mesh_.quads[b]);
  return intersect::intersectElsewhere({positions.data(), count}, first.vertices, second.vertices,
                                       a == b);
}

}  // namespace tufa::refine
