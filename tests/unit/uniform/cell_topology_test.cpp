#include "uniform/cell_topology.h"

#include <gtest/gtest.h>

#include <tufa/contour.h>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "grid/affine.h"
#include "support/fields.h"
#include "support/lattice.h"
#include "support/mesh_oracle.h"
#include "support/uniform_mesh.h"
#include "uniform/quads.h"
#include "unit/uniform/cell_oracle.h"

namespace tufa::uniform {
namespace {

using openvdb::CoordBBox;
using openvdb::FloatGrid;

constexpr std::array<Ambiguity, 4> kRules = {Ambiguity::Separate, Ambiguity::Join,
                                             Ambiguity::Asymptotic, Ambiguity::Chord};

CornerMask maskAt(const FloatGrid& grid, const openvdb::Coord& cell) {
  unsigned mask = 0;
  for (int corner = 0; corner < kCorners; ++corner) {
    const openvdb::Coord at = cell.offsetBy(corner >> 2, (corner >> 1) & 1, corner & 1);
    if (grid.tree().getValue(at) < 0) mask |= 1U << corner;
  }
  return static_cast<CornerMask>(mask);
}

// Vertices by a fixed rule, without flips: the loops of each cell.
std::size_t loopsIn(const FloatGrid& grid, const CoordBBox& cells, FaceBits joined) {
  std::size_t count = 0;
  for (auto cell = cells.begin(); cell; ++cell) {
    count += cells::partitionOf(maskAt(grid, *cell), joined, 0).size();
  }
  return count;
}

std::size_t surfaceCellsIn(const FloatGrid& grid, const CoordBBox& cells) {
  std::size_t count = 0;
  for (auto cell = cells.begin(); cell; ++cell) {
    const CornerMask mask = maskAt(grid, *cell);
    count += mask != 0 && mask != 255 ? 1 : 0;
  }
  return count;
}

// Patterns of samples inside and outside, each by the bits of a number in the order of the box,
// side by side along x: as far apart as blocks, so that each lies in its block as the box does.
struct Row {
  FloatGrid::Ptr grid = FloatGrid::create(1);
  CoordBBox box;

  Row(const CoordBBox& first, const std::vector<unsigned>& patterns, std::mt19937& random)
      : box(first) {
    std::uniform_real_distribution<double> size(0.05, 1);
    CoordBBox place = first;
    for (const unsigned pattern : patterns) {
      unsigned bit = 0;
      for (auto at = place.begin(); at; ++at) {
        const double value = size(random);
        const bool inside = ((pattern >> bit++) & 1) != 0;
        grid->tree().setValue(*at, static_cast<float>(inside ? -value : value));
      }
      box.expand(place);
      place.translate(openvdb::Coord(grid::kBlockSize, 0, 0));
    }
  }
};

void expectRowIsMeshed(const FloatGrid& grid, const CoordBBox& box, Ambiguity rule,
                       const std::string& what) {
  SCOPED_TRACE(what);
  CoordBBox cells = box;
  cells.expand(1);
  ContourOptions options;
  options.isovalue = 0;
  options.inside = Inside::Below;
  options.ambiguity = rule;
  options.threads = 1;
  ContourReport report;
  const Mesh mesh = tufa::test::uniformMesh(grid, options, &report);
  const grid::IsoChoice iso{0, true};
  ASSERT_EQ(tufa::test::edgesOf(mesh), tufa::test::crossedEdgesOf(grid.tree(), iso, cells).size());
  ASSERT_EQ(report.surfaceCells, surfaceCellsIn(grid, cells));
  ASSERT_EQ(mesh.triangles.size(), 4 * report.fannedQuads);
  if (rule == Ambiguity::Separate || rule == Ambiguity::Join) {
    // A flip splits one component of each of two cells.
    const FaceBits joined = rule == Ambiguity::Join ? 0x3f : 0;
    ASSERT_EQ(mesh.positions.size(),
              loopsIn(grid, cells, joined) + 2 * report.faceFlips + report.fannedQuads);
  }
  if (mesh.quads.empty()) return;
  const auto quads = tufa::test::inspect(mesh);
  ASSERT_TRUE(quads.closed() && quads.manifold()) << quads;
  const auto triangles = tufa::test::inspect(tufa::test::triangulated(mesh));
  ASSERT_TRUE(triangles.closed() && triangles.manifold()) << triangles;
  ASSERT_EQ(quads.euler(), triangles.euler());
}

// In the middle of a block, and across the corner where eight blocks meet.
constexpr std::array<int, 2> kPlaces = {2, -1};

// Meshes the patterns in rows of 64 by every rule.
void expectPatternsAreMeshed(const CoordBBox& box, const std::vector<unsigned>& patterns,
                             std::mt19937& random) {
  constexpr std::size_t kRow = 64;
  for (std::size_t first = 0; first < patterns.size(); first += kRow) {
    const std::size_t last = std::min(first + kRow, patterns.size());
    const Row row(box,
                  {patterns.begin() + static_cast<std::ptrdiff_t>(first),
                   patterns.begin() + static_cast<std::ptrdiff_t>(last)},
                  random);
    for (const Ambiguity rule : kRules) {
      expectRowIsMeshed(*row.grid, row.box, rule,
                        "patterns from " + std::to_string(patterns[first]) + " rule " +
                            std::to_string(static_cast<int>(rule)));
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(CellTopology, EveryCornerMaskGivesAClosedManifold) {
  std::mt19937 random(1);
  std::vector<unsigned> patterns(256);
  std::iota(patterns.begin(), patterns.end(), 0U);
  for (const int place : kPlaces) {
    expectPatternsAreMeshed(CoordBBox(openvdb::Coord(place), openvdb::Coord(place + 1)), patterns,
                            random);
  }
}

// Patterns of the twelve samples of two cells whose common face, across `axis`, is ambiguous.
std::vector<unsigned> ambiguousPatterns(const CoordBBox& box, int axis) {
  std::vector<unsigned> patterns;
  for (unsigned pattern = 0; pattern < 4096; ++pattern) {
    // The four samples of the middle face, in the order of the box.
    std::vector<bool> middle;
    unsigned bit = 0;
    for (auto at = box.begin(); at; ++at, ++bit) {
      if ((*at)[axis] == box.min()[axis] + 1) middle.push_back(((pattern >> bit) & 1) != 0);
    }
    if (middle[0] == middle[3] && middle[1] == middle[2] && middle[0] != middle[1]) {
      patterns.push_back(pattern);
    }
  }
  return patterns;
}

TEST(CellTopology, EveryPairOfCellsAcrossAnAmbiguousFaceGivesAClosedManifold) {
  std::mt19937 random(2);
  for (int axis = 0; axis < 3; ++axis) {
    for (const int place : kPlaces) {
      openvdb::Coord last(place + 1);
      ++last[axis];
      const CoordBBox box(openvdb::Coord(place), last);
      const std::vector<unsigned> patterns = ambiguousPatterns(box, axis);
      ASSERT_EQ(patterns.size(), 512U);
      expectPatternsAreMeshed(box, patterns, random);
    }
  }
}

// The stages up to the topology, with an isovalue of 0 and inside below.
struct Stages {
  base::Job job{1, {}};
  grid::FieldScale scale;
  grid::Blocks blocks;
  CellTopology topology;

  Stages(const FloatGrid& grid, grid::FieldScale fieldScale, Ambiguity rule, bool cap)
      : scale(fieldScale),
        blocks(grid::treeOf(grid, job), {0, true}, NonFinite::Refuse, job),
        topology(buildCellTopology(blocks, scale, rule, cap, job)) {}

  // The faces, with all vertices at one place.
  Mesh faces(const FloatGrid& grid) {
    Mesh mesh;
    mesh.positions.assign(topology.vertexCount, Position(0, 0, 0));
    const grid::Affine affine(grid::transformOf(grid));
    const VertexSheets sheets(topology.vertexCount);
    connectQuads({blocks, scale, affine, topology, sheets, mesh}, mesh, job);
    return mesh;
  }
};

TEST(CellTopology, NumbersOfVerticesAndQuadsAddUp) {
  const auto grid = tufa::test::noise<FloatGrid>({.size = 20, .seed = 4});
  const Stages stages(*grid, {}, Ambiguity::Separate, false);
  const CellTopology& topology = stages.topology;
  std::uint64_t vertices = 0, quads = 0;
  for (const SurfaceBlock& block : topology.blocks) {
    EXPECT_EQ(block.firstVertex, vertices);
    EXPECT_EQ(block.firstQuad, quads);
    const grid::CornerWords corners = stages.blocks.cornerWords(block.neighbours);
    for (int cell = 0; cell < grid::kBlockCells; ++cell) {
      if (!block.cells.get(cell)) continue;
      ASSERT_EQ(topology.firstVertexInBlock(block, cell), vertices - block.firstVertex);
      vertices += static_cast<std::uint64_t>(
          topology.componentsAt(block, cell, cornerMask(corners, cell)).count());
    }
    quads += block.quadCount;
  }
  EXPECT_EQ(topology.vertexCount, vertices);
  EXPECT_EQ(topology.quadCount, quads);
}

TEST(CellTopology, OnlyInactiveSamplesFarApartCutTheSurface) {
  // A plane at x = 0.5; behind y = 3 nothing is active, and the jump is of two voxels.
  const CoordBBox box(openvdb::Coord(-4), openvdb::Coord(5, 3, 5));
  auto grid = tufa::test::levelSet<FloatGrid>(
      box, 3, [](const openvdb::Coord& at) { return at.x() - 0.5; });
  for (auto at = CoordBBox(openvdb::Coord(-4, 4, -4), openvdb::Coord(0, 6, 5)).begin(); at; ++at) {
    grid->tree().setValueOff(*at, -3);
  }
  grid::FieldScale scale;
  scale.distance = scale.narrowBand = true;
  const Stages open(*grid, scale, Ambiguity::Separate, false);
  EXPECT_GT(open.topology.openEdges, 0U);
  const Stages capped(*grid, scale, Ambiguity::Separate, true);
  EXPECT_EQ(capped.topology.openEdges, 0U);
  EXPECT_EQ(capped.topology.quadCount, open.topology.quadCount + open.topology.openEdges);
}

TEST(CellTopology, RandomCutsLeaveAManifoldWithBoundary) {
  grid::FieldScale scale;
  scale.factor = 3;
  scale.distance = scale.narrowBand = true;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    for (const Ambiguity rule : kRules) {
      // Half of the noise inactive in some grids, a tenth in others.
      const auto grid = tufa::test::noise<FloatGrid>({.size = 24, .seed = seed});
      std::mt19937 random(seed);
      for (auto value = grid->beginValueOn(); value; ++value) {
        if (random() % (seed % 2 == 0 ? 2 : 10) == 0) value.setActiveState(false);
      }
      Stages stages(*grid, scale, rule, false);
      ASSERT_GT(stages.topology.openEdges, 0U);
      const auto found = tufa::test::inspect(stages.faces(*grid));
      EXPECT_GT(found.boundaryEdges, 0U);
      EXPECT_TRUE(found.manifold())
          << "seed " << seed << " rule " << static_cast<int>(rule) << ": " << found;
    }
  }
}

}  // namespace
}  // namespace tufa::uniform
