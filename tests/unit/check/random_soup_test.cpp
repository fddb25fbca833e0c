#include <gtest/gtest.h>

#include <tufa/check.h>
#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "unit/check/meshes.h"

namespace tufa {
namespace {

using Edge = std::pair<VertexIndex, VertexIndex>;

/// The definitions of CheckReport, written down as plainly as possible.
struct PlainCounts {
  std::size_t boundaryEdges = 0;
  std::size_t nonManifoldEdges = 0;
  std::size_t misorientedEdges = 0;
  std::size_t nonManifoldVertices = 0;
  std::size_t duplicateFaces = 0;
  std::size_t pieces = 0;
  long long eulerCharacteristic = 0;
};

/// A vertex is fine if from one of its faces all others are reached over edges of two faces, and
/// no edge at it has more.
bool isFan(const std::vector<std::array<VertexIndex, 2>>& opposites) {
  std::map<VertexIndex, std::size_t> uses;
  for (const auto& edge : opposites) {
    for (const VertexIndex v : edge) {
      if (++uses[v] > 2) return false;
    }
  }
  std::vector<bool> reached(opposites.size());
  reached[0] = true;
  for (std::size_t round = 0; round < opposites.size(); ++round) {
    for (std::size_t i = 0; i < opposites.size(); ++i) {
      for (std::size_t j = 0; j < opposites.size(); ++j) {
        const auto& a = opposites[i];
        const auto& b = opposites[j];
        const bool meet = a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
        if (reached[i] && meet) reached[j] = true;
      }
    }
  }
  return std::all_of(reached.begin(), reached.end(), [](bool r) { return r; });
}

PlainCounts countPlainly(const std::vector<Triangle>& faces) {
  PlainCounts counts;
  std::map<Edge, std::array<std::size_t, 2>> edges;
  std::map<VertexIndex, std::vector<std::array<VertexIndex, 2>>> stars;
  std::set<std::array<VertexIndex, 3>> known;
  std::map<VertexIndex, VertexIndex> pieceOf;
  for (const Triangle& face : faces) {
    auto v = face.vertices;
    for (int i = 0; i < 3; ++i) {
      const VertexIndex a = v[i];
      const VertexIndex b = v[(i + 1) % 3];
      ++edges[std::minmax(a, b)][a < b ? 0 : 1];
      stars[a].push_back({b, v[(i + 2) % 3]});
      pieceOf.emplace(a, a);
    }
    const std::array<VertexIndex, 3> pieces{pieceOf[v[0]], pieceOf[v[1]], pieceOf[v[2]]};
    for (auto& [vertex, piece] : pieceOf) {
      if (piece == pieces[1] || piece == pieces[2]) piece = pieces[0];
    }
    std::sort(v.begin(), v.end());
    if (!known.insert(v).second) ++counts.duplicateFaces;
  }
  for (const auto& [edge, uses] : edges) {
    const std::size_t total = uses[0] + uses[1];
    if (total == 1) ++counts.boundaryEdges;
    if (total > 2) ++counts.nonManifoldEdges;
    if (total == 2 && uses[0] != 1) ++counts.misorientedEdges;
  }
  for (const auto& [vertex, star] : stars) counts.nonManifoldVertices += isFan(star) ? 0 : 1;
  std::set<VertexIndex> pieces;
  for (const auto& [vertex, piece] : pieceOf) pieces.insert(piece);
  counts.pieces = pieces.size();
  counts.eulerCharacteristic =
      static_cast<long long>(stars.size() + faces.size()) - static_cast<long long>(edges.size());
  return counts;
}

TEST(CheckRandomSoup, CountsAreThoseOfThePlainDefinitions) {
  std::mt19937 random(1);
  for (int run = 0; run < 400; ++run) {
    Mesh mesh;
    const int vertices = 4 + run % 29;
    std::uniform_real_distribution<double> coordinate(0, 1);
    for (int i = 0; i < vertices; ++i) {
      mesh.positions.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    }
    std::vector<VertexIndex> indices(mesh.positions.size());
    for (VertexIndex i = 0; i < indices.size(); ++i) indices[i] = i;
    for (int i = 0; i < 2 + run % 37; ++i) {
      std::shuffle(indices.begin(), indices.end(), random);
      mesh.triangles.emplace_back(indices[0], indices[1], indices[2]);
    }
    const PlainCounts plain = countPlainly(mesh.triangles);
    CheckOptions options;
    options.selfIntersections = false;
    const CheckReport report = check(mesh, options);
    EXPECT_EQ(report.boundaryEdges, plain.boundaryEdges);
    EXPECT_EQ(report.nonManifoldEdges, plain.nonManifoldEdges);
    EXPECT_EQ(report.misorientedEdges, plain.misorientedEdges);
    EXPECT_EQ(report.nonManifoldVertices, plain.nonManifoldVertices);
    EXPECT_EQ(report.duplicateFaces, plain.duplicateFaces);
    EXPECT_EQ(report.components.size(), plain.pieces);
    EXPECT_EQ(report.eulerCharacteristic, plain.eulerCharacteristic);
  }
}

TEST(CheckRandomSoup, LargeTorusIsFaultless) {
  const CheckReport report = check(test::torus(100, 30, 700, 350));
  EXPECT_EQ(report.triangles, 490000U);
  EXPECT_TRUE(report.watertight());
  EXPECT_TRUE(report.boundsVolume);
  EXPECT_EQ(report.selfIntersectingPairs, 0U);
  EXPECT_EQ(report.components[0].genus, 1);
  const double pi = std::numbers::pi;
  EXPECT_NEAR(report.volume / (2 * pi * pi * 100 * 30 * 30), 1, 1e-3);
  EXPECT_NEAR(report.area / (4 * pi * pi * 100 * 30), 1, 1e-3);
}

}  // namespace
}  // namespace tufa
