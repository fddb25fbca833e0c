#include "base/triangle_array.h"

#include <gtest/gtest.h>

#include <random>

#include "base/job.h"
#include "base/triangulate.h"

namespace tufa::base {
namespace {

void expectSame(const TriangleView& view, const std::vector<Triangle>& triangles) {
  ASSERT_EQ(view.size(), triangles.size());
  EXPECT_EQ(view.empty(), triangles.empty());
  std::size_t t = 0;
  for (const Triangle& triangle : view) {
    EXPECT_EQ(triangle, triangles[t]);
    EXPECT_EQ(view[t], triangles[t]);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(view.vertex(t, i), triangles[t].vertices[i]);
      EXPECT_EQ(view.corner(3 * t + i), triangles[t].vertices[i]);
    }
    ++t;
  }
  EXPECT_EQ(t, triangles.size());
}

TEST(TriangleArray, OfQuadsHasTheirHalves) {
  std::mt19937 random(1);
  Mesh mesh;
  for (int i = 0; i < 1000; ++i) mesh.quads.emplace_back(random(), random(), random(), random());
  Job job(1, {});
  const std::vector<Triangle> triangles = triangulate(mesh, job);
  expectSame(mesh.quads, triangles);
  expectSame(triangles, triangles);
  const TriangleArray halves(std::move(mesh.quads));
  EXPECT_TRUE(halves.areHalves());
  expectSame(halves, triangles);
}

TEST(TriangleArray, IsSharedByItsCopies) {
  const std::vector<Triangle> triangles = {{0, 1, 2}, {2, 1, 3}};
  TriangleArray copy;
  expectSame(copy, {});
  {
    const TriangleArray first{std::vector(triangles)};
    copy = first;
    EXPECT_TRUE(copy.shares(first));
  }
  EXPECT_FALSE(copy.areHalves());
  EXPECT_FALSE(copy.shares(std::vector(triangles)));
  expectSame(copy, triangles);
}

}  // namespace
}  // namespace tufa::base
