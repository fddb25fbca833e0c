// Strips between the vertices of a chunk and those on its face.

#include "chunks/seams/stitch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace tufa::chunks {
namespace {

/// The seam of a ring or an arch of `arcs` arcs, the line on the outside, with its vertices.
struct Strip {
  std::vector<Position> positions;
  std::vector<Normal> normals;
  ChunkSeam seam;

  VertexIndex add(double radius, double arc, double arcs) {
    const double angle = std::numbers::pi * 2 * arc / arcs;
    positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    normals.emplace_back(0.0f, 0.0f, 1.0f);
    return static_cast<VertexIndex>(positions.size() - 1);
  }

  /// `fresh` says of each arc whether it starts a new vertex, on the chunk's side and on the line.
  Strip(int arcs, bool closed, const std::vector<bool>& freshTile,
        const std::vector<bool>& freshLine) {
    const double all = closed ? arcs : 3 * arcs;
    seam.closed = closed;
    if (!closed) seam.begin = add(2, -1, all);
    const auto fill = [&](double radius, const std::vector<bool>& fresh,
                          std::vector<VertexIndex>& side) {
      for (int i = 0; i < arcs; ++i) {
        const bool first = i == 0 ? !closed || fresh[0] : fresh[i];
        side.push_back(first || side.empty() ? add(radius, i, all) : side.back());
      }
      // Around a ring the last vertex may go on where the first one was begun.
      if (closed && !fresh[0]) {
        const VertexIndex from = side.front(), to = side.back();
        for (VertexIndex& vertex : side) vertex = vertex == from ? to : vertex;
      }
    };
    fill(1, freshTile, seam.tiles);
    fill(2, freshLine, seam.polyline);
    if (!closed) seam.end = add(2, arcs, all);
  }
};

/// Whether no two vertices have more than one stretch of arcs in common, as is so of chunks.
bool haveSingleStretches(const ChunkSeam& seam) {
  std::map<std::pair<VertexIndex, VertexIndex>, int> stretches;
  const std::size_t count = seam.tiles.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t before = (i + count - 1) % count;
    const bool goesOn = (i > 0 || seam.closed) && seam.tiles[i] == seam.tiles[before] &&
                        seam.polyline[i] == seam.polyline[before];
    if (!goesOn && ++stretches[{seam.tiles[i], seam.polyline[i]}] > 1) return false;
  }
  return true;
}

std::size_t distinct(std::vector<VertexIndex> side) {
  std::sort(side.begin(), side.end());
  return static_cast<std::size_t>(std::unique(side.begin(), side.end()) - side.begin());
}

/// Each edge of the strip's two sides has one triangle, each across it two, but for its ends.
void expectWhole(const Strip& strip, const std::vector<StripTriangle>& triangles) {
  std::map<std::pair<VertexIndex, VertexIndex>, int> edges;
  for (const StripTriangle& t : triangles) {
    const auto& v = t.triangle.vertices;
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ((++edges[{v[i], v[(i + 1) % 3]}]), 1) << "an edge twice in one direction";
    }
  }
  std::map<std::pair<VertexIndex, VertexIndex>, int> outer;
  const auto addSide = [&](std::vector<VertexIndex> side, bool reversed) {
    if (strip.seam.closed) side.push_back(side.front());
    if (reversed) std::reverse(side.begin(), side.end());
    for (std::size_t i = 1; i < side.size(); ++i) {
      if (side[i - 1] != side[i]) ++outer[{side[i - 1], side[i]}];
    }
  };
  std::vector<VertexIndex> line = strip.seam.polyline;
  if (!strip.seam.closed) {
    line.insert(line.begin(), strip.seam.begin);
    line.push_back(strip.seam.end);
    ++outer[{strip.seam.begin, strip.seam.tiles.front()}];
    ++outer[{strip.seam.tiles.back(), strip.seam.end}];
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : edges) {
    if (!edges.contains({edge.second, edge.first})) ++open;
  }
  addSide(line, false);
  addSide(strip.seam.tiles, true);
  std::size_t expected = 0;
  for (const auto& [edge, count] : outer) {
    EXPECT_EQ(count, 1);
    // A loop of two vertices goes there and back.
    if (!outer.contains({edge.second, edge.first})) ++expected;
  }
  EXPECT_EQ(open, expected);
}

TEST(Stitch, UsesNoEdgeTwiceHoweverFewVerticesThereAre) {
  std::mt19937 random(7);
  int tried = 0;
  for (int round = 0; round < 4000; ++round) {
    const bool closed = round % 2 == 0;
    const int arcs = 3 + static_cast<int>(random() % 8);
    std::vector<bool> tile(static_cast<std::size_t>(arcs)), line(tile.size());
    for (std::size_t i = 0; i < tile.size(); ++i) {
      tile[i] = random() % 3 == 0;
      line[i] = random() % 2 == 0;
    }
    Strip strip(arcs, closed, tile, line);
    if (closed && distinct(strip.seam.polyline) < 3) continue;
    if (!haveSingleStretches(strip.seam)) continue;
    ++tried;
    // Shaken, so that all ways are taken.
    std::uniform_real_distribution<double> shift(-0.7, 0.7);
    for (Position& p : strip.positions) p = {p.x + shift(random), p.y + shift(random), 0};
    for (const bool several : {false, true}) {
      expectWhole(strip, stitch(strip.seam, several, strip.positions, strip.normals));
    }
    if (::testing::Test::HasFailure()) FAIL() << "round " << round;
  }
  EXPECT_GT(tried, 1000);
}

}  // namespace
}  // namespace tufa::chunks
