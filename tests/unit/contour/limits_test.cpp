// The limits that docs/limits.md states.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/contour.h>
#include <limits>

#include "io/mesh/mesh_format.h"
#include "support/expect_error.h"
#include "support/fields.h"
#include "support/mesh_oracle.h"

namespace tufa {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using test::expectError;

constexpr std::int32_t kLast = std::numeric_limits<std::int32_t>::max();
constexpr std::int32_t kFirst = std::numeric_limits<std::int32_t>::min();

FloatGrid::Ptr ballAround(const Coord& centre) {
  const int reach = 10;
  const openvdb::CoordBBox box(centre.offsetBy(-reach), centre.offsetBy(reach));
  return test::levelSet<FloatGrid>(
      box, 3, [&](const Coord& at) { return (at - centre).asVec3d().length() - 5.3; });
}

TEST(Limits, CoordinatesReachNearlyToTheEndsOf32Bits) {
  const Mesh atOrigin = contour(*ballAround(Coord(0)));
  for (const Coord& centre :
       {Coord(kLast - 8192), Coord(kFirst + 8192), Coord(1 << 30, -(1 << 30), 7),
        Coord(0, kLast - 8192, kFirst + 8192)}) {
    // Blocks lie elsewhere unless the shift is a whole number of the largest.
    const Coord aligned = centre & ~4095;
    const Mesh mesh = contour(*ballAround(aligned));
    const test::MeshTopology topology = test::inspect(mesh);
    EXPECT_TRUE(topology.manifold() && topology.closed()) << centre << topology;
    EXPECT_EQ(topology.euler(), 2) << centre;
    EXPECT_EQ(mesh.quads.size(), atOrigin.quads.size()) << centre;
  }
}

TEST(Limits, CoordinatesBeyondAreRefused) {
  for (const Coord& centre :
       {Coord(kLast - 100), Coord(kFirst + 100, 0, 0), Coord(0, 0, kLast - 2000)}) {
    expectError(ErrorCode::LimitExceeded, "coordinates",
                [&] { (void)contour(*ballAround(centre)); });
  }
}

TEST(Limits, OfFormatsAreNamed) {
  io::requireAtMost(4294967295u, 4294967295u, "triangles", ".stl");
  expectError(ErrorCode::LimitExceeded,
              "4294967296 triangles are more than the 4294967295 that .stl",
              [] { io::requireAtMost(4294967295u, 4294967296u, "triangles", ".stl"); });
}

TEST(Limits, CellsAreAnyPowerOfTwo) {
  ContourOptions options;
  for (const int cell : {0, 3, (1 << 20) + 1}) {
    options.maxCell = cell;
    expectError(ErrorCode::InvalidArgument, "largest cell",
                [&] { (void)contour(*ballAround(Coord(0)), options); });
  }
  const Mesh mesh = contour(*ballAround(Coord(0)));
  options.maxCell = 1 << 30;
  EXPECT_TRUE(test::sameBytes(contour(*ballAround(Coord(0)), options), mesh));
}

TEST(Limits, ToleranceGridsAreFloatGrids) {
  ContourOptions options;
  const auto doubles = openvdb::DoubleGrid::create(1);
  doubles->setName("detail");
  options.toleranceGrid = doubles;
  for (const char* part : {"\"detail\"", "double", "float grid"}) {
    expectError(ErrorCode::UnsupportedGrid, part,
                [&] { (void)contour(*ballAround(Coord(0)), options); });
  }
}

}  // namespace
}  // namespace tufa
