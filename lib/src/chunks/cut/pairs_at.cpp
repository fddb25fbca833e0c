#include "chunks/cut/pairs_at.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "base/collect.h"
#include "base/huge_pages.h"
#include "base/ranked_bits.h"

namespace tufa::chunks {
namespace {

// Of more than one triangle in so many, others are mostly near.
constexpr std::size_t kMany = 8;
// Places in the table of cubes for each of some triangles. Many of these share a cube of some fifty
// triangles, so that one place in four is marked at most, and a triangle seldom by mistake.
constexpr std::size_t kPlaces = 8;

// std::floor() is a call where the processor is not known to have an instruction for it.
std::int64_t floorOf(double x) {
  const auto towardsZero = static_cast<std::int64_t>(x);
  return towardsZero - (static_cast<double>(towardsZero) > x ? 1 : 0);
}

// Calls visit(place in a table of that size, a power of two) for the cubes of the lattice that a
// triangle's box is in, by a hash, until it returns true. Whether it did; true for boxes that are
// in more cubes than are worth a visit.
template <class Visit>
bool visitCubes(const Triangle& triangle, const std::vector<Vec3>& at, std::size_t size,
                const Visit& visit) {
  constexpr double kCube = 4, kMargin = 0.05;  // steps of the lattice; more than rounding moves
  constexpr double kMostCubes = 4096;
  const auto& v = triangle.vertices;
  std::int64_t low[3], high[3];
  double cubes = 1;
  for (int i = 0; i < 3; ++i) {
    const auto [least, most] = std::minmax({at[v[0]][i], at[v[1]][i], at[v[2]][i]});
    low[i] = floorOf((least - kMargin) / kCube);
    high[i] = floorOf((most + kMargin) / kCube);
    cubes *= static_cast<double>(high[i] - low[i] + 1);
  }
  if (!(cubes <= kMostCubes)) return true;
  for (std::int64_t x = low[0]; x <= high[0]; ++x) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        std::uint64_t hash = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15U ^
                             static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FU ^
                             static_cast<std::uint64_t>(z) * 0x165667B19E3779F9U;
        hash ^= hash >> 32;
        if (visit(hash & (size - 1))) return true;
      }
    }
  }
  return false;
}

// The triangles that have a cube in common with some, these included, and others whose cubes have
// the same hash. Rising.
std::vector<std::uint32_t> trianglesNear(const std::vector<Triangle>& triangles,
                                         const std::vector<Vec3>& at,
                                         const std::vector<std::uint32_t>& some, base::Job& job) {
  const std::size_t size = std::bit_ceil(kPlaces * some.size());
  std::vector<std::uint8_t> isMarked(size, 0);
  bool isLarge = false;  // one of them: all triangles may be near
  for (const std::uint32_t t : some) {
    isLarge |=
        visitCubes(triangles[t], at, size, [&](std::size_t i) { return isMarked[i] = 1, false; });
  }
  return base::collectIf(job, triangles.size(), [&](std::uint32_t t) {
    return isLarge ||
           visitCubes(triangles[t], at, size, [&](std::size_t i) { return isMarked[i] != 0; });
  });
}

// Some triangles, with the vertices that they use.
Mesh meshOf(const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& some,
            std::size_t vertices, const PlaceOfVertex& placeOf) {
  Mesh mesh;
  base::reserveLarge(mesh.triangles, some.size());
  base::RankedBits used(vertices);
  for (const std::uint32_t t : some) {
    mesh.triangles.push_back(triangles[t]);
    for (const VertexIndex v : triangles[t].vertices) used.add(v);
  }
  used.count();
  base::reserveLarge(mesh.positions, used.size());
  used.forAll(
      [&](std::size_t v) { mesh.positions.emplace_back(placeOf(static_cast<VertexIndex>(v))); });
  for (Triangle& t : mesh.triangles) {
    for (VertexIndex& v : t.vertices) v = used.rank(v);
  }
  return mesh;
}

}  // namespace

std::vector<intersect::PolygonPair> findPairsAt(const std::vector<Triangle>& triangles,
                                                const std::vector<Vec3>& at,
                                                const PlaceOfVertex& placeOf,
                                                const std::vector<std::uint8_t>& marks,
                                                base::Job& job) {
  const std::vector<std::uint32_t> touched =
      base::collectIf(job, triangles.size(), [&](std::uint32_t t) {
        const auto& v = triangles[t].vertices;
        return (marks[v[0]] | marks[v[1]] | marks[v[2]]) != 0;
      });
  if (touched.empty()) return {};
  std::vector<std::uint32_t> near;
  if (kMany * touched.size() < triangles.size()) {
    near = trianglesNear(triangles, at, touched, job);
  } else {
    base::resizeLarge(near, triangles.size(), job);
    std::iota(near.begin(), near.end(), 0);
  }
  Mesh mesh = meshOf(triangles, near, at.size(), placeOf);
  std::vector<intersect::PolygonIndex> candidates;
  base::reserveLarge(candidates, touched.size());
  for (std::size_t i = 0, next = 0; i < near.size(); ++i) {
    if (next == touched.size() || touched[next] != near[i]) continue;
    candidates.push_back(static_cast<std::uint32_t>(i));
    ++next;
  }
  std::vector<intersect::PolygonPair> pairs =
      intersect::findPairs(intersect::Surface(mesh, job), candidates, job);
  for (intersect::PolygonPair& pair : pairs) pair.a = near[pair.a], pair.b = near[pair.b];
  return pairs;
}

}  // namespace tufa::chunks
