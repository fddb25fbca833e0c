#include "octree/patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "unit/uniform/cell_oracle.h"

namespace tufa::octree {
namespace {

using uniform::kCorners;
using uniform::kEdges;
using uniform::kFaces;

constexpr double kDegree = std::numbers::pi / 180;

NormalCone coneOf(double degrees) {
  return {Vec3(std::cos(degrees * kDegree), std::sin(degrees * kDegree), 0), 0};
}

TEST(NormalCone, HoldsAllNormalsItWasMadeOf) {
  std::mt19937 random(1);
  std::normal_distribution<double> number;
  for (int i = 0; i < 100; ++i) {
    const Vec3 about(number(random), number(random), number(random));
    std::vector<Vec3> normals;
    NormalCone cone;
    for (int k = 0; k < 6; ++k) {
      const Vec3 own(number(random), number(random), number(random));
      normals.push_back((about + own * 0.4).unitOrX());
      cone.add({normals.back(), 0});
    }
    for (const Vec3& normal : normals) {
      const double cosine = std::clamp(normal.dot(cone.axis.unitOrX()), -1.0, 1.0);
      EXPECT_LE(std::acos(cosine), cone.angle + 1e-9);
    }
  }
}

TEST(NormalCone, OfTwoNormalsIsHalfTheAngleBetweenThem) {
  NormalCone cone = coneOf(10);
  cone.add(coneOf(50));
  EXPECT_NEAR(cone.angle, 20 * kDegree, 1e-12);
  EXPECT_LT((cone.axis.unitOrX() - coneOf(30).axis).length(), 1e-12);
}

TEST(NormalCone, OfEqualNormalsIsNarrow) {
  NormalCone cone = coneOf(10);
  cone.add(coneOf(10));
  EXPECT_NEAR(cone.angle, 0, 1e-7);
}

TEST(NormalCone, StartsAsWhatIsAddedFirst) {
  NormalCone cone;
  cone.add({Vec3(0, 3, 0), 0.2});
  EXPECT_EQ(cone.axis[1], 3);
  EXPECT_EQ(cone.angle, 0.2);
}

TEST(NormalCone, OfOppositeNormalsIsEveryDirection) {
  NormalCone cone{Vec3(0, 1, 0), 0};
  cone.add({Vec3(0, -1, 0), 0});
  EXPECT_NEAR(cone.angle, std::numbers::pi, 1e-12);
  cone.add({Vec3(1, 0, 0), 0});
  EXPECT_NEAR(cone.angle, std::numbers::pi, 1e-12);
}

// The samples of two by two by two cells: which of the 27 lattice points are inside.
using Samples = unsigned;

bool isInside(Samples samples, int x, int y, int z) {
  return ((samples >> (x * 9 + y * 3 + z)) & 1) != 0;
}

std::array<int, 3> placeOf(int corner) { return {corner >> 2, (corner >> 1) & 1, corner & 1}; }

uniform::CornerMask maskOf(Samples samples, int child) {
  unsigned mask = 0;
  const auto [x, y, z] = placeOf(child);
  for (int corner = 0; corner < kCorners; ++corner) {
    const auto [dx, dy, dz] = placeOf(corner);
    if (isInside(samples, x + dx, y + dy, z + dz)) mask |= 1U << corner;
  }
  return static_cast<uniform::CornerMask>(mask);
}

// The lattice edge that an edge of a child lies on: its lower end and its axis.
using LatticeEdge = std::array<int, 4>;

LatticeEdge latticeEdge(int child, int edge) {
  const auto place = placeOf(child), lower = placeOf(uniform::edgeCorners(edge)[0]);
  return {place[0] + lower[0], place[1] + lower[1], place[2] + lower[2], edge / 4};
}

// The patches of the children, as the uniform mesh has them with all inside corners kept apart.
struct Children {
  std::array<std::vector<Patch>, kCorners> patches;

  explicit Children(Samples samples) {
    for (int child = 0; child < kCorners; ++child) {
      const uniform::CornerMask mask = maskOf(samples, child);
      const uniform::Components components = uniform::componentsOf(mask, 0);
      patches[child].resize(static_cast<std::size_t>(components.count()));
      for (int edge = 0; edge < kEdges; ++edge) {
        if (!uniform::isCrossed(mask, edge)) continue;
        patches[child][components.of(edge)].crossings[edge] = latticeEdge(child, edge)[edge / 4];
      }
    }
  }
  [[nodiscard]] PatchJoiner::Children spans() const {
    PatchJoiner::Children spans;
    for (int child = 0; child < kCorners; ++child) spans[child] = patches[child];
    return spans;
  }
};

// What the eight cells are by their plain definition: a polygon for each loop of crossings, glued
// along the arcs on common faces.
struct Glued {
  std::vector<std::set<LatticeEdge>> surfaces;  ///< crossings of each connected surface
  bool mayBeLeaf = true;
};

// Of a connected surface with these polygons: a disk that meets the big cell's edges and faces
// once.
bool isSimple(Samples samples, const std::vector<std::pair<int, std::set<int>>>& polygons,
              const std::set<LatticeEdge>& crossings) {
  // An arc is one of a cell's face: its axis, where it lies along it, and the cell's place in it.
  std::set<std::tuple<LatticeEdge, LatticeEdge, int, int, int, int>> arcs;
  for (const auto& [child, edges] : polygons) {
    const auto place = placeOf(child);
    for (int face = 0; face < kFaces; ++face) {
      const auto [u, v] = uniform::otherAxes(face / 2);
      for (const auto& [a, b] : uniform::cells::arcsOf(maskOf(samples, child), face, false)) {
        if (edges.count(a) == 0) continue;
        const LatticeEdge s = latticeEdge(child, a), t = latticeEdge(child, b);
        arcs.emplace(std::min(s, t), std::max(s, t), face / 2, place[face / 2] + (face & 1),
                     place[u], place[v]);
      }
    }
  }
  const auto euler = static_cast<int>(crossings.size()) - static_cast<int>(arcs.size()) +
                     static_cast<int>(polygons.size());
  if (euler != 1) return false;
  // On the twelve edges of the big cell: those with both other coordinates at an end.
  std::map<std::array<int, 3>, int> onEdges;
  std::array<int, kFaces> aroundFaces{};
  int total = 0;
  for (const LatticeEdge& crossing : crossings) {
    const int axis = crossing[3];
    const auto [u, v] = uniform::otherAxes(axis);
    if (crossing[u] == 1 || crossing[v] == 1) continue;
    if (++onEdges[{axis, crossing[u], crossing[v]}] > 1) return false;
    ++total;
    ++aroundFaces[u * 2 + crossing[u] / 2];
    ++aroundFaces[v * 2 + crossing[v] / 2];
  }
  return total >= 3 && std::all_of(aroundFaces.begin(), aroundFaces.end(),
                                   [](int n) { return n % 2 == 0 && n <= 2; });
}

Glued glue(Samples samples) {
  // Polygons by child and the edges they own; surfaces grow where polygons share a crossing.
  std::vector<std::pair<int, std::set<int>>> polygons;
  std::vector<std::set<LatticeEdge>> crossingsOf;
  for (int child = 0; child < kCorners; ++child) {
    for (const std::set<int>& part : uniform::cells::partitionOf(maskOf(samples, child), 0, 0)) {
      polygons.emplace_back(child, part);
      crossingsOf.emplace_back();
      for (const int edge : part) crossingsOf.back().insert(latticeEdge(child, edge));
    }
  }
  const auto share = [&](std::size_t a, std::size_t b) {
    // In a face common to both children.
    const int apart = polygons[a].first ^ polygons[b].first;
    if (apart != 1 && apart != 2 && apart != 4) return false;
    return std::any_of(crossingsOf[a].begin(), crossingsOf[a].end(),
                       [&](const LatticeEdge& edge) { return crossingsOf[b].count(edge) != 0; });
  };
  std::vector<std::size_t> label(polygons.size());
  for (std::size_t i = 0; i < label.size(); ++i) label[i] = i;
  for (bool any = true; any;) {
    any = false;
    for (std::size_t a = 0; a < label.size(); ++a) {
      for (std::size_t b = 0; b < label.size(); ++b) {
        if (label[b] <= label[a] || !share(a, b)) continue;
        label[b] = label[a];
        any = true;
      }
    }
  }
  Glued glued;
  for (std::size_t top = 0; top < label.size(); ++top) {
    if (label[top] != top) continue;
    std::vector<std::pair<int, std::set<int>>> own;
    std::set<LatticeEdge> crossings;
    for (std::size_t i = 0; i < label.size(); ++i) {
      if (label[i] != top) continue;
      own.push_back(polygons[i]);
      crossings.insert(crossingsOf[i].begin(), crossingsOf[i].end());
    }
    glued.mayBeLeaf &= isSimple(samples, own, crossings);
    glued.surfaces.push_back(crossings);
  }
  return glued;
}

// The big cell's crossings of a connected surface, as a Patch has them.
std::array<std::int32_t, kEdges> onBigCell(const std::set<LatticeEdge>& crossings) {
  std::array<std::int32_t, kEdges> found;
  found.fill(Patch::kNoCrossing);
  for (const LatticeEdge& crossing : crossings) {
    const auto [u, v] = uniform::otherAxes(crossing[3]);
    if (crossing[u] == 1 || crossing[v] == 1) continue;
    found[crossing[3] * 4 + crossing[u] + crossing[v] / 2] = crossing[crossing[3]];
  }
  return found;
}

// A plane, or two or three, or noise: patterns that often, or rarely, may be leaves.
Samples randomSamples(std::mt19937& random) {
  std::normal_distribution<double> number;
  std::uniform_real_distribution<double> offset(-1.2, 1.2);
  const auto kind = random() % 4;
  if (kind == 3) return static_cast<Samples>(random() & random() & 0x7ffffff);
  Samples samples = 0;
  for (std::uint32_t plane = 0; plane <= kind; ++plane) {
    const Vec3 normal = Vec3(number(random), number(random), number(random)).unitOrX();
    const double at = offset(random);
    for (int i = 0; i < 27; ++i) {
      const Vec3 p(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
      if (normal.dot(p) < at) samples ^= 1U << i;
    }
  }
  return samples;
}

TEST(PatchJoiner, AllowsLeavesWhereTheSurfacesOfTheCellAreDisksThatMeetEachNeighbourOnce) {
  std::mt19937 random(7);
  PatchJoiner joiner;
  int leaves = 0, others = 0, several = 0;
  for (int i = 0; i < 20000; ++i) {
    const Samples samples = randomSamples(random);
    const Children children(samples);
    const Glued glued = glue(samples);
    if (glued.surfaces.empty()) continue;
    ASSERT_EQ(joiner.join(children.spans()), glued.mayBeLeaf) << std::hex << samples;
    (glued.mayBeLeaf ? leaves : others)++;
    if (!glued.mayBeLeaf) continue;
    ASSERT_EQ(joiner.patches().size(), glued.surfaces.size()) << std::hex << samples;
    several += glued.surfaces.size() > 1 ? 1 : 0;
    std::set<std::array<std::int32_t, kEdges>> found, expected;
    for (const Patch& patch : joiner.patches()) found.insert(patch.crossings);
    for (const auto& surface : glued.surfaces) expected.insert(onBigCell(surface));
    ASSERT_EQ(found, expected) << std::hex << samples;
  }
  EXPECT_GT(leaves, 3000);
  EXPECT_GT(others, 3000);
  EXPECT_GT(several, 300);
}

TEST(PatchJoiner, NamesThePatchOfEachChildsPatch) {
  std::mt19937 random(8);
  PatchJoiner joiner;
  int compared = 0;
  for (int i = 0; i < 4000; ++i) {
    const Samples samples = randomSamples(random);
    const Children children(samples);
    if (!joiner.join(children.spans()) || joiner.patches().empty()) continue;
    const Glued glued = glue(samples);
    std::size_t next = 0;
    for (int child = 0; child < kCorners; ++child) {
      for (const Patch& patch : children.patches[child]) {
        // Any of its crossings tells the surface that it belongs to.
        const std::uint32_t parent = joiner.parents()[next++];
        ASSERT_LT(parent, joiner.patches().size());
        const auto edge = static_cast<int>(
            std::find_if(patch.crossings.begin(), patch.crossings.end(),
                         [](std::int32_t at) { return at != Patch::kNoCrossing; }) -
            patch.crossings.begin());
        std::set<std::array<std::int32_t, kEdges>> possible;
        for (const auto& surface : glued.surfaces) {
          if (surface.count(latticeEdge(child, edge)) != 0) possible.insert(onBigCell(surface));
        }
        ASSERT_EQ(possible.count(joiner.patches()[parent].crossings), 1U) << std::hex << samples;
        ++compared;
      }
    }
    ASSERT_EQ(next, joiner.parents().size());
  }
  EXPECT_GT(compared, 3000);
}

// A plane across the middle of the cell: z < 1 is inside.
TEST(PatchJoiner, JoinsAPlaneToOnePatchOfFourCrossings) {
  Samples samples = 0;
  for (int i = 0; i < 27; ++i) samples |= i % 3 < 1 ? 1U << i : 0U;
  const Children children(samples);
  PatchJoiner joiner;
  ASSERT_TRUE(joiner.join(children.spans()));
  ASSERT_EQ(joiner.patches().size(), 1U);
  EXPECT_EQ(joiner.parents(), (std::vector<std::uint32_t>{0, 0, 0, 0}));
  for (int edge = 0; edge < kEdges; ++edge) {
    EXPECT_EQ(joiner.patches()[0].crossings[edge], edge / 4 == 2 ? 0 : Patch::kNoCrossing);
  }
}

// Two sheets that the same edges of the cell pass.
TEST(PatchJoiner, KeepsTheSheetsOfAThinWallApart) {
  Samples samples = 0;
  for (int i = 0; i < 27; ++i) samples |= i % 3 == 1 ? 1U << i : 0U;
  const Children children(samples);
  PatchJoiner joiner;
  ASSERT_TRUE(joiner.join(children.spans()));
  ASSERT_EQ(joiner.patches().size(), 2U);
  for (int edge = 8; edge < kEdges; ++edge) {
    EXPECT_EQ(joiner.patches()[0].crossings[edge], 0);
    EXPECT_EQ(joiner.patches()[1].crossings[edge], 1);
  }
}

TEST(PatchJoiner, RefusesABubbleInsideTheCell) {
  PatchJoiner joiner;
  const Children children(1U << 13);
  EXPECT_FALSE(joiner.join(children.spans()));
}

}  // namespace
}  // namespace tufa::octree
