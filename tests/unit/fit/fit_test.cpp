// Blobs fitted to meshes.

#include <gtest/gtest.h>

#include <openvdb/openvdb.h>
#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/fit.h>
#include <tufa/implicit.h>
#include <tufa/memory.h>
#include <tufa/shapes.h>
#include <tufa/voxelize.h>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "support/expect_error.h"

namespace tufa {
namespace {

class Fit : public testing::Test {
 protected:
  void SetUp() override {
    if (!canFitBlobs()) GTEST_SKIP() << "built without Ceres Solver";
  }
};

Mesh meshOf(const std::string& scene, double voxelSize) {
  VoxelizeOptions options;
  options.voxelSize = voxelSize;
  return contour(*voxelize(*implicit::readScene(FileBytes{scene, "scene"}).field, options));
}

Mesh meshOf(Shape shape, double voxelSize) {
  ShapeOptions options;
  options.voxelSize = voxelSize;
  return contour(*makeShape(shape, options));
}

TEST_F(Fit, OneBlobIsASphere) {
  const Mesh sphere = meshOf(Shape::Sphere, 0.05);
  FitOptions options;
  options.blobs = 1;
  const BlobFit fit = fitBlobs(sphere, options);
  ASSERT_EQ(fit.blobs.size(), 1u);
  EXPECT_LT(fit.largestDistance, 0.01);
  const Blob& blob = fit.blobs[0];
  // Where the density is the threshold.
  const double radius =
      blob.radius * std::sqrt(std::log(blob.weight / fit.threshold) / fit.blobbiness);
  EXPECT_NEAR(radius, 1, 0.01);
  EXPECT_NEAR(blob.centre.x, 0, 0.01);
}

// What is a surface of blobs is found again: the derivatives must be right for that.
TEST_F(Fit, FindsBlobsAgain) {
  BlobFit truth;
  truth.blobs = {{{0, 0, 0}, 1, 1}, {{0.8, 0.1, 0}, 0.7, 1.2}, {{-0.2, 0.9, 0.3}, 0.6, 0.9}};
  const Mesh mesh = meshOf(sceneOf(truth), 0.03);
  FitOptions options;
  options.blobs = 8;
  const BlobFit fit = fitBlobs(mesh, options);
  EXPECT_LT(fit.rmsDistance, 2e-3 * fit.diagonal);
}

TEST_F(Fit, TheEnergyFallsAtEveryStep) {
  for (const Shape shape : {Shape::Bracket, Shape::Torus}) {
    FitOptions options;
    options.blobs = 20;
    const BlobFit fit = fitBlobs(meshOf(shape, 0.06), options);
    ASSERT_GE(fit.steps.size(), 15u);
    for (std::size_t i = 1; i < fit.steps.size(); ++i) {
      EXPECT_LT(fit.steps[i].energy, fit.steps[i - 1].energy);
      EXPECT_GT(fit.steps[i].blobs, fit.steps[i - 1].blobs);
    }
    EXPECT_EQ(fit.steps.back().blobs, fit.blobs.size());
    EXPECT_LT(fit.rmsDistance, 0.02 * fit.diagonal);
  }
}

// It ended at one blob for the torus and at two for the cube, where no split alone is any better.
TEST_F(Fit, GoesOnWhereSolidsAreSymmetric) {
  const std::string cube = R"({"tufa_scene": 1, "objects": [{"type": "box", "size": [2, 2, 2]}]})";
  for (const Mesh& mesh : {meshOf(Shape::Torus, 0.08), meshOf(cube, 0.05)}) {
    FitOptions options;
    options.blobs = 20;
    const BlobFit fit = fitBlobs(mesh, options);
    EXPECT_EQ(fit.blobs.size(), 20u);
    EXPECT_LT(fit.rmsDistance, 0.02 * fit.diagonal);
    for (std::size_t i = 1; i < fit.steps.size(); ++i) {
      EXPECT_LT(fit.steps[i].energy, fit.steps[i - 1].energy);
    }
  }
}

TEST_F(Fit, IsTheSameForAnyNumberOfThreadsAndAnywhere) {
  Mesh mesh = meshOf(Shape::Torus, 0.1);
  FitOptions options;
  options.blobs = 6;
  options.threads = 1;
  const std::string one = sceneOf(fitBlobs(mesh, options));
  options.threads = 2;
  const BlobFit two = fitBlobs(mesh, options);
  EXPECT_EQ(one, sceneOf(two));
  for (Position& p : mesh.positions) p = {1000 * p.x, 1000 * p.y, 1000 * p.z};
  const BlobFit large = fitBlobs(mesh, options);
  EXPECT_NEAR(large.rmsDistance, 1000 * two.rmsDistance, 20 * two.rmsDistance);
}

TEST_F(Fit, EndsAtTheError) {
  FitOptions options;
  options.error = 0.02;
  const BlobFit fit = fitBlobs(meshOf(Shape::Torus, 0.1), options);
  EXPECT_LT(fit.blobs.size(), 64u);
  EXPECT_LE(fit.steps.back().rmsDistance, 0.02 * fit.diagonal);
}

TEST_F(Fit, ItsSceneIsTheSurface) {
  const Mesh torus = meshOf(Shape::Torus, 0.1);
  FitOptions options;
  options.blobs = 12;
  const BlobFit fit = fitBlobs(torus, options);
  const std::string text = sceneOf(fit);
  const implicit::Scene scene = implicit::readScene(FileBytes{text, "fit"});
  double squared = 0;
  for (const Position& p : torus.positions) {
    const Position g = scene.field->gradient(p);
    const double slope = std::sqrt(g.x * g.x + g.y * g.y + g.z * g.z);
    const double distance = scene.field->value(p) / slope;
    squared += distance * distance;
  }
  const double rms = std::sqrt(squared / static_cast<double>(torus.positions.size()));
  // Vertices are not spread as samples are.
  EXPECT_LT(rms, 2 * fit.rmsDistance);
  EXPECT_GT(rms, fit.rmsDistance / 2);
  EXPECT_FALSE(meshOf(text, 0.1).positions.empty());
}

TEST_F(Fit, CanBeCancelled) {
  FitOptions options;
  int calls = 0;
  options.progress = [&](std::string_view, double) { return ++calls < 3; };
  const Mesh mesh = meshOf(Shape::Torus, 0.1);
  test::expectError(ErrorCode::Cancelled, "", [&] { (void)fitBlobs(mesh, options); });
}

// Not only when a blob is done: with many samples one takes many seconds.
TEST_F(Fit, CanBeCancelledWithinABlob) {
  FitOptions options;
  options.blobs = 1;
  options.threads = 1;
  int calls = 0;
  options.progress = [&](std::string_view stage, double) { return stage != "fit" || ++calls < 5; };
  const Mesh mesh = meshOf(Shape::Torus, 0.1);
  test::expectError(ErrorCode::Cancelled, "", [&] { (void)fitBlobs(mesh, options); });
  EXPECT_EQ(calls, 5);
}

// Their scenes would have numbers that cannot be read.
TEST_F(Fit, RefusesWhatScenesCannotHave) {
  const Mesh torus = meshOf(Shape::Torus, 0.2);
  FitOptions options;
  options.blobs = 4;
  options.samples = 500;
  const auto scaled = [&](double by) {
    Mesh mesh = torus;
    for (Position& p : mesh.positions) p = {by * p.x, by * p.y, by * p.z};
    return mesh;
  };
  for (const double scale : {1e11, 1e300, 1e-10, 1e-13}) {
    test::expectError(ErrorCode::InvalidArgument, "scale it first",
                      [&] { (void)fitBlobs(scaled(scale), options); });
  }
  for (const double scale : {1e9, 1e-8}) {
    const std::string text = sceneOf(fitBlobs(scaled(scale), options));
    EXPECT_NO_THROW((void)implicit::readScene(FileBytes{text, "fit"})) << scale;
  }
}

TEST_F(Fit, RefusesWhatIsNoMesh) {
  const auto refuses = [](const Mesh& mesh, const FitOptions& options, const std::string& why) {
    test::expectError(ErrorCode::InvalidArgument, why, [&] { (void)fitBlobs(mesh, options); });
  };
  refuses({}, {}, "no area");
  Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.triangles = {{0, 1, 2}};
  refuses(flat, {}, "no area");
  flat.positions[1].y = std::numeric_limits<double>::quiet_NaN();
  refuses(flat, {}, "vertex 1");
  const Mesh torus = meshOf(Shape::Torus, 0.2);
  Mesh inward = torus;
  for (Triangle& triangle : inward.triangles) {
    std::swap(triangle.vertices[0], triangle.vertices[1]);
  }
  refuses(inward, {}, "inward");
  FitOptions options;
  options.blobs = 0;
  refuses(torus, options, "number of blobs");
  options = {};
  options.error = -1;
  refuses(torus, options, "error");
  options = {};
  options.valueWeight = 0;
  refuses(torus, options, "weight of values");
  options = {};
  options.samples = -1;
  refuses(torus, options, "number of samples");
}

}  // namespace
}  // namespace tufa
