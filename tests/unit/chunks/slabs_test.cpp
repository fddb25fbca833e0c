// Slabs of chunks: where a volume is divided, what is cut out of a mesh, and how slabs are joined.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "chunks/cut/cut_mesh.h"
#include "chunks/slabs/cut_slab.h"
#include "chunks/slabs/join_slabs.h"
#include "chunks/slabs/reduce_slabs.h"
#include "chunks/slabs/split_into_slabs.h"
#include "chunks/slabs/sub_mesh.h"
#include "support/mesh_oracle.h"
#include "support/model.h"
#include "support/print.h"
#include "support/shape.h"

namespace tufa::chunks {
namespace {

constexpr int kRow = 16;

// A tilted torus of 66 voxels, which reaches beyond the origin on all sides.
struct Torus {
  test::ModelOf model{test::shapeOf(Shape::Torus, 0.04)};
  CutMesh mesh = cutAtChunks(model.mesh(), model.model().affine(), kRow, true, 0, model.job());

  Torus() { mesh.errors.assign(mesh.chunks.size(), 0); }
};

std::vector<grid::Slab> split(Torus& cut, std::size_t voxels, int thickness) {
  return splitIntoSlabs(cut.model.model().surface().volume.blocks, kRow, voxels, thickness,
                        cut.model.job());
}

TEST(Slabs, CoverAllChunksOneAfterAnother) {
  Torus cut;
  EXPECT_EQ(split(cut, 1'000'000'000, 8).size(), 1U);
  const std::vector<grid::Slab> slabs = split(cut, 1, 8), thick = split(cut, 1, 32);
  EXPECT_GE(slabs.size(), 3U);
  EXPECT_LT(thick.size(), slabs.size());
  for (const auto& some : {slabs, thick}) {
    for (std::size_t i = 0; i < some.size(); ++i) {
      EXPECT_LE(some[i].first, some[i].last);
      if (i > 0) {
        EXPECT_EQ(some[i].first, some[i - 1].last + 1);
        EXPECT_EQ(some[i].axis, some[0].axis);
      }
    }
    for (const Coord& chunk : cut.mesh.chunks) {
      EXPECT_EQ(std::count_if(some.begin(), some.end(),
                              [&](const grid::Slab& slab) { return slab.contains(chunk); }),
                1)
          << chunk;
    }
  }
  for (const grid::Slab& slab : thick) EXPECT_GE((slab.last + 1 - slab.first) * kRow, 32);
  const grid::Slab inner = samplesOf(slabs[1], slabs, kRow, 24);
  EXPECT_EQ(inner.first, slabs[1].first * kRow - 24);
  EXPECT_EQ(inner.last, (slabs[1].last + 1) * kRow - 1 + 24);
  EXPECT_LT(samplesOf(slabs[0], slabs, kRow, 24).first, -1000);
}

TEST(Slabs, AreWhatTheyWereOnceTheyAreJoined) {
  Torus cut;
  std::vector<CutSlab> slabs;
  std::size_t triangles = 0, borders = 0;
  for (const grid::Slab& slab : split(cut, 1, 8)) {
    slabs.push_back(takeSlab(cut.mesh, slab, cut.model.job()));
    const CutSlab& made = slabs.back();
    triangles += made.cut.mesh.triangles.size();
    for (const ChunkPlane& plane :
         {ChunkPlane{slab.axis, slab.first}, ChunkPlane{slab.axis, slab.last + 1}}) {
      for (const auto& planes : made.cut.planesOf) {
        for (const std::uint32_t p : planes) {
          EXPECT_FALSE(p != ChunkPlane::kNone && made.cut.planes[p] == plane);
        }
      }
    }
    if (slabs.size() < 2) continue;
    const SlabBorder& below = slabs[slabs.size() - 2].upper;
    EXPECT_TRUE(fit(below, made.lower));
    if (below.edges.size() < 10) continue;
    ++borders;
    EXPECT_FALSE(fit(below, made.upper));
    SlabBorder moved = made.lower;
    moved.vertices[3].at[1] += 1e-12;
    EXPECT_FALSE(fit(below, moved));
    moved = made.lower;
    std::swap(moved.edges[2][0], moved.edges[2][1]);
    EXPECT_FALSE(fit(below, moved));
  }
  EXPECT_EQ(triangles, cut.mesh.mesh.triangles.size());
  EXPECT_GE(borders, 3U);
  const CutMesh joined = joinSlabs(std::move(slabs), cut.model.job());
  const test::MeshTopology found = test::inspect(joined.mesh),
                           before = test::inspect(cut.mesh.mesh);
  EXPECT_TRUE(found.closed() && found.manifold()) << found;
  EXPECT_EQ(found.euler(), before.euler());
  EXPECT_EQ(joined.mesh.positions.size(), cut.mesh.mesh.positions.size());
  EXPECT_EQ(joined.chunks, cut.mesh.chunks);
  EXPECT_EQ(joined.onPlanes.size(), cut.mesh.onPlanes.size());
  EXPECT_TRUE(std::is_sorted(joined.onPlanes.begin(), joined.onPlanes.end()));
  const auto planesAt = [](const CutMesh& mesh) {
    std::vector<std::pair<std::array<double, 3>, std::vector<std::pair<int, int>>>> all;
    for (std::size_t i = 0; i < mesh.onPlanes.size(); ++i) {
      const Position& p = mesh.mesh.positions[mesh.onPlanes[i]];
      all.push_back({{p.x, p.y, p.z}, {}});
      for (const std::uint32_t plane : mesh.planesOf[i]) {
        if (plane == ChunkPlane::kNone) continue;
        all.back().second.emplace_back(mesh.planes[plane].axis, mesh.planes[plane].at);
      }
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(planesAt(joined), planesAt(cut.mesh));
}

// Between two slabs with a gap borders are in different planes.
TEST(Slabs, ThatDoNotFitAreMadeAgainAsOne) {
  Torus cut;
  const grid::Volume& volume = cut.model.model().surface().volume;
  const grid::Slab all{0, -3, 2}, low{0, -3, -2}, high{0, 0, 2};
  for (const Coord& chunk : cut.mesh.chunks) ASSERT_TRUE(all.contains(chunk)) << chunk;
  CutOptions options;
  options.contour.normals = Normals::Gradient;
  options.chunkSize = kRow;
  const auto reduced = [&](std::vector<grid::Slab> slabs) {
    ContourReport report;
    return reduceSlabs(volume, std::move(slabs), cut.model.rule(), options, {}, 1, report,
                       cut.model.job());
  };
  const CutMesh whole = reduced({all}), joined = reduced({low, high});
  EXPECT_EQ(joined.mesh.positions, whole.mesh.positions);
  EXPECT_EQ(joined.mesh.triangles, whole.mesh.triangles);
  EXPECT_EQ(joined.errors, whole.errors);
  const grid::Slab rest{0, -1, 2};
  const CutMesh parted = reduced({low, rest});
  EXPECT_NE(parted.mesh.positions, whole.mesh.positions);
  for (const CutMesh* mesh : {&whole, &parted}) {
    const test::MeshTopology found = test::inspect(mesh->mesh);
    EXPECT_TRUE(found.closed() && found.manifold()) << found;
    EXPECT_EQ(found.euler(), 0);
    for (const double error : mesh->errors) EXPECT_LE(error, cut.model.rule().tolerance);
  }
}

TEST(SubMesh, HasTheTrianglesAskedFor) {
  Torus cut;
  std::vector<std::uint8_t> wanted(cut.mesh.mesh.triangles.size());
  for (std::size_t t = 100; t < 600; ++t) wanted[t] = t % 3 != 0 ? 1 : 0;
  const SubMesh sub = subMesh(cut.mesh, wanted, cut.model.job());
  ASSERT_EQ(sub.triangles.size(), sub.cut.mesh.triangles.size());
  EXPECT_EQ(sub.triangles.size(), 334U);
  for (std::size_t i = 0; i < sub.triangles.size(); ++i) {
    EXPECT_EQ(wanted[sub.triangles[i]], 1);
    EXPECT_EQ(sub.cut.chunkOf[i], cut.mesh.chunkOf[sub.triangles[i]]);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const VertexIndex own = sub.cut.mesh.triangles[i].vertices[corner];
      const VertexIndex v = cut.mesh.mesh.triangles[sub.triangles[i]].vertices[corner];
      EXPECT_EQ(sub.vertices[own], v);
      EXPECT_EQ(sub.cut.mesh.positions[own], cut.mesh.mesh.positions[v]);
      EXPECT_EQ(sub.cut.planesAt(own), cut.mesh.planesAt(v));
    }
  }
}

// Of marks made by chance most vertices have several fans.
TEST(SubMesh, IsMadeManifold) {
  Torus cut;
  const std::size_t count = cut.mesh.mesh.triangles.size();
  std::mt19937 random(3);
  std::vector<std::uint8_t> marks(count);
  for (std::uint8_t& mark : marks) mark = random() % 20 != 0 ? 1 : 0;
  const std::vector<std::uint8_t> before = marks;
  const auto topologyOf = [&] {
    return test::inspect(subMesh(cut.mesh, marks, cut.model.job()).cut.mesh);
  };
  EXPECT_GT(topologyOf().nonManifoldVertices, 10U);
  keepManifold(cut.mesh, marks, cut.model.job());
  EXPECT_EQ(topologyOf().nonManifoldVertices, 0U);
  EXPECT_GT(std::count(marks.begin(), marks.end(), 1), static_cast<std::ptrdiff_t>(count / 10));
  for (std::size_t t = 0; t < count; ++t) EXPECT_LE(marks[t], before[t]);
  marks.assign(count, 1);
  keepManifold(cut.mesh, marks, cut.model.job());
  EXPECT_EQ(std::count(marks.begin(), marks.end(), 1), static_cast<std::ptrdiff_t>(count));
}

}  // namespace
}  // namespace tufa::chunks
