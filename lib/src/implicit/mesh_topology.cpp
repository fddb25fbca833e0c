#include "implicit/mesh_topology.h"

#include <tufa/error.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <tuple>

#include "base/vertex_welder.h"

namespace tufa::implicit {
namespace {

using Corners = std::array<std::uint32_t, 3>;

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::InvalidArgument, why); }

/// An edge as one of its faces has it.
struct Side {
  std::uint32_t lesser;  ///< vertex
  std::uint32_t greater;
  std::uint32_t triangle;
  std::uint32_t edge;
  bool forward;  ///< from the lesser vertex to the greater
  [[nodiscard]] bool sharesEdgeWith(const Side& other) const {
    return lesser == other.lesser && greater == other.greater;
  }
};

std::vector<Side> sidesOf(const std::vector<Corners>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t n = 0; n < triangles.size(); ++n) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles[n][k];
      const std::uint32_t to = triangles[n][(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), n, k, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.lesser, a.greater, a.triangle, a.edge) <
           std::tie(b.lesser, b.greater, b.triangle, b.edge);
  });
  return sides;
}

/// What is wrong with the edges of a mesh.
struct Faults {
  std::size_t open = 0;
  std::size_t crowded = 0;  ///< of more than two faces
  std::size_t turned = 0;   ///< of two faces that turn both ways
  [[nodiscard]] bool any() const { return open + crowded + turned > 0; }
};

std::vector<Corners> pairSides(const std::vector<Side>& sides, std::size_t triangles,
                               Faults& faults) {
  std::vector<Corners> neighbours(triangles);
  for (std::size_t begin = 0; begin < sides.size();) {
    std::size_t end = begin + 1;
    while (end < sides.size() && sides[end].sharesEdgeWith(sides[begin])) ++end;
    const Side& one = sides[begin];
    if (end - begin == 1) {
      ++faults.open;
    } else if (end - begin > 2) {
      ++faults.crowded;
    } else if (one.forward == sides[begin + 1].forward) {
      ++faults.turned;
    } else {
      const Side& other = sides[begin + 1];
      neighbours[one.triangle][one.edge] = other.triangle;
      neighbours[other.triangle][other.edge] = one.triangle;
    }
    begin = end;
  }
  return neighbours;
}

void requireDistinctCorners(std::vector<Corners>& triangles) {
  const auto isNone = [](const Corners& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; };
  triangles.erase(std::remove_if(triangles.begin(), triangles.end(), isNone), triangles.end());
}

void requireClosed(const Faults& faults) {
  const auto say = [](std::size_t count, const std::string& what) {
    refuse("the mesh has " + std::to_string(count) + (count == 1 ? " edge" : " edges") + what +
           "; tufa repair makes a closed one of it, and with \"thickness\" any will do");
  };
  if (faults.open > 0) say(faults.open, " of one face: it is open");
  if (faults.crowded > 0) say(faults.crowded, " of more than two faces");
  if (faults.turned > 0) say(faults.turned, " whose two faces turn both ways");
}

/// Makes vertices at equal positions one.
void weld(TriangleSet& set) {
  std::vector<Position> positions;
  base::VertexWelder welder(positions);
  for (Corners& triangle : set.triangles) {
    for (std::uint32_t& vertex : triangle) vertex = welder.indexOf(set.positions[vertex]);
  }
  set.positions.assign(positions.begin(), positions.end());
  requireDistinctCorners(set.triangles);
}

void requireOutward(const TriangleSet& set) {
  double volume = 0;
  for (const Corners& t : set.triangles) {
    const Vec3 origin = set.positions[set.triangles[0][0]];
    const Vec3 a = set.positions[t[0]] - origin;
    volume += a.dot((set.positions[t[1]] - origin).cross(set.positions[t[2]] - origin));
  }
  if (volume < 0) refuse("the mesh faces inward: its volume is negative; tufa repair turns it");
}

/// Lengths that are none, as shares of a triangle's longest edge.
constexpr double kVanishing = 1e-12;

double longestEdge(const std::array<Vec3, 3>& p) {
  return std::max({(p[1] - p[0]).length(), (p[2] - p[1]).length(), (p[0] - p[2]).length()});
}

bool hasNoArea(const TriangleSet& set, const Corners& t) {
  const std::array<Vec3, 3> p = set.cornersOf(t);
  const double longest = longestEdge(p);
  return !((p[1] - p[0]).cross(p[2] - p[0]).length() > kVanishing * longest * longest);
}

/// Moves corners to others that they are next to, those of lesser numbers. Whether there were any
/// such corners.
bool joinNearCorners(TriangleSet& set) {
  bool any = false;
  for (bool moved = true; moved;) {
    moved = false;
    for (const Corners& t : set.triangles) {
      const double least = kVanishing * longestEdge(set.cornersOf(t));
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [lesser, greater] = std::minmax(t[k], t[(k + 1) % 3]);
        if ((set.positions[greater] - set.positions[lesser]).length() > least) continue;
        any = true;
        moved = moved || set.positions[greater] != set.positions[lesser];
        set.positions[greater] = set.positions[lesser];
      }
    }
  }
  return any;
}

void requireArea(const TriangleSet& set) {
  const auto without = std::count_if(set.triangles.begin(), set.triangles.end(),
                                     [&](const Corners& t) { return hasNoArea(set, t); });
  if (without == 0 && !set.triangles.empty()) return;
  refuse(
      "the mesh has faces that enclose a line or a point; tufa repair drops them, and with "
      "\"thickness\" any will do");
}

/// Gives triangles whose corners lie on a line an area. The middle corner lies on the longest edge:
/// that is turned to end there, and the triangle beyond is cut in two. The surface stays as it is.
class FlatTriangles {
 public:
  FlatTriangles(TriangleSet& set, std::vector<Corners>& neighbours)
      : set_(set), neighbours_(neighbours) {
    for (std::uint32_t n = 0; n < set.triangles.size(); ++n) keepIfFlat(n);
  }

  /// Each turn makes fewer triangles flat, or edges shorter.
  void turnEdges() {
    while (!flat_.empty()) {
      const std::uint32_t n = flat_.back();
      flat_.pop_back();
      if (isFlat(set_.triangles[n])) turnLongestEdge(n);
    }
  }

 private:
  [[nodiscard]] bool isFlat(const Corners& t) const { return hasNoArea(set_, t); }
  void keepIfFlat(std::uint32_t n) {
    if (isFlat(set_.triangles[n])) flat_.push_back(n);
  }
  [[nodiscard]] double lengthOf(std::uint32_t from, std::uint32_t to) const {
    return (set_.positions[to] - set_.positions[from]).length();
  }
  /// The edge of a triangle that begins at a vertex.
  [[nodiscard]] std::size_t edgeFrom(std::uint32_t n, std::uint32_t vertex) const {
    const Corners& t = set_.triangles[n];
    return std::find(t.begin(), t.end(), vertex) - t.begin();
  }

  void turnLongestEdge(std::uint32_t n) {
    const Corners t = set_.triangles[n];
    std::size_t k = 0;
    for (std::size_t edge = 1; edge < 3; ++edge) {
      if (lengthOf(t[edge], t[(edge + 1) % 3]) > lengthOf(t[k], t[(k + 1) % 3])) k = edge;
    }
    const std::uint32_t a = t[k], b = t[(k + 1) % 3], top = t[(k + 2) % 3];
    const std::uint32_t m = neighbours_[n][k];
    const std::size_t e = edgeFrom(m, b);
    const std::uint32_t bottom = set_.triangles[m][(e + 2) % 3];
    if (top == bottom) return;
    const Corners left{a, bottom, top}, right{bottom, b, top};
    const int before = 1 + (isFlat(set_.triangles[m]) ? 1 : 0);
    const int after = (isFlat(left) ? 1 : 0) + (isFlat(right) ? 1 : 0);
    if (after > before || (after == before && !(lengthOf(top, bottom) < lengthOf(a, b)))) return;
    const std::uint32_t topLeft = neighbours_[n][(k + 2) % 3];
    const std::uint32_t topRight = neighbours_[n][(k + 1) % 3];
    const std::uint32_t bottomLeft = neighbours_[m][(e + 1) % 3];
    const std::uint32_t bottomRight = neighbours_[m][(e + 2) % 3];
    neighbours_[topRight][edgeFrom(topRight, top)] = m;
    neighbours_[bottomLeft][edgeFrom(bottomLeft, bottom)] = n;
    set_.triangles[n] = left;
    set_.triangles[m] = right;
    neighbours_[n] = {bottomLeft, m, topLeft};
    neighbours_[m] = {bottomRight, topRight, n};
    for (const std::uint32_t near : {n, m, topLeft, topRight, bottomLeft, bottomRight}) {
      keepIfFlat(near);
    }
  }

  TriangleSet& set_;
  std::vector<Corners>& neighbours_;
  std::vector<std::uint32_t> flat_;
};

}  // namespace

TriangleSet trianglesOf(const Mesh& mesh) {
  TriangleSet set;
  for (const Triangle& triangle : triangulate(mesh)) {
    for (const VertexIndex vertex : triangle.vertices) {
      if (vertex >= mesh.positions.size()) {
        refuse("the mesh has " + std::to_string(mesh.positions.size()) +
               " vertices, but a face names vertex " + std::to_string(vertex));
      }
      if (!Vec3(mesh.positions[vertex]).isFinite()) {
        refuse("vertex " + std::to_string(vertex) + " of the mesh is not finite");
      }
    }
    set.triangles.push_back(triangle.vertices);
  }
  set.positions.assign(mesh.positions.begin(), mesh.positions.end());
  requireDistinctCorners(set.triangles);
  if (set.triangles.empty()) refuse("the mesh has no faces");
  return set;
}

std::vector<Corners> neighboursIn(TriangleSet& set) {
  Faults faults;
  std::vector<Corners> neighbours = pairSides(sidesOf(set.triangles), set.triangles.size(), faults);
  bool apart = joinNearCorners(set) || faults.any();
  do {
    if (apart) {
      weld(set);
      faults = {};
      neighbours = pairSides(sidesOf(set.triangles), set.triangles.size(), faults);
    }
    requireClosed(faults);
    FlatTriangles(set, neighbours).turnEdges();
    // Corners of two faces may have come to lie beside each other.
    apart = joinNearCorners(set);
  } while (apart);
  requireArea(set);
  requireOutward(set);
  return neighbours;
}

}  // namespace tufa::implicit
