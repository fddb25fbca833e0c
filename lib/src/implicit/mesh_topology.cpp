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
  if (faults.any()) {
    weld(set);
    faults = {};
    neighbours = pairSides(sidesOf(set.triangles), set.triangles.size(), faults);
  }
  const auto say = [](std::size_t count, const std::string& what) {
    refuse("the mesh has " + std::to_string(count) + (count == 1 ? " edge" : " edges") + what +
           "; tufa repair makes a closed one of it, and with \"thickness\" any will do");
  };
  if (faults.open > 0) say(faults.open, " of one face: it is open");
  if (faults.crowded > 0) say(faults.crowded, " of more than two faces");
  if (faults.turned > 0) say(faults.turned, " whose two faces turn both ways");
  requireOutward(set);
  return neighbours;
}

}  // namespace tufa::implicit
