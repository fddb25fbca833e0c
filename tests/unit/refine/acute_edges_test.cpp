// What is done along acute edges before placements are accepted.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <tufa/contour.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "grid/volume.h"
#include "refine/lone_samples.h"
#include "refine/order_along_creases.h"
#include "refine/uniform_repair.h"
#include "refine/withdraw_placements.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {
namespace {

// The edge of a wedge: two planes through a point, about the direction in which it points.
struct Wedge {
  Wedge(double degrees, const Vec3& tip, const Vec3& pointing, const Vec3& along) : point(tip) {
    const Vec3 crease = along.unitOrX();
    const Vec3 ahead = (pointing - crease * pointing.dot(crease)).unitOrX();
    const Vec3 aside = crease.cross(ahead);
    const double half = degrees / 2 * 3.14159265358979 / 180;
    normals = {ahead * std::sin(half) + aside * std::cos(half),
               ahead * std::sin(half) - aside * std::cos(half)};
  }
  // Voxels; negative inside.
  [[nodiscard]] double distance(const Vec3& p) const {
    return std::max(normals[0].dot(p - point), normals[1].dot(p - point));
  }
  [[nodiscard]] double offCrease(const Vec3& p) const {
    return std::max(std::abs(normals[0].dot(p - point)), std::abs(normals[1].dot(p - point)));
  }
  Vec3 point;
  std::array<Vec3, 2> normals;
};

openvdb::FloatGrid::Ptr makeGrid(const Wedge& wedge, int size) {
  const auto grid = openvdb::FloatGrid::create(3);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  for (int x = 0; x < size; ++x) {
    for (int y = 0; y < size; ++y) {
      for (int z = 0; z < size; ++z) {
        const double d = wedge.distance(Vec3(x, y, z));
        grid->tree().setValue(openvdb::Coord(x, y, z),
                              static_cast<float>(std::clamp(d, -3.0, 3.0)));
      }
    }
  }
  return grid;
}

uniform::UniformSurface makeSurface(const openvdb::GridBase& grid, base::Job& job) {
  return uniform::makeUniformSurface(grid::openVolume(grid, {}, job), {}, {}, job);
}

Vec3 pointOf(const uniform::UniformSurface& surface, VertexIndex v) {
  return Vec3(surface.mesh.positions[v]) + Vec3(surface.affine().origin());
}

int countOnCrease(const uniform::UniformSurface& surface, const Wedge& wedge) {
  int count = 0;
  for (VertexIndex v = 0; v < surface.mesh.positions.size(); ++v) {
    count += wedge.offCrease(pointOf(surface, v)) < 0.02 ? 1 : 0;
  }
  return count;
}

// Edges of more than 150 degrees between faces of more than a twentieth of a square voxel.
int countFolds(const Mesh& mesh) {
  struct Face {
    VertexIndex low, high;
    Vec3 normal{0.0};
  };
  std::vector<Face> faces;
  for (const Triangle& t : triangulate(mesh)) {
    const Vec3 a(mesh.positions[t.vertices[0]]);
    const Vec3 normal =
        (Vec3(mesh.positions[t.vertices[1]]) - a).cross(Vec3(mesh.positions[t.vertices[2]]) - a);
    if (normal.length() < 2 * 0.05) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex v = t.vertices[i], w = t.vertices[(i + 1) % 3];
      faces.push_back({std::min(v, w), std::max(v, w), normal.unitOrX()});
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  });
  int folds = 0;
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    const Face &a = faces[i], &b = faces[i + 1];
    folds += a.low == b.low && a.high == b.high && a.normal.dot(b.normal) < -0.866 ? 1 : 0;
  }
  return folds;
}

// Calls look(wedge, surface, report) for repaired surfaces of wedges from these angles on, each in
// another place and turn.
template <class Look>
void forRepairedWedges(double degrees, double degreesMore, const Look& look) {
  for (int i = 0; i < 24; ++i) {
    SCOPED_TRACE(i);
    const Wedge wedge(degrees + degreesMore * i, {30.3, 30.1 + 0.13 * i, 30.4}, {1, 0.1 * i, 0.2},
                      {0.3 - 0.05 * i, 0.2, 1});
    const auto grid = makeGrid(wedge, 60);
    base::Job job(1, {});
    uniform::UniformSurface surface = makeSurface(*grid, job);
    ContourReport report;
    (void)repairUniform(surface, report, job);
    look(wedge, surface, report);
  }
}

// Sheets further apart than 140 degrees may fold, but no more than they do; and components that are
// put back leave no fold behind.
TEST(AcuteEdges, FoldNoMoreThanTheirSheets) {
  forRepairedWedges(
      34, 0.1,
      [](const Wedge&, const uniform::UniformSurface& surface, const ContourReport& report) {
        EXPECT_EQ(countFolds(surface.mesh), 0);
        EXPECT_EQ(report.intersectionsLeft, 0U);
      });
}

// A prism along z whose edge of some degrees runs through samples, as do its ends: all that is
// zero in the field, or nearly so, is so by rounding.
openvdb::FloatGrid::Ptr makePrism(double degrees, int size) {
  const double half = degrees / 2 * 3.14159265358979 / 180;
  const auto grid = openvdb::FloatGrid::create(3);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  for (int x = -4; x <= size + 4; ++x) {
    for (int y = -size; y <= size; ++y) {
      for (int z = -4; z <= size + 4; ++z) {
        const double d =
            std::max({std::abs(y) * std::cos(half) - x * std::sin(half), x - size * std::cos(half),
                      static_cast<double>(-z), static_cast<double>(z - size)});
        if (d > -3 && d < 3) {
          grid->tree().setValue(openvdb::Coord(x, y, z), static_cast<float>(d));
        } else if (d <= -3) {
          grid->tree().setValueOff(openvdb::Coord(x, y, z), -3.0f);
        }
      }
    }
  }
  return grid;
}

// Where an edge lies in line with the lattice, up to four cells have their vertices at each of its
// points, and the triangles between are needles without area.
TEST(AcuteEdges, CoarsenInLineWithTheLattice) {
  for (const double degrees : {20.0, 35.0, 50.0, 70.0}) {
    const auto grid = makePrism(degrees, 40);
    for (const double tolerance : {0.1, 0.5, 2.0}) {
      SCOPED_TRACE(std::to_string(degrees) + " " + std::to_string(tolerance));
      ContourOptions options;
      options.tolerance = tolerance;
      ContourReport report;
      const Mesh mesh = contour(*grid, options, &report);
      EXPECT_LE(mesh.triangles.size(), 24U);
      EXPECT_EQ(report.intersectionsLeft, 0U);
      if (degrees > 30) {
        EXPECT_EQ(countFolds(mesh), 0);
      }
    }
  }
}

// A solid between planes of these normals, each in that distance from its middle, turned as the
// seed says: no edge is in line with the lattice.
openvdb::FloatGrid::Ptr makeTurned(std::vector<Vec3> normals, const std::vector<double>& distances,
                                   unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (const std::size_t axis : {0, 1, 2, 0}) {
    const double turn = 6.28318530718 * number(), c = std::cos(turn), s = std::sin(turn);
    for (Vec3& n : normals) {
      double &x = n[static_cast<int>((axis + 1) % 3)], &y = n[static_cast<int>((axis + 2) % 3)];
      std::tie(x, y) = std::pair(c * x - s * y, s * x + c * y);
    }
  }
  const Vec3 middle(number(), number(), number());
  const auto grid = openvdb::FloatGrid::create(3);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  constexpr int kSize = 48;
  for (int x = -kSize; x <= kSize; ++x) {
    for (int y = -kSize; y <= kSize; ++y) {
      for (int z = -kSize; z <= kSize; ++z) {
        double d = -3;
        for (std::size_t i = 0; i < normals.size() && d < 3; ++i) {
          d = std::max(d, normals[i].dot(Vec3(x, y, z) - middle) - distances[i]);
        }
        if (d >= 3) continue;
        const openvdb::Coord at(x, y, z);
        if (d > -3)
          grid->tree().setValue(at, static_cast<float>(d));
        else
          grid->tree().setValueOff(at, -3.0f);
      }
    }
  }
  return grid;
}

// Cells hold crossings of both sheets up to two voxels behind such an edge, which their vertices
// reach. What is left comes from crowded places of the edge, and from samples that are alone.
TEST(AcuteEdges, CoarsenWhereverTheyPoint) {
  const double third = 1 / std::sqrt(3.0);
  const std::vector<Vec3> tetrahedron = {{third, third, third},
                                         {third, -third, -third},
                                         {-third, third, -third},
                                         {-third, -third, third}};
  const auto prism = [](double degrees) {
    const double half = degrees / 2 * 3.14159265358979 / 180;
    return std::vector<Vec3>{{-std::sin(half), std::cos(half), 0},
                             {-std::sin(half), -std::cos(half), 0},
                             {1, 0, 0},
                             {0, 0, 1},
                             {0, 0, -1}};
  };
  const auto count = [](const openvdb::FloatGrid::Ptr& grid) {
    ContourOptions options;
    options.tolerance = 0.1;
    ContourReport report;
    const Mesh mesh = contour(*grid, options, &report);
    EXPECT_EQ(report.intersectionsLeft, 0U);
    EXPECT_EQ(countFolds(mesh), 0);
    return mesh.triangles.size();
  };
  std::vector<std::size_t> counts[3];
  for (unsigned seed = 1; seed <= 5; ++seed) {
    counts[0].push_back(count(makeTurned(tetrahedron, {9, 9, 9, 9}, seed)));
    counts[1].push_back(count(makeTurned(prism(70), {8, 8, 14, 16, 16}, seed)));
    counts[2].push_back(count(makeTurned(prism(50), {6, 6, 16, 16, 16}, seed)));
  }
  for (auto& of : counts) std::sort(of.begin(), of.end());
  EXPECT_LE(counts[0].back(), 12U);
  for (const auto& prisms : {counts[1], counts[2]}) {
    EXPECT_LE(prisms[prisms.size() / 2], 24U);
    EXPECT_LE(prisms.back(), 40U);
  }
}

// Conflicts there are settled along creases and over sheets where that is enough, and lone samples
// pass over all of their crease: of thousands of vertices few end up behind the sheets.
TEST(AcuteEdges, KeepTheirVerticesOnTheSheets) {
  int behind = 0, all = 0;
  forRepairedWedges(
      40, 1, [&](const Wedge& wedge, const uniform::UniformSurface& surface, const ContourReport&) {
        for (VertexIndex v = 0; v < surface.mesh.positions.size(); ++v) {
          const Vec3 at = pointOf(surface, v);
          if (std::max({at[0], at[1], at[2]}) > 56 || std::min({at[0], at[1], at[2]}) < 3) continue;
          behind += wedge.distance(at) < -0.1 ? 1 : 0;
          ++all;
        }
      });
  EXPECT_GT(all, 100000);
  EXPECT_LE(behind, 10);
}

TEST(OrderAlongCreases, KeepsVerticesOnTheirCreaseAndInTheirPlaces) {
  int withOrder = 0, without = 0;
  std::size_t moved = 0;
  for (int seed = 0; seed < 6; ++seed) {
    const Wedge wedge(50 + 5 * seed, {20.3, 20.1 + 0.13 * seed, 20.4}, {1, 0.3 * seed, 0.2},
                      {0.3, 0.2 * seed, 1});
    const auto grid = makeGrid(wedge, 40);
    base::Job job(1, {});
    uniform::UniformSurface plain = makeSurface(*grid, job);
    uniform::UniformSurface ordered = makeSurface(*grid, job);
    const int before = countOnCrease(ordered, wedge);
    moved += orderAlongCreases(ordered, job);
    // All slides are along the crease.
    EXPECT_EQ(countOnCrease(ordered, wedge), before) << seed;
    EXPECT_EQ(orderAlongCreases(ordered, job), 0U) << seed;
    (void)withdrawPlacements(plain, 0, job);
    (void)withdrawPlacements(ordered, 0, job);
    without += countOnCrease(plain, wedge);
    withOrder += countOnCrease(ordered, wedge);
  }
  EXPECT_GT(moved, 20U);
  EXPECT_GT(withOrder, without);
}

// A sample by a twentieth of a voxel inside, none of whose neighbours is: the solid reaches it, the
// lattice does not.
TEST(LoneSamples, GiveWayToTheCreaseThatTheyAreOn) {
  const Vec3 ahead = Vec3(1, 1, 0).unitOrX(), aside = Vec3(-1, 1, 0).unitOrX();
  const Vec3 along = ahead * 0.05 + aside * 0.4 + Vec3(0, 0, 1);
  const Vec3 sample(20, 20, 20);
  const Wedge wedge(50, sample + ahead * 0.1, ahead, along);
  ASSERT_LT(wedge.distance(sample), -0.02);
  const auto grid = makeGrid(wedge, 40);
  base::Job job(1, {});
  uniform::UniformSurface surface = makeSurface(*grid, job);
  const std::vector<LoneComponent> lone = findLoneComponents(surface.mesh, job);
  ASSERT_GE(lone.size(), 1U);
  std::vector<bool> isLone(surface.mesh.positions.size());
  for (const LoneComponent& component : lone) {
    for (const std::uint32_t quad : component) {
      for (const VertexIndex v : surface.mesh.quads[quad].vertices) isLone[v] = true;
    }
  }
  EXPECT_EQ(liftLoneComponents(surface.mesh, surface.sheets, lone, sourceOf(surface, job)),
            8 * lone.size());
  for (VertexIndex v = 0; v < isLone.size(); ++v) {
    const double off = wedge.distance(pointOf(surface, v));
    if (isLone[v]) {
      EXPECT_NEAR(off, 0.3, 0.201);
    }
  }
  ContourReport report;
  (void)repairUniform(surface, report, job);
  EXPECT_EQ(report.intersectionsLeft, 0U);
  double deepest = 0;
  for (VertexIndex v = 0; v < isLone.size(); ++v) {
    const Vec3 at = pointOf(surface, v);
    const bool isAtBorder =
        std::max({at[0], at[1], at[2]}) > 36 || std::min({at[0], at[1], at[2]}) < 3;
    if (!isAtBorder) deepest = std::min(deepest, wedge.distance(at));
  }
  EXPECT_GT(deepest, -0.05);
}

}  // namespace
}  // namespace tufa::refine
