#include "refine/lone_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "base/box.h"
#include "base/sort_unique.h"

namespace tufa::refine {
namespace {

constexpr std::uint8_t kThree = 3;
constexpr std::size_t kCorners = 8;
constexpr std::size_t kSides = std::tuple_size_v<LoneComponent>;
// Voxels between a lifted component and the sheet that it was lifted over.
constexpr double kLifted = 0.1;
// What lies deeper below the sheets of a crease, in voxels, was not made by it.
constexpr double kDeepest = 0.75;
// A component with a smaller diagonal, in voxels, as where a sample lies on the surface, has no
// area that single precision could tell. It becomes a box of this diagonal.
constexpr double kLeastDiagonal = 0.05;
// A lifted component has at most this share of the size of the box around its sample.
constexpr double kShare = 0.5;

// The quads of which all vertices have three quads, as the six around a single sample do.
std::vector<std::uint32_t> findCandidates(const Mesh& mesh, base::Job& job) {
  std::vector<std::uint8_t> quadsAt(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
    job.pollCancelled(i);
    for (const VertexIndex vertex : mesh.quads[i].vertices) {
      quadsAt[vertex] = static_cast<std::uint8_t>(std::min<int>(quadsAt[vertex] + 1, kThree + 1));
    }
  }
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t i = 0; i < mesh.quads.size(); ++i) {
    job.pollCancelled(i);
    const auto& v = mesh.quads[i].vertices;
    if (std::all_of(v.begin(), v.end(), [&](VertexIndex at) { return quadsAt[at] == kThree; })) {
      candidates.push_back(i);
    }
  }
  return candidates;
}

// Six times the volume of quads whose corners are at `at(vertex)`.
template <class At>
double volumeOf(const Mesh& mesh, const LoneComponent& component, const At& at) {
  const Vec3 origin = at(mesh.quads[component[0]].vertices[0]);
  double volume = 0;
  for (const std::uint32_t quad : component) {
    const auto& v = mesh.quads[quad].vertices;
    const Vec3 p = at(v[0]) - origin, q = at(v[2]) - origin;
    volume += p.dot((at(v[1]) - origin).cross(q)) + p.dot(q.cross(at(v[3]) - origin));
  }
  return volume;
}

// Rising.
std::vector<VertexIndex> verticesOf(const Mesh& mesh, const LoneComponent& component) {
  std::vector<VertexIndex> vertices;
  for (const std::uint32_t quad : component) {
    const auto& v = mesh.quads[quad].vertices;
    vertices.insert(vertices.end(), v.begin(), v.end());
  }
  base::sortUnique(vertices);
  return vertices;
}

// Of the box around vertices whose places are `at(vertex)`.
template <class At>
double diagonalOf(const std::vector<VertexIndex>& vertices, const At& at) {
  base::Box box = base::Box::empty();
  for (const VertexIndex v : vertices) box.add(at(v));
  return box.size().length();
}

// The mass points of all components' vertices.
class MassPoints {
 public:
  MassPoints(const Mesh& mesh, const std::vector<LoneComponent>& components, const Source& source) {
    for (const LoneComponent& component : components) {
      const std::vector<VertexIndex> own = verticesOf(mesh, component);
      vertices_.insert(vertices_.end(), own.begin(), own.end());
    }
    std::sort(vertices_.begin(), vertices_.end());
    if (!vertices_.empty()) points_ = source.massPoints(vertices_);
  }
  [[nodiscard]] Position operator()(VertexIndex vertex) const {
    const auto found = std::lower_bound(vertices_.begin(), vertices_.end(), vertex);
    return points_[static_cast<std::size_t>(found - vertices_.begin())];
  }

 private:
  std::vector<VertexIndex> vertices_;
  std::vector<Position> points_;
};

Vec3 middleOf(const std::vector<Vec3>& points) {
  Vec3 middle(0);
  for (const Vec3& point : points) middle += point * (1.0 / static_cast<double>(points.size()));
  return middle;
}

// The box of the mass points of a component's vertices, scaled, but no smaller than it may be.
std::vector<Vec3> boxOf(const std::vector<VertexIndex>& vertices, const MassPoints& massPoint,
                        double scale, double leastDiagonal) {
  std::vector<Vec3> box;
  for (const VertexIndex v : vertices) box.emplace_back(massPoint(v));
  const Vec3 middle = middleOf(box);
  const double diagonal = diagonalOf(vertices, [&](VertexIndex v) { return Vec3(massPoint(v)); });
  if (diagonal > 0) scale = std::max(scale, leastDiagonal / diagonal);
  for (Vec3& corner : box) corner = middle + (corner - middle) * scale;
  return box;
}

// The vertices on creases, to be found by their places.
class CreaseVertices {
 public:
  CreaseVertices(const Mesh& mesh, const uniform::VertexSheets& sheets, double voxelSize)
      : mesh_(mesh), cell_(kDeepest * voxelSize) {
    for (VertexIndex v = 0; v < mesh.positions.size(); ++v) {
      if (sheets.kind(v) == uniform::VertexSheets::Kind::Meeting) {
        vertices_.push_back({cellOf(mesh.positions[v]), v});
      }
    }
    std::sort(vertices_.begin(), vertices_.end());
  }
  // Those within kDeepest, the nearest one first.
  [[nodiscard]] std::vector<VertexIndex> nearTo(const Vec3& point) const {
    std::vector<VertexIndex> found;
    double nearest = cell_ * cell_;
    const Cell middle = cellOf(point);
    for (int i = 0; i < 27; ++i) {
      const Cell cell{middle[0] + i / 9 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i % 3 - 1};
      auto at =
          std::lower_bound(vertices_.begin(), vertices_.end(), std::pair(cell, VertexIndex{0}));
      for (; at != vertices_.end() && at->first == cell; ++at) {
        const double away = (Vec3(mesh_.positions[at->second]) - point).squaredLength();
        if (away >= cell_ * cell_) continue;
        found.push_back(at->second);
        if (away < nearest) nearest = away, std::swap(found.front(), found.back());
      }
    }
    return found;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] Cell cellOf(const Vec3& point) const {
    Cell cell;
    for (std::size_t i = 0; i < 3; ++i) {
      cell[i] = static_cast<std::int64_t>(std::floor(point[i] / cell_));
    }
    return cell;
  }
  const Mesh& mesh_;
  double cell_;
  std::vector<std::pair<Cell, VertexIndex>> vertices_;
};

// The shortest way along the normal of one of the sheets that meet at a crease's first vertex on
// which a box passes that sheet at all of its vertices, as some may be behind it. `side` is 1 for
// solid and -1 for a bubble, which is on the sheets' other side. 0 if the box is past one already,
// or too far behind all.
Vec3 wayOut(const Mesh& mesh, const uniform::VertexSheets& sheets,
            const std::vector<VertexIndex>& crease, double side, const std::vector<Vec3>& box,
            double voxelSize) {
  const uniform::MeetingSheets meeting = sheets.sheets(mesh, crease.front());
  Vec3 way(0);
  double least = 2 * kDeepest * voxelSize;
  for (int i = 0; i < meeting.count; ++i) {
    const Vec3 normal = Vec3(meeting.normals[i]) * side;
    double lowest = std::numeric_limits<double>::max(), highest = -lowest;
    for (const Vec3& corner : box) lowest = std::min(lowest, normal.dot(corner));
    for (const VertexIndex v : crease)
      highest = std::max(highest, normal.dot(Vec3(mesh.positions[v])));
    const double length = highest + kLifted * voxelSize - lowest;
    if (length <= 0) return Vec3(0);
    if (length < least) least = length, way = normal * length;
  }
  return way;
}

}  // namespace

// Connected components of six such quads.
std::vector<LoneComponent> findLoneComponents(const Mesh& mesh, base::Job& job) {
  const std::vector<std::uint32_t> candidates = findCandidates(mesh, job);
  std::unordered_map<VertexIndex, std::vector<std::uint32_t>> around;
  for (const std::uint32_t quad : candidates) {
    for (const VertexIndex vertex : mesh.quads[quad].vertices) around[vertex].push_back(quad);
  }
  std::vector<LoneComponent> components;
  std::vector<std::uint32_t> component;
  for (const std::uint32_t first : candidates) {
    component = {first};
    for (std::size_t i = 0; i < component.size() && component.size() <= kSides; ++i) {
      for (const VertexIndex vertex : mesh.quads[component[i]].vertices) {
        for (const std::uint32_t next : around[vertex]) {
          if (std::find(component.begin(), component.end(), next) == component.end())
            component.push_back(next);
        }
      }
    }
    if (component.size() != kSides ||
        *std::min_element(component.begin(), component.end()) != first)
      continue;
    std::sort(component.begin(), component.end());
    std::copy(component.begin(), component.end(), components.emplace_back().begin());
  }
  return components;
}

std::size_t unfoldLoneComponents(Mesh& mesh, const std::vector<LoneComponent>& components,
                                 const Source& source) {
  const MassPoints massPoint(mesh, components, source);
  const double leastDiagonal = kLeastDiagonal * source.voxelSize;
  std::size_t moved = 0;
  for (const LoneComponent& component : components) {
    const std::vector<VertexIndex> vertices = verticesOf(mesh, component);
    const auto at = [&](VertexIndex v) { return Vec3(mesh.positions[v]); };
    const double is = volumeOf(mesh, component, at);
    const double box = volumeOf(mesh, component, [&](VertexIndex v) { return Vec3(massPoint(v)); });
    if (is * box > 0 && diagonalOf(vertices, at) >= leastDiagonal) continue;
    const std::vector<Vec3> corners = boxOf(vertices, massPoint, 1, leastDiagonal);
    for (std::size_t i = 0; i < kCorners; ++i) mesh.positions[vertices[i]] = corners[i];
    moved += kCorners;
  }
  return moved;
}

std::size_t liftLoneComponents(Mesh& mesh, uniform::VertexSheets& sheets,
                               const std::vector<LoneComponent>& components, const Source& source) {
  if (components.empty() || sheets.sharpCount() == 0) return 0;
  const CreaseVertices creases(mesh, sheets, source.voxelSize);
  const MassPoints massPoint(mesh, components, source);
  std::vector<std::pair<VertexIndex, Position>> moves;
  for (const LoneComponent& component : components) {
    const std::vector<VertexIndex> vertices = verticesOf(mesh, component);
    const std::vector<Vec3> box =
        boxOf(vertices, massPoint, kShare, kLeastDiagonal * source.voxelSize);
    const std::vector<VertexIndex> crease = creases.nearTo(middleOf(box));
    if (crease.empty()) continue;
    const double volume =
        volumeOf(mesh, component, [&](VertexIndex v) { return Vec3(massPoint(v)); });
    const Vec3 way = wayOut(mesh, sheets, crease, volume < 0 ? -1.0 : 1.0, box, source.voxelSize);
    if (way == Vec3(0)) continue;
    for (std::size_t i = 0; i < kCorners; ++i) moves.push_back({vertices[i], box[i] + way});
  }
  for (const auto& [vertex, place] : moves) {
    mesh.positions[vertex] = place;
    sheets.moveOffCrease(vertex);
  }
  return moves.size();
}

}  // namespace tufa::refine
