#include "refine/repair/pair_group.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/single_precision.h"
#include "base/sort_unique.h"

namespace tufa::refine {
namespace {

// Shares of the way to the mass point, and to a neighbour, that are tried.
constexpr std::array kToMassPoint = {0.25, 0.5, 0.75, 1.0};
constexpr std::array kToNeighbour = {0.15, 0.3, 0.5};
// Harm of a fan, in voxels: it moves no vertex, but adds triangles.
constexpr double kFanHarm = 0.1;
// Harm of moving along the surface, per voxel: it makes triangles uneven.
constexpr double kSlideHarm = 0.02;
// Edits tried in a group for each of its pairs, before giving up.
constexpr std::size_t kMostChanges = 20;

}  // namespace

PairGroup::PairGroup(LocalMesh mesh, const std::vector<intersect::PolygonPair>& pairs,
                     const FallbackPositions& fallbacks)
    : mesh_(std::move(mesh)), fallbacks_(fallbacks) {
  for (const intersect::PolygonPair& pair : pairs) {
    pairs_.push_back({mesh_.find(pair.a), mesh_.find(pair.b)});
  }
}

Changes PairGroup::repairIntersections(bool lastResort) {
  const std::size_t most = kMostChanges * (pairs_.size() + 1);
  std::vector<Pair> stuck;
  for (std::size_t i = 0; i < most; ++i) {
    // The next one by place: a grid that is translated has other indices.
    const Pair* next = nullptr;
    for (const Pair& pair : pairs_) {
      if (std::find(stuck.begin(), stuck.end(), pair) != stuck.end()) continue;
      if (next == nullptr ||
          placeOf(pair[0]) + placeOf(pair[1]) < placeOf((*next)[0]) + placeOf((*next)[1])) {
        next = &pair;
      }
    }
    if (next == nullptr) break;
    Pair pair = *next;
    if (placeOf(pair[1]) < placeOf(pair[0])) std::swap(pair[0], pair[1]);
    const Pair named = *next;
    if (improve(pair) || (lastResort && takeLastResort(pair))) continue;
    stuck.push_back(named);
  }
  return changes();
}

// The sum of the corners.
Vec3 PairGroup::placeOf(Local polygon) const {
  Vec3 sum(0);
  for (const Local vertex : mesh_.corners(polygon)) sum += Vec3(mesh_.point(vertex));
  return sum;
}

std::vector<PairGroup::Edit> PairGroup::editsFor(const Pair& pair) const {
  std::vector<Edit> edits;
  std::vector<Local> vertices;
  for (const Local polygon : pair) {
    addFlip(polygon, edits);
    addFan(polygon, edits);
    const intersect::Corners corners = mesh_.corners(polygon);
    vertices.insert(vertices.end(), corners.begin(), corners.end());
    if (pair[0] == pair[1]) break;
  }
  base::sortUnique(vertices);
  for (const Local vertex : vertices) addMoves(vertex, edits);
  if (Edit all = retreat(pair); !all.moves.empty()) edits.push_back(std::move(all));
  std::stable_sort(edits.begin(), edits.end(),
                   [](const Edit& a, const Edit& b) { return a.harm < b.harm; });
  return edits;
}

// Whether an edge between two vertices exists already, apart from those of one polygon. A flip
// would use it twice.
bool PairGroup::isEdge(Local a, Local b, Local apart) const {
  const auto& around = mesh_.around(a);
  return std::any_of(around.begin(), around.end(), [&](Local polygon) {
    std::array<Triangle, 2> triangles;
    const int count =
        polygon == apart ? 0 : intersect::trianglesOf(mesh_.corners(polygon), triangles);
    return std::any_of(triangles.begin(), triangles.begin() + count, [&](const Triangle& t) {
      const auto& v = t.vertices;
      return std::find(v.begin(), v.end(), a) != v.end() &&
             std::find(v.begin(), v.end(), b) != v.end();
    });
  });
}

// Harm: the gap between the diagonals, seen as lines. Quads whose vertices are all fixed keep
// theirs.
void PairGroup::addFlip(Local polygon, std::vector<Edit>& edits) const {
  const intersect::Corners v = mesh_.corners(polygon);
  if (v.size() != 4 || std::none_of(v.begin(), v.end(), [&](Local i) { return canMove(i); }) ||
      isEdge(v[1], v[3], polygon))
    return;
  const Vec3 p0 = Vec3(mesh_.point(v[0])), p1 = Vec3(mesh_.point(v[1]));
  const Vec3 across = (Vec3(mesh_.point(v[2])) - p0).cross(Vec3(mesh_.point(v[3])) - p1);
  const double length = across.length();
  Edit edit;
  edit.harm = length > 0 ? std::abs(across.dot(p1 - p0)) / length / fallbacks_.voxelSize : 0;
  edit.turns = {polygon};
  edits.push_back(std::move(edit));
}

bool PairGroup::canMove(Local vertex) const {
  return !mesh_.isNew(vertex) && fallbacks_.massPoints.count(mesh_.vertexOf(vertex)) != 0;
}

bool PairGroup::canFan(Local polygon) const {
  return mesh_.corners(polygon).size() == 4 &&
         fallbacks_.crossings.count(mesh_.polygonOf(polygon)) != 0;
}

void PairGroup::addFan(Local polygon, std::vector<Edit>& edits) const {
  if (!canFan(polygon)) return;
  Edit edit;
  edit.harm = kFanHarm;
  edit.fans = {polygon};
  edits.push_back(std::move(edit));
}

// Proposes moves towards the mass point and towards each neighbour. Harm: how far the vertex leaves
// the planes of the triangles around it, root mean square weighted by area (Garland and Heckbert
// 1997).
void PairGroup::addMoves(Local vertex, std::vector<Edit>& edits) const {
  if (mesh_.isNew(vertex)) return;
  const auto fallback = fallbacks_.massPoints.find(mesh_.vertexOf(vertex));
  if (fallback == fallbacks_.massPoints.end()) return;
  const Vec3 from = Vec3(mesh_.point(vertex));
  std::vector<Local> neighbours;
  std::vector<Vec3> normals;  // of twice the length of the area
  double area = 0;
  for (const Local polygon : mesh_.around(vertex)) {
    std::array<Triangle, 2> triangles;
    const int count = intersect::trianglesOf(mesh_.corners(polygon), triangles);
    for (int i = 0; i < count; ++i) {
      const auto& v = triangles[i].vertices;
      if (std::find(v.begin(), v.end(), vertex) == v.end()) continue;
      const Vec3 a = Vec3(mesh_.point(v[0]));
      normals.push_back((Vec3(mesh_.point(v[1])) - a).cross(Vec3(mesh_.point(v[2])) - a));
      area += normals.back().length();
      for (const Local other : v) {
        if (other != vertex) neighbours.push_back(other);
      }
    }
  }
  base::sortUnique(neighbours);
  const auto propose = [&](const Vec3& target, double share) {
    const Vec3 way = (target - from) * share;
    double squares = 0;
    for (const Vec3& normal : normals) {
      const double length = normal.length();
      if (length > 0) squares += std::pow(normal.dot(way), 2) / length;
    }
    Edit edit;
    const double off = area > 0 ? std::sqrt(squares / area) : 0;
    edit.harm = (off + kSlideHarm * way.length()) / fallbacks_.voxelSize;
    const Vec3 to = share == 1 ? target : from + way;
    const Position exact(to[0], to[1], to[2]);
    const Position position = fallbacks_.singlePrecision ? base::toSingle(exact) : exact;
    if (position == mesh_.point(vertex)) return;
    edit.moves = {{vertex, position}};
    edits.push_back(std::move(edit));
  };
  for (const double share : kToMassPoint) propose(Vec3(fallback->second), share);
  for (const Local neighbour : neighbours) {
    for (const double share : kToNeighbour) propose(Vec3(mesh_.point(neighbour)), share);
  }
}

// Moves all vertices of both polygons to their mass points.
PairGroup::Edit PairGroup::retreat(const Pair& pair) const {
  Edit edit;
  for (const Local polygon : pair) {
    for (const Local vertex : mesh_.corners(polygon)) {
      if (mesh_.isNew(vertex)) continue;
      const auto fallback = fallbacks_.massPoints.find(mesh_.vertexOf(vertex));
      if (fallback == fallbacks_.massPoints.end() || fallback->second == mesh_.point(vertex))
        continue;
      const std::pair<Local, Position> move{vertex, fallback->second};
      if (std::find(edit.moves.begin(), edit.moves.end(), move) != edit.moves.end()) continue;
      edit.moves.push_back(move);
      const Vec3 way = Vec3(fallback->second) - Vec3(mesh_.point(vertex));
      edit.harm += way.length() / fallbacks_.voxelSize;
    }
  }
  return edit;
}

bool PairGroup::improve(const Pair& pair) {
  const std::vector<Edit> edits = editsFor(pair);
  return std::any_of(edits.begin(), edits.end(),
                     [&](const Edit& edit) { return attempt(edit, pair); });
}

bool PairGroup::takeLastResort(const Pair& pair) {
  Edit edit = retreat(pair);
  if (edit.moves.empty()) {
    for (const Local polygon : pair) {
      if (canFan(polygon)) edit.fans.push_back(polygon);
    }
    base::sortUnique(edit.fans);
    if (edit.fans.empty()) return false;
  }
  apply(edit);
  const std::vector<Local> touched = touchedBy(edit);
  accept(edit, touched, pairsOf(touched));
  return true;
}

// The pair itself is tested first, as most edits do not separate it. Pairs of untouched polygons do
// not change, so those of touched ones are counted before and after.
bool PairGroup::attempt(const Edit& edit, const Pair& pair) {
  apply(edit);
  if (edit.fans.empty() && mesh_.meet(pair[0], pair[1])) {
    undo(edit);
    return false;
  }
  const std::vector<Local> touched = touchedBy(edit);
  const auto isTouched = [&](Local polygon) {
    return std::binary_search(touched.begin(), touched.end(), polygon);
  };
  const auto before = std::count_if(pairs_.begin(), pairs_.end(), [&](const Pair& p) {
    return isTouched(p[0]) || isTouched(p[1]);
  });
  if (std::any_of(touched.begin(), touched.end(), [&](Local p) { return mesh_.isFlat(p); })) {
    undo(edit);
    return false;
  }
  const std::vector<Pair> after = pairsOf(touched);
  if (static_cast<std::ptrdiff_t>(after.size()) >= before) {
    undo(edit);
    return false;
  }
  accept(edit, touched, after);
  return true;
}

void PairGroup::apply(const Edit& edit) {
  undoMoves_.clear();
  undoFans_.clear();
  for (const auto& [vertex, to] : edit.moves) {
    undoMoves_.emplace_back(vertex, mesh_.point(vertex));
    mesh_.move(vertex, to);
  }
  for (const Local quad : edit.turns) mesh_.turn(quad);
  for (const Local quad : edit.fans) {
    const intersect::Corners v = mesh_.corners(quad);
    undoFans_.emplace_back(quad, Quad(v[0], v[1], v[2], v[3]));
    mesh_.fan(quad, fallbacks_.crossings.at(mesh_.polygonOf(quad)));
  }
}

void PairGroup::undo(const Edit& edit) {
  for (auto fan = undoFans_.rbegin(); fan != undoFans_.rend(); ++fan) {
    mesh_.unfan(fan->first, fan->second);
  }
  for (const Local quad : edit.turns) {
    for (int i = 0; i < 3; ++i) mesh_.turn(quad);
  }
  for (const auto& [vertex, from] : undoMoves_) mesh_.move(vertex, from);
}

std::vector<PairGroup::Local> PairGroup::touchedBy(const Edit& edit) const {
  std::vector<Local> touched = edit.turns;
  for (const auto& [vertex, to] : edit.moves) {
    const auto& around = mesh_.around(vertex);
    touched.insert(touched.end(), around.begin(), around.end());
  }
  touched.insert(touched.end(), edit.fans.begin(), edit.fans.end());
  for (std::size_t i = 0; i < 3 * edit.fans.size(); ++i) {
    touched.push_back(static_cast<Local>(mesh_.polygonCount() - 1 - i));
  }
  base::sortUnique(touched);
  return touched;
}

std::vector<PairGroup::Pair> PairGroup::pairsOf(const std::vector<Local>& polygons) const {
  std::vector<Pair> pairs;
  for (const Local polygon : polygons) {
    for (Local other = 0; other < mesh_.polygonCount(); ++other) {
      if (mesh_.meet(polygon, other)) {
        pairs.push_back({std::min(polygon, other), std::max(polygon, other)});
      }
    }
  }
  base::sortUnique(pairs);
  return pairs;
}

void PairGroup::accept(const Edit& edit, const std::vector<Local>& touched,
                       const std::vector<Pair>& pairs) {
  std::erase_if(pairs_, [&](const Pair& p) {
    return std::binary_search(touched.begin(), touched.end(), p[0]) ||
           std::binary_search(touched.begin(), touched.end(), p[1]);
  });
  pairs_.insert(pairs_.end(), pairs.begin(), pairs.end());
  for (const auto& [vertex, to] : edit.moves) moved_.push_back(vertex);
  turned_.insert(turned_.end(), edit.turns.begin(), edit.turns.end());
  for (const Local quad : edit.fans) {
    fans_.emplace_back(quad, fallbacks_.crossings.at(mesh_.polygonOf(quad)));
  }
  touched_.insert(touched_.end(), touched.begin(), touched.end());
}

Changes PairGroup::changes() const {
  Changes changes;
  auto moved = moved_, touched = touched_;
  base::sortUnique(moved);
  for (const Local vertex : moved) {
    changes.moves.emplace_back(mesh_.vertexOf(vertex), mesh_.point(vertex));
  }
  for (const Local quad : turned_) changes.turns.push_back(mesh_.polygonOf(quad));
  for (const auto& [quad, centre] : fans_) changes.fans.emplace_back(mesh_.polygonOf(quad), centre);
  base::sortUnique(touched);
  for (const Local polygon : touched) {
    if (mesh_.isNew(mesh_.corners(polygon)[0])) continue;
    changes.polygons.push_back(mesh_.polygonOf(polygon));
  }
  return changes;
}

}  // namespace tufa::refine
