// Chains of levels: what every level keeps, and which one a camera gets.

#include <gtest/gtest.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <tufa/check.h>
#include <tufa/error.h>
#include <tufa/implicit.h>
#include <tufa/lod.h>
#include <tufa/memory.h>
#include <tufa/shapes.h>
#include <tufa/voxelize.h>

#include <cmath>

#include "support/expect_error.h"
#include "support/fields.h"
#include "support/shape.h"

namespace tufa {
namespace {

using test::expectError;

struct Sample {
  const char* name;
  Shape shape;
  double voxelSize;
};

class LodChains : public ::testing::TestWithParam<Sample> {};
INSTANTIATE_TEST_SUITE_P(Shapes, LodChains,
                         ::testing::Values(Sample{"bracket", Shape::Bracket, 0.03},
                                           Sample{"sphere", Shape::Sphere, 0.03},
                                           Sample{"torus", Shape::Torus, 0.03},
                                           Sample{"gyroid", Shape::Gyroid, 0.05},
                                           Sample{"terrain", Shape::Terrain, 0.03}),
                         [](const auto& test) { return std::string(test.param.name); });

/// What holds for each level of every chain.
void expectPromises(const LodChain& chain) {
  for (std::size_t i = 0; i < chain.levels.size(); ++i) {
    const Lod& lod = chain.levels[i];
    SCOPED_TRACE("level " + std::to_string(i));
    EXPECT_LE(lod.certificate.maxErrorVoxels, lod.tolerance);
    EXPECT_LE(lod.certificate.meanErrorVoxels, lod.certificate.maxErrorVoxels);
    const CheckReport report = check(lod.mesh);
    EXPECT_TRUE(report.watertight());
    EXPECT_EQ(report.selfIntersectingPairs, 0u);
    EXPECT_EQ(report.eulerCharacteristic, lod.certificate.eulerCharacteristic);
    if (i == 0) continue;
    const Lod& finer = chain.levels[i - 1];
    EXPECT_EQ(lod.certificate.eulerCharacteristic, finer.certificate.eulerCharacteristic);
    EXPECT_LT(lod.mesh.triangleCount(), finer.mesh.triangleCount());
    EXPECT_GT(lod.certificate.maxErrorVoxels, finer.certificate.maxErrorVoxels);
    EXPECT_GT(lod.tolerance, finer.tolerance);
    EXPECT_LE(lod.screenCoverage, finer.screenCoverage);
  }
}

void expectEqual(const LodChain& a, const LodChain& b) {
  ASSERT_EQ(a.levels.size(), b.levels.size());
  for (std::size_t i = 0; i < a.levels.size(); ++i) {
    EXPECT_EQ(a.levels[i].mesh.positions, b.levels[i].mesh.positions);
    EXPECT_EQ(a.levels[i].mesh.normals, b.levels[i].mesh.normals);
    EXPECT_EQ(a.levels[i].mesh.quads, b.levels[i].mesh.quads);
    EXPECT_EQ(a.levels[i].mesh.triangles, b.levels[i].mesh.triangles);
    EXPECT_EQ(a.levels[i].tolerance, b.levels[i].tolerance);
  }
}

TEST_P(LodChains, EveryLevelKeepsItsPromises) {
  LodOptions options;
  options.levels = 4;
  const LodChain chain = buildLods(*test::shapeOf(GetParam().shape, GetParam().voxelSize), options);
  ASSERT_GE(chain.levels.size(), 2u);
  EXPECT_EQ(chain.levels.size() < 4, !chain.stopped.empty()) << chain.stopped;
  EXPECT_NEAR(chain.voxelSize, GetParam().voxelSize, 1e-12);
  expectPromises(chain);
  EXPECT_EQ(chain.levels.back().screenCoverage, 0);
}

TEST_P(LodChains, KeepTheirBudgets) {
  const auto grid = test::shapeOf(GetParam().shape, GetParam().voxelSize);
  ContourOptions uniform;
  uniform.uniform = true;
  const std::size_t all = contour(*grid, uniform).triangleCount();
  LodOptions options;
  options.triangles = {all / 4, all / 16, all / 48};
  // A gyroid's handles need a sixth.
  if (GetParam().shape == Shape::Gyroid) options.triangles = {all / 2, all / 4};
  options.contour.threads = 1;
  const LodChain chain = buildLods(*grid, options);
  ASSERT_EQ(chain.levels.size(), options.triangles.size()) << chain.stopped;
  EXPECT_EQ(chain.stopped, "");
  expectPromises(chain);
  for (std::size_t i = 0; i < chain.levels.size(); ++i) {
    const auto most = static_cast<double>(options.triangles[i]);
    const auto count = static_cast<double>(chain.levels[i].mesh.triangleCount());
    EXPECT_LE(count, most);
    EXPECT_GE(count, 0.95 * most);
    EXPECT_EQ(chain.levels[i].tolerance, chain.levels[i].certificate.maxErrorVoxels);
  }
  options.contour.threads = 2;
  expectEqual(chain, buildLods(*grid, options));
}

// A number of triangles costs no more error than the tolerance that gives as many.
TEST(LodChain, SpendsNoMoreErrorOnABudgetThanATolerance) {
  for (const Shape kind : {Shape::Torus, Shape::Terrain, Shape::Bracket}) {
    const auto grid = test::shapeOf(kind, 0.03);
    for (const double tolerance : {0.1, 0.3, 0.9}) {
      SCOPED_TRACE(std::to_string(static_cast<int>(kind)) + " at " + std::to_string(tolerance));
      LodOptions options;
      options.tolerances = {tolerance};
      const LodChain within = buildLods(*grid, options);
      options.tolerances.clear();
      options.triangles = {within.levels.at(0).mesh.triangleCount()};
      const LodChain budget = buildLods(*grid, options);
      ASSERT_EQ(budget.levels.size(), 1u) << budget.stopped;
      EXPECT_LE(budget.levels[0].mesh.triangleCount(), options.triangles[0]);
      EXPECT_GE(budget.levels[0].mesh.triangleCount(), options.triangles[0] * 95 / 100);
      EXPECT_LE(budget.levels[0].certificate.maxErrorVoxels,
                1.2 * within.levels[0].certificate.maxErrorVoxels);
    }
  }
}

// A cube with 48 square tunnels, whose topology needs most of its triangles at any tolerance. What
// few phases had left was once made up for by a larger tolerance, with 28% more error.
TEST(LodChain, SpendsNoMoreErrorOnABudgetWhereCountsHardlyFall) {
  const std::string text =
      R"({"tufa_scene": 1, "objects": [{"type": "difference", "objects": [
        {"type": "box", "size": [2, 2, 2]},
        {"type": "repeat", "step": [0.5, 0.5, 4], "count": [4, 4, 1],
         "object": {"type": "box", "size": [0.17, 0.17, 3], "center": [-0.75, -0.75, 0]}},
        {"type": "repeat", "step": [0.5, 4, 0.5], "count": [4, 1, 4],
         "object": {"type": "box", "size": [0.17, 3, 0.17], "center": [-0.75, 0, -0.75]}},
        {"type": "repeat", "step": [4, 0.5, 0.5], "count": [1, 4, 4],
         "object": {"type": "box", "size": [3, 0.17, 0.17], "center": [0, -0.75, -0.75]}}]}]})";
  VoxelizeOptions voxels;
  voxels.voxelSize = 0.025;
  const auto grid = voxelize(*implicit::readScene(FileBytes{text, "tunnels"}).field, voxels);
  ContourOptions within;
  within.tolerance = 0.05;
  const std::size_t needed = contour(*grid, within).triangleCount();
  LodOptions options;
  options.triangles = {needed + needed / 50};
  const LodChain budget = buildLods(*grid, options);
  ASSERT_EQ(budget.levels.size(), 1u) << budget.stopped;
  EXPECT_LE(budget.levels[0].certificate.maxErrorVoxels, 1.1 * within.tolerance);
}

TEST(LodChain, EndsBeforeABudgetThatCannotBeMet) {
  LodOptions options;
  options.triangles = {1000, 4};
  const LodChain chain = buildLods(*test::shapeOf(Shape::Torus, 0.05), options);
  ASSERT_EQ(chain.levels.size(), 1u);
  EXPECT_NE(chain.stopped.find("level 1 cannot have 4 triangles"), std::string::npos)
      << chain.stopped;
  expectPromises(chain);
}

TEST(LodChain, LeavesOutBudgetsThatTheLevelBeforeMeetsAlready) {
  LodOptions options;
  options.triangles = {1000000, 900000, 800000, 500};
  const LodChain chain = buildLods(*test::shapeOf(Shape::Torus, 0.05), options);
  ASSERT_EQ(chain.levels.size(), 2u);
  EXPECT_LE(chain.levels[1].mesh.triangleCount(), 500u);
  const std::string count = std::to_string(chain.levels[0].mesh.triangleCount());
  EXPECT_EQ(chain.stopped, "a level of 900000 triangles was left out: level 0 has " + count +
                               " already; a level of 800000 triangles was left out: level 0 has " +
                               count + " already");
  expectPromises(chain);
}

TEST(LodChain, SaysWhatWasComparedForALevelLeftOut) {
  LodOptions options;
  options.tolerances = {1.6, 6.4, 25.6, 102.4};  // soon as coarse as a torus can be
  const LodChain chain = buildLods(*test::shapeOf(Shape::Torus, 0.05), options);
  ASSERT_LT(chain.levels.size(), 4u);
  const std::size_t level = chain.levels.size();
  EXPECT_TRUE(chain.stopped.starts_with("a level at a tolerance of ")) << chain.stopped;
  EXPECT_EQ(chain.stopped.find("00000"), std::string::npos) << chain.stopped;
  const std::string compared = "of the " +
                               std::to_string(chain.levels.back().mesh.triangleCount()) +
                               " of level " + std::to_string(level - 1);
  EXPECT_TRUE(chain.stopped.ends_with(compared)) << chain.stopped;
}

TEST(LodChain, IsEmptyWhereNoBudgetCanBeMet) {
  LodOptions options;
  options.triangles = {4};
  const LodChain chain = buildLods(*test::shapeOf(Shape::Torus, 0.1), options);
  EXPECT_TRUE(chain.levels.empty());
  EXPECT_NE(chain.stopped.find("level 0 cannot have 4 triangles"), std::string::npos);
}

// A ball of radius 20 with a bubble of 2 in it, and balls of 1.5 and 4 beside it; voxels of 0.5.
openvdb::FloatGrid::Ptr balls() {
  const auto ball = [](float radius, const openvdb::Vec3f& centre) {
    return openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(radius * 0.5F, centre, 0.5F);
  };
  const auto grid = ball(20, openvdb::Vec3f(1, 0, 0));
  openvdb::tools::csgDifference(*grid, *ball(2, openvdb::Vec3f(1, 2, 0)));
  openvdb::tools::csgUnion(*grid, *ball(1.5, openvdb::Vec3f(15, 0, 0)));
  openvdb::tools::csgUnion(*grid, *ball(4, openvdb::Vec3f(0, 15, 0)));
  return grid;
}

// A ball with a surface of radius 20 voxels, bubbles close inside of it and balls close outside.
openvdb::FloatGrid::Ptr ballAmongSmallOnes() {
  constexpr double kRadius = 20, kSmall = 1.3, kGap = 0.9;
  constexpr int kCount = 60;
  std::vector<openvdb::Vec3d> centres;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (2 * i + 1.0) / kCount;
    const double turn = i * 2.399963;  // the golden angle
    const double ring = std::sqrt(1 - z * z);
    const double from = i % 2 == 0 ? kRadius - kSmall - kGap : kRadius + kSmall + kGap;
    centres.push_back(openvdb::Vec3d(ring * std::cos(turn), ring * std::sin(turn), z) * from);
  }
  const openvdb::CoordBBox box(openvdb::Coord(-28), openvdb::Coord(28));
  return test::levelSet<openvdb::FloatGrid>(box, 3, [&](const openvdb::Coord& at) {
    double distance = at.asVec3d().length() - kRadius;
    for (std::size_t i = 0; i < centres.size(); ++i) {
      const double own = (at.asVec3d() - centres[i]).length() - kSmall;
      distance = i % 2 == 0 ? std::max(distance, -own) : std::min(distance, own);
    }
    return distance;
  });
}

TEST(LodChain, LeavesSmallPiecesOnTheirSideOfALargeOne) {
  LodOptions options;
  options.tolerances = {0.1, 0.4, 4};
  const LodChain chain = buildLods(*ballAmongSmallOnes(), options);
  ASSERT_EQ(chain.levels.size(), 3u) << chain.stopped;
  EXPECT_GT(check(chain.levels[0].mesh).components.size(), 50u);
  expectPromises(chain);
}

TEST(LodChain, HasAboutAsManyTrianglesInsideOutOrMirrored) {
  const auto grid = ballAmongSmallOnes();
  LodOptions options;
  options.tolerances = {0.1, 1.6};
  const LodChain usual = buildLods(*grid, options);
  options.contour.inside = Inside::Above;
  const LodChain turned = buildLods(*grid, options);
  options.contour.inside = Inside::Auto;
  grid->setTransform(openvdb::math::Transform::createLinearTransform(1));
  grid->transform().postScale(openvdb::Vec3d(-1, 1, 1));
  const LodChain mirrored = buildLods(*grid, options);
  expectPromises(mirrored);
  for (const LodChain* other : {&turned, &mirrored}) {
    ASSERT_EQ(other->levels.size(), usual.levels.size());
    for (std::size_t i = 0; i < usual.levels.size(); ++i) {
      const auto count = static_cast<double>(usual.levels[i].mesh.triangleCount());
      EXPECT_NEAR(static_cast<double>(other->levels[i].mesh.triangleCount()), count, 0.25 * count)
          << i;
    }
  }
}

TEST(LodChain, DropsComponentsSmallerThanTheTolerance) {
  LodOptions options;
  options.tolerances = {0.1, 2, 8, 20};
  options.allowTopologyChange = true;
  const LodChain chain = buildLods(*balls(), options);
  ASSERT_EQ(chain.levels.size(), 4u) << chain.stopped;
  const std::size_t dropped[4] = {0, 0, 2, 1}, left[4] = {4, 4, 2, 1};
  for (std::size_t i = 0; i < 4; ++i) {
    const Lod& lod = chain.levels[i];
    ASSERT_EQ(lod.dropped.size(), dropped[i]);
    const CheckReport report = check(lod.mesh);
    EXPECT_TRUE(report.watertight());
    EXPECT_EQ(report.selfIntersectingPairs, 0u);
    EXPECT_EQ(report.components.size(), left[i]);
    EXPECT_EQ(report.unusedVertices, 0u);
    EXPECT_EQ(report.eulerCharacteristic, lod.certificate.eulerCharacteristic);
    EXPECT_LE(lod.certificate.maxErrorVoxels, lod.tolerance);
    for (const DroppedComponent& piece : lod.dropped) EXPECT_LE(piece.sizeVoxels, lod.tolerance);
  }
  const DroppedComponent& last = chain.levels[3].dropped[0];
  // Of the four balls this one, up to a vertex that goes onto a crease of so small a ball.
  EXPECT_NEAR(last.centre.x, 0, 0.1);
  EXPECT_NEAR(last.centre.y, 15, 0.1);
  EXPECT_NEAR(last.sizeVoxels, 8 * std::sqrt(3.0), 0.5);
}

TEST(LodChain, DropsComponentsForABudget) {
  LodOptions options;
  options.triangles = {2000, 12};
  EXPECT_EQ(buildLods(*balls(), options).levels.size(), 1u);  // four pieces need 16
  options.allowTopologyChange = true;
  const LodChain chain = buildLods(*balls(), options);
  ASSERT_EQ(chain.levels.size(), 2u) << chain.stopped;
  const Lod& lod = chain.levels[1];
  EXPECT_LE(lod.mesh.triangleCount(), 12u);
  EXPECT_TRUE(check(lod.mesh).watertight());
  EXPECT_FALSE(lod.dropped.empty());
  EXPECT_LE(lod.certificate.maxErrorVoxels, lod.tolerance);
  for (const DroppedComponent& piece : lod.dropped) EXPECT_LE(piece.sizeVoxels, lod.tolerance);
}

TEST(LodChain, HasNoMoreThanTheUniformMesh) {
  const auto grid = test::shapeOf(Shape::Sphere, 0.2);
  ContourOptions uniform;
  uniform.uniform = true;
  LodOptions options;
  options.triangles = {1000000, 100};
  const LodChain chain = buildLods(*grid, options);
  ASSERT_EQ(chain.levels.size(), 2u);
  EXPECT_EQ(chain.levels[0].mesh.triangleCount(), contour(*grid, uniform).triangleCount());
  EXPECT_EQ(chain.levels[0].certificate.maxErrorVoxels, 0);
}

TEST(LodChain, TakesAListOfTolerances) {
  LodOptions options;
  options.tolerances = {0.05, 0.3, 0.5};
  const LodChain chain = buildLods(*test::shapeOf(Shape::Torus, 0.05), options);
  ASSERT_EQ(chain.levels.size(), 3u) << chain.stopped;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(chain.levels[i].tolerance, options.tolerances[i]);
  }
}

TEST(LodChain, LevelZeroIsTheMeshOfContour) {
  const auto grid = test::shapeOf(Shape::Bracket, 0.05);
  LodOptions options;
  options.levels = 2;
  const LodChain chain = buildLods(*grid, options);
  const Mesh mesh = contour(*grid, options.contour);
  EXPECT_EQ(chain.levels.at(0).mesh.positions, mesh.positions);
  EXPECT_EQ(chain.levels.at(0).mesh.quads, mesh.quads);
  EXPECT_EQ(chain.levels.at(0).mesh.triangles, mesh.triangles);
}

TEST(LodChain, StopsWhereTopologyAllowsNoCoarserMesh) {
  LodOptions options;
  options.tolerances = {0.1, 1000, 2000};
  double last = 0;
  options.contour.progress = [&](std::string_view, double fraction) {
    last = fraction;
    return true;
  };
  const LodChain chain = buildLods(*test::shapeOf(Shape::Sphere, 0.1), options);
  EXPECT_EQ(chain.levels.size(), 2u);
  EXPECT_NE(chain.stopped.find("a tolerance of 2000 voxels was left out"), std::string::npos)
      << chain.stopped;
  EXPECT_EQ(last, 1);
}

// All tolerances after the first one that was not worthwhile were left out.
TEST(LodChain, LeavesOutToleranceByToleranceOfAList) {
  LodOptions options;
  options.tolerances = {1e-300, 1e-200, 0.1, 0.4};
  const LodChain chain = buildLods(*test::shapeOf(Shape::Torus, 0.05), options);
  ASSERT_EQ(chain.levels.size(), 3u) << chain.stopped;
  EXPECT_EQ(chain.levels[1].tolerance, 0.1);
  EXPECT_EQ(chain.levels[2].tolerance, 0.4);
  EXPECT_TRUE(chain.stopped.starts_with("a level at a tolerance of 1e-200 voxels was left out"))
      << chain.stopped;
  expectPromises(chain);
}

// The chain ended before the tolerance at which a component could go.
TEST(LodChain, GoesOnByTheFactorWhereComponentsMayGo) {
  const openvdb::Vec3d other(48.3, 0.2, 0.1);
  const auto grid = test::levelSet<openvdb::FloatGrid>(
      {openvdb::Coord(-12), openvdb::Coord(64, 12, 12)}, 3, [&](const openvdb::Coord& at) {
        return std::min(at.asVec3d().length() - 8, (at.asVec3d() - other).length() - 6);
      });
  LodOptions options;
  options.levels = 3;
  options.factor = 1.3;
  options.contour.tolerance = 15;  // two tetrahedra, nearly; the smaller ball's box has 20.8
  EXPECT_EQ(buildLods(*grid, options).levels.size(), 1u);
  options.allowTopologyChange = true;
  const LodChain chain = buildLods(*grid, options);
  ASSERT_EQ(chain.levels.size(), 2u) << chain.stopped;
  EXPECT_TRUE(chain.stopped.starts_with("a level at a tolerance of 19.5 voxels")) << chain.stopped;
  EXPECT_EQ(chain.levels[1].dropped.size(), 1u);
  EXPECT_EQ(check(chain.levels[1].mesh).components.size(), 1u);
}

// Levels were missing, and nothing said why.
TEST(LodChain, SaysThatItGotToTheLargestTolerance) {
  LodOptions options;
  options.contour.tolerance = 0.1;
  options.factor = 1e6;
  options.levels = 3;
  const LodChain chain = buildLods(*test::shapeOf(Shape::Torus, 0.05), options);
  ASSERT_EQ(chain.levels.size(), 2u) << chain.stopped;
  EXPECT_EQ(chain.stopped,
            "no level follows the tolerance of 1e+05 voxels: the next, of 1e+11, would be above "
            "the largest, 1e+06");
}

TEST(LodChain, IsEmptyWithoutASurface) {
  const auto grid = openvdb::FloatGrid::create(1);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  EXPECT_TRUE(buildLods(*grid).levels.empty());
}

TEST(LodChain, RefusesOptionsOutOfTheirRange) {
  const auto grid = test::shapeOf(Shape::Sphere, 0.2);
  const auto refuses = [&](const char* part, auto change) {
    LodOptions options;
    change(options);
    expectError(ErrorCode::InvalidArgument, part, [&] { (void)buildLods(*grid, options); });
  };
  refuses("1 to 100 levels", [](LodOptions& o) { o.levels = 0; });
  refuses("factor", [](LodOptions& o) { o.factor = 1; });
  refuses("rise", [](LodOptions& o) { o.tolerances = {0.2, 0.1}; });
  refuses("from 0 to 1e+06", [](LodOptions& o) { o.tolerances = {-1}; });
  refuses("fall", [](LodOptions& o) { o.triangles = {100, 100}; });
  refuses("at least 4", [](LodOptions& o) { o.triangles = {100, 3}; });
  refuses("exclude", [](LodOptions& o) {
    o.triangles = {100};
    o.tolerances = {1};
  });
  refuses("simplifying", [](LodOptions& o) {
    o.triangles = {100};
    o.contour.simplify = false;
  });
  refuses("pixelError", [](LodOptions& o) { o.pixelError = 0; });
  refuses("screenHeight", [](LodOptions& o) { o.screenHeight = 0; });
}

/// Three levels of errors 0.01, 0.1 and 1 around the origin, radius 1.
LodChain threeLevels() {
  LodChain chain;
  chain.centre = {0, 0, 0};
  chain.radius = 1;
  for (const double error : {0.01, 0.1, 1.0}) {
    chain.levels.emplace_back();
    chain.levels.back().certificate.maxErrorWorld = error;
  }
  return chain;
}

TEST(SelectLod, TakesTheCoarsestWhoseErrorIsSmallOnTheScreen) {
  const LodChain chain = threeLevels();
  Camera camera;
  camera.verticalAngle = 2 * std::atan(0.5);  // a world unit at distance d has 1000 / d pixels
  camera.screenHeight = 1000;
  const auto at = [&](double distance, double pixels) {
    camera.eye = {0, 0, chain.radius + distance};
    return selectLod(chain, camera, pixels);
  };
  EXPECT_EQ(at(50, 1), 0u);  // 0.1 is 2 pixels
  EXPECT_EQ(at(99, 1), 0u);
  EXPECT_EQ(at(101, 1), 1u);
  EXPECT_EQ(at(999, 1), 1u);
  EXPECT_EQ(at(1001, 1), 2u);
  EXPECT_EQ(at(51, 2), 1u);  // twice the error, half the distance
  camera.eye = {0, 0, 0.5};  // inside the sphere
  EXPECT_EQ(selectLod(chain, camera, 1000), 0u);
}

TEST(SelectLod, AgreesWithScreenCoverage) {
  LodOptions options;
  options.levels = 3;
  const LodChain chain = buildLods(*test::shapeOf(Shape::Sphere, 0.03), options);
  for (std::size_t i = 0; i + 1 < chain.levels.size(); ++i) {
    // Far away the sphere takes 2 r / (2 d tan(a/2)) of the height.
    Camera camera;
    camera.screenHeight = options.screenHeight;
    const auto levelAtCoverage = [&](double coverage) {
      const double distance = chain.radius / (coverage * std::tan(camera.verticalAngle / 2));
      camera.eye = {chain.centre.x, chain.centre.y, chain.centre.z + chain.radius + distance};
      return selectLod(chain, camera, options.pixelError);
    };
    EXPECT_EQ(levelAtCoverage(chain.levels[i].screenCoverage * 1.01), i);
    EXPECT_EQ(levelAtCoverage(chain.levels[i].screenCoverage * 0.99), i + 1);
  }
}

}  // namespace
}  // namespace tufa
