// The limits that docs/limits.md states.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/chunks.h>
#include <tufa/contour.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "base/require_at_most.h"
#include "support/expect_error.h"
#include "support/fields.h"
#include "support/mesh_oracle.h"

namespace tufa {
namespace {

using openvdb::FloatGrid;
using openvdb::Vec3d;
using test::expectError;

constexpr std::int32_t kLast = std::numeric_limits<std::int32_t>::max();
constexpr std::int32_t kFirst = std::numeric_limits<std::int32_t>::min();

FloatGrid::Ptr ballAround(const openvdb::Coord& centre) {
  const int reach = 10;
  const openvdb::CoordBBox box(centre.offsetBy(-reach), centre.offsetBy(reach));
  return test::levelSet<FloatGrid>(
      box, 3, [&](const openvdb::Coord& at) { return (at - centre).asVec3d().length() - 5.3; });
}

TEST(Limits, CoordinatesReachNearlyToTheEndsOf32Bits) {
  const Mesh atOrigin = contour(*ballAround(openvdb::Coord(0)));
  for (const openvdb::Coord& centre :
       {openvdb::Coord(kLast - 8192), openvdb::Coord(kFirst + 8192),
        openvdb::Coord(1 << 30, -(1 << 30), 7), openvdb::Coord(0, kLast - 8192, kFirst + 8192)}) {
    // Blocks lie elsewhere unless the shift is a whole number of the largest.
    const openvdb::Coord aligned = centre & ~4095;
    const Mesh mesh = contour(*ballAround(aligned));
    const test::MeshTopology topology = test::inspect(mesh);
    EXPECT_TRUE(topology.manifold() && topology.closed()) << centre << topology;
    EXPECT_EQ(topology.euler(), 2) << centre;
    EXPECT_EQ(mesh.quads.size(), atOrigin.quads.size()) << centre;
  }
}

TEST(Limits, CoordinatesBeyondAreRefused) {
  for (const openvdb::Coord& centre :
       {openvdb::Coord(kLast - 100), openvdb::Coord(kFirst + 100, 0, 0),
        openvdb::Coord(0, 0, kLast - 2000)}) {
    expectError(ErrorCode::LimitExceeded, "coordinates",
                [&] { (void)contour(*ballAround(centre)); });
  }
}

/// OpenVDB refuses to make such transforms, but reads them.
openvdb::math::Transform::Ptr uniformScale(double voxelSize) {
  std::stringstream bytes;
  for (const double value :
       {voxelSize, voxelSize, 1 / voxelSize, 1 / (voxelSize * voxelSize), 0.5 / voxelSize}) {
    Vec3d(value).write(bytes);
  }
  const auto map = std::make_shared<openvdb::math::UniformScaleMap>();
  map->read(bytes);
  return std::make_shared<openvdb::math::Transform>(map);
}

FloatGrid::Ptr ballOfVoxels(double voxelSize) {
  const auto ball = ballAround(openvdb::Coord(0));
  auto grid = FloatGrid::create(static_cast<float>(ball->background() * voxelSize));
  for (auto value = ball->cbeginValueAll(); value; ++value) {
    if (!value.isVoxelValue()) continue;
    const auto scaled = static_cast<float>(*value * voxelSize);
    value.isValueOn() ? grid->tree().setValueOn(value.getCoord(), scaled)
                      : grid->tree().setValueOff(value.getCoord(), scaled);
  }
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(uniformScale(voxelSize));
  return grid;
}

TEST(Limits, ScalesWithinTheRangeGiveTheSameTopology) {
  ContourOptions options;
  options.uniform = true;
  const Mesh atOne = contour(*ballAround(openvdb::Coord(0)), options);
  for (const double voxelSize : {1e-25, 1e-12, 1e-6, 1e12, 1e25}) {
    const auto grid = ballOfVoxels(voxelSize);
    EXPECT_EQ(contour(*grid, options).quads.size(), atOne.quads.size()) << voxelSize;
    std::vector<Mesh> meshes = {contour(*grid)};
    for (Lod& lod : buildLods(*grid).levels) meshes.push_back(std::move(lod.mesh));
    for (const Mesh& mesh : meshes) {
      const test::MeshTopology topology = test::inspect(mesh);
      EXPECT_TRUE(topology.manifold() && topology.closed()) << voxelSize << " " << topology;
      EXPECT_GT(test::volume(mesh), 0) << voxelSize;
    }
    ChunkOptions chunks;
    chunks.chunkSize = 8;
    const ChunkIndex index = buildChunks(*grid, chunks, [](const ChunkIndex&, Chunk&&) {});
    EXPECT_EQ(index.chunks.size(), 8u) << voxelSize;
    EXPECT_EQ(index.transform[1][1], voxelSize);
  }
}

TEST(Limits, ScalesBeyondSinglePrecisionAreRefused) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto grid = ballAround(openvdb::Coord(0));
  for (const double voxelSize :
       {1e-26, 1e-40, 1e-150, 1e-320, 0.0, 1e26, 1e150, 1e300, infinity, std::nan("")}) {
    grid->setTransform(uniformScale(voxelSize));
    expectError(ErrorCode::UnsupportedGrid, "transform", [&] { (void)contour(*grid); });
    expectError(ErrorCode::UnsupportedGrid, "transform", [&] { (void)buildLods(*grid); });
    expectError(ErrorCode::UnsupportedGrid, "transform",
                [&] { (void)buildChunks(*grid, {}, [](const ChunkIndex&, Chunk&&) {}); });
    ContourOptions options;
    options.toleranceGrid = grid;
    expectError(ErrorCode::UnsupportedGrid, "tolerance grid",
                [&] { (void)contour(*ballAround(openvdb::Coord(0)), options); });
    EXPECT_FALSE(describeGrid(*grid).meshable);
  }
}

TEST(Limits, FlatVoxelsAndFarOriginsAreRefused) {
  const auto grid = ballAround(openvdb::Coord(0));
  openvdb::Mat4d flat = openvdb::Mat4d::identity(), far = flat;
  flat.preScale(Vec3d(1e5, 1e-5, 1e5));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(flat));
  expectError(ErrorCode::UnsupportedGrid, "flat", [&] { (void)contour(*grid); });
  far.setTranslation(Vec3d(0, 0, 1e13));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(far));
  expectError(ErrorCode::UnsupportedGrid, "move it nearer", [&] { (void)contour(*grid); });
}

TEST(Limits, OfFormatsAreNamed) {
  base::requireAtMost(4294967295u, 4294967295u, "triangles", ".stl");
  expectError(ErrorCode::LimitExceeded,
              "4294967296 triangles are more than the 4294967295 that .stl",
              [] { base::requireAtMost(4294967295u, 4294967296u, "triangles", ".stl"); });
}

TEST(Limits, CellsAreAnyPowerOfTwo) {
  ContourOptions options;
  for (const int cell : {0, 3, (1 << 20) + 1}) {
    options.maxCell = cell;
    expectError(ErrorCode::InvalidArgument, "largest cell",
                [&] { (void)contour(*ballAround(openvdb::Coord(0)), options); });
  }
  const Mesh mesh = contour(*ballAround(openvdb::Coord(0)));
  options.maxCell = 1 << 30;
  EXPECT_TRUE(test::sameBytes(contour(*ballAround(openvdb::Coord(0)), options), mesh));
}

TEST(Limits, ToleranceGridsAreFloatGrids) {
  ContourOptions options;
  const auto doubles = openvdb::DoubleGrid::create(1);
  doubles->setName("detail");
  options.toleranceGrid = doubles;
  for (const char* part : {"\"detail\"", "double", "float grid"}) {
    expectError(ErrorCode::UnsupportedGrid, part,
                [&] { (void)contour(*ballAround(openvdb::Coord(0)), options); });
  }
}

/// Scaled to voxels they became infinite, and so samples of the other side: edges were collapsed
/// that were none.
template <class GridT>
void expectClosedAtValues(typename GridT::ValueType most) {
  using Value = typename GridT::ValueType;
  std::mt19937 random(1);
  const auto grid = GridT::create(Value(0));
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.2));
  auto accessor = grid->getAccessor();
  const openvdb::CoordBBox box(openvdb::Coord(-4), openvdb::Coord(4));
  for (auto at = box.begin(); at; ++at) {
    const int kind = static_cast<int>(random() % 3);
    accessor.setValue(*at, kind == 0 ? most : kind == 1 ? most / 3 : Value(1e-9));
  }
  for (const bool uniform : {true, false}) {
    ContourOptions options;
    options.uniform = uniform;
    options.isovalue = static_cast<double>(most) / 2;
    const test::MeshTopology topology = test::inspect(test::triangulated(contour(*grid, options)));
    EXPECT_TRUE(topology.manifold());
    EXPECT_EQ(topology.boundaryEdges, 0u);
  }
}

TEST(Limits, ValuesAtTheEndOfTheirTypeKeepTheirSides) {
  expectClosedAtValues<FloatGrid>(std::numeric_limits<float>::max() / 1.5F);
  expectClosedAtValues<openvdb::DoubleGrid>(1e300);
}

}  // namespace
}  // namespace tufa
