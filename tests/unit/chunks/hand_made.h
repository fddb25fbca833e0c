#pragma once

#include <tufa/chunks.h>
#include <algorithm>
#include <array>
#include <vector>

namespace tufa::test {

// Chunks made by hand, small enough to see that they are right. Chunks have 8 voxels.

/// Where the surface passes a face, in arcs: for each the vertex inside the chunk and the one on
/// the face that stand for it.
struct HandSeam {
  static constexpr VertexIndex kNone = ~VertexIndex{0};
  std::vector<VertexIndex> tiles, polyline;
  VertexIndex begin = kNone, end = kNone;  ///< on a chunk edge, before and behind the arcs
  bool closed = false;

  /// Its vertices on the face, as they run around the triangles of the strip. `next`: what stands
  /// for each arc on the face at the next level.
  [[nodiscard]] ChunkSeam curve(const ChunkLevel& level,
                                const std::vector<VertexIndex>& next) const {
    std::vector<VertexIndex> own = polyline, later = next;
    for (std::vector<VertexIndex>* line : {&own, &later}) {
      if (begin != kNone) line->insert(line->begin(), begin);
      if (end != kNone) line->push_back(end);
    }
    ChunkSeam seam;
    seam.closed = closed;
    for (std::size_t i = own.size(); i-- > 0;) {
      if (i > 0 && own[i] == own[i - 1]) continue;
      seam.vertices.push_back(own[i]);
      seam.next.push_back(level.positions[later[i]]);
    }
    return seam;
  }
};

/// Adds vertices and strips to a level.
class LevelMaker {
 public:
  explicit LevelMaker(ChunkLevel& level) : level_(level) {}

  VertexIndex add(double x, double y, double z) {
    level_.positions.emplace_back(x, y, z);
    level_.normals.emplace_back(0.0f, 0.0f, 1.0f);
    return static_cast<VertexIndex>(level_.positions.size() - 1);
  }

  void addTriangle(VertexIndex a, VertexIndex b, VertexIndex c, std::vector<Triangle>& out) {
    if (a != b && b != c && c != a) out.emplace_back(a, b, c);
  }

  /// The strip between the tiles of a seam and a line, its quads cut from the line to the tiles.
  void addStrip(const HandSeam& seam, const std::vector<VertexIndex>& line,
                std::vector<Triangle>& out) {
    const std::size_t arcs = seam.tiles.size();
    for (std::size_t i = 0; i + (seam.closed ? 0 : 1) < arcs; ++i) {
      const std::size_t next = (i + 1) % arcs;
      addTriangle(line[i], seam.tiles[i], seam.tiles[next], out);
      addTriangle(line[i], seam.tiles[next], line[next], out);
    }
    if (seam.begin != HandSeam::kNone) addTriangle(seam.begin, seam.tiles[0], line[0], out);
    if (seam.end != HandSeam::kNone) {
      addTriangle(line[arcs - 1], seam.tiles[arcs - 1], seam.end, out);
    }
  }

 private:
  ChunkLevel& level_;
};

/// A drum around the x axis, cut across its middle by the face between chunks (0, 0, 0) and
/// (1, 0, 0): a closed surface, the seam a loop of 12 arcs. Three levels.
inline std::vector<Chunk> makeDrum() {
  constexpr int kArcs = 12;
  // Corners of a polygon with 12 sides, counter-clockwise seen from +x; whole numbers.
  constexpr std::array<std::array<int, 2>, kArcs> kRing{{{3, 1},
                                                         {3, 2},
                                                         {2, 3},
                                                         {1, 4},
                                                         {-1, 4},
                                                         {-2, 3},
                                                         {-3, 1},
                                                         {-3, -1},
                                                         {-2, -3},
                                                         {-1, -4},
                                                         {1, -4},
                                                         {2, -3}}};
  constexpr std::array<int, 3> kTileArcs{1, 2, 4};  // arcs that share a tile
  constexpr std::array<int, 3> kLineArcs{1, 2, 4};
  std::vector<Chunk> chunks(2);
  for (int side = 0; side < 2; ++side) {
    Chunk& chunk = chunks[static_cast<std::size_t>(side)];
    chunk.index = Coord(side, 0, 0);
    chunk.levels.resize(3);
    const double direction = side == 0 ? -1 : 1;
    const auto face = static_cast<std::size_t>(side == 0 ? 1 : 0);
    for (std::size_t k = 0; k < 3; ++k) {
      ChunkLevel& level = chunk.levels[k];
      LevelMaker maker(level);
      const auto ring = [&](double x, int every, int corner) {
        const auto& [y, z] = kRing[static_cast<std::size_t>(corner / every * every)];
        return maker.add(x, 4 + y * 0.5, 4 + z * 0.5);
      };
      const auto seamOf = [&](double x, int every) {
        std::vector<VertexIndex> vertices(kArcs);
        for (int arc = 0; arc < kArcs; ++arc) {
          const auto place = static_cast<std::size_t>(arc);
          vertices[place] = arc % every == 0 ? ring(x, every, arc) : vertices[place - 1];
        }
        // Seen from the other side the ring runs the other way around.
        if (side == 1) std::reverse(vertices.begin(), vertices.end());
        return vertices;
      };
      HandSeam seam;
      seam.closed = true;
      seam.tiles = seamOf(8 + direction, kTileArcs[k]);
      seam.polyline = seamOf(8, kLineArcs[k]);
      const VertexIndex tip = maker.add(8 + 4 * direction, 4, 4);
      for (int arc = 0; arc < kArcs; ++arc) {
        const auto i = static_cast<std::size_t>(arc), next = static_cast<std::size_t>(arc + 1) % 12;
        maker.addTriangle(tip, seam.tiles[next], seam.tiles[i], level.interior);
      }
      maker.addStrip(seam, seam.polyline, level.regular[face]);
      const std::vector<VertexIndex> next = k < 2 ? seamOf(8, kLineArcs[k + 1]) : seam.polyline;
      if (k < 2) maker.addStrip(seam, next, level.transition[face]);
      level.seams[face].push_back(seam.curve(level, next));
    }
  }
  return chunks;
}

/// A flat sheet at z = 4 over the four chunks around the chunk edge x = y = 8, open at its rim: an
/// edge point in the middle, and four open seams of 6 arcs that begin or end there. Three levels.
inline std::vector<Chunk> makeSheet() {
  constexpr std::size_t kArcs = 6;
  // Counted from the edge point outward.
  const std::array<std::array<int, kArcs>, 3> tileGroups{
      {{0, 1, 2, 3, 4, 5}, {0, 0, 0, 3, 3, 3}, {0, 0, 0, 0, 0, 0}}};
  const std::array<std::array<int, kArcs>, 3> lineGroups{
      {{0, 1, 2, 3, 4, 5}, {0, 0, 2, 2, 4, 4}, {0, 0, 0, 0, 0, 0}}};
  // The chunk at the origin, turned about the edge by quarters.
  constexpr std::array<std::array<int, 2>, 4> kIndices{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  constexpr std::array<std::size_t, 4> kTurned{1, 3, 0, 2};  // +x, +y, -x, -y
  std::vector<Chunk> chunks(4);
  for (std::size_t turn = 0; turn < 4; ++turn) {
    Chunk& chunk = chunks[turn];
    chunk.index = Coord(kIndices[turn][0], kIndices[turn][1], 0);
    chunk.levels.resize(3);
    for (std::size_t k = 0; k < 3; ++k) {
      ChunkLevel& level = chunk.levels[k];
      LevelMaker maker(level);
      // From the edge point: `left` along -x, `down` along -y of the chunk before it is turned.
      const auto add = [&](double left, double down) {
        double x = -left, y = -down;
        for (std::size_t i = 0; i < turn; ++i) {
          const double before = x;
          x = -y;
          y = before;
        }
        return maker.add(8 + x, 8 + y, 4);
      };
      const VertexIndex edge = add(0, 0), inner = add(1, 1), outer = add(7, 7);
      const auto lineOf = [&](std::size_t of, bool alongX) {
        std::vector<VertexIndex> line(kArcs);
        for (std::size_t i = 0; i < kArcs; ++i) {
          const double way = 1 + lineGroups[of][i];
          const bool first = i == 0 || lineGroups[of][i] != lineGroups[of][i - 1];
          line[i] = !first ? line[i - 1] : alongX ? add(way, 0) : add(0, way);
        }
        if (alongX) std::reverse(line.begin(), line.end());
        return line;
      };
      HandSeam right, top;  // before it is turned: on +x running down, on +y running right
      for (std::size_t i = 0; i < kArcs; ++i) {
        const int group = tileGroups[k][i];
        const bool first = i == 0 || group != tileGroups[k][i - 1];
        right.tiles.push_back(group == 0 ? inner : first ? add(1, 1 + group) : right.tiles.back());
        top.tiles.push_back(group == 0 ? inner : first ? add(1 + group, 1) : top.tiles.back());
      }
      std::reverse(top.tiles.begin(), top.tiles.end());
      right.polyline = lineOf(k, false);
      top.polyline = lineOf(k, true);
      right.begin = edge;
      top.end = edge;
      for (const auto& tiles : {top.tiles, right.tiles}) {
        for (std::size_t i = 0; i + 1 < kArcs; ++i) {
          maker.addTriangle(outer, tiles[i + 1], tiles[i], level.interior);
        }
      }
      for (const bool alongX : {false, true}) {
        const HandSeam& seam = alongX ? top : right;
        const std::size_t face = kTurned[(turn + (alongX ? 1 : 0)) % 4];
        maker.addStrip(seam, seam.polyline, level.regular[face]);
        const std::vector<VertexIndex> next = k < 2 ? lineOf(k + 1, alongX) : seam.polyline;
        if (k < 2) maker.addStrip(seam, next, level.transition[face]);
        level.seams[face].push_back(seam.curve(level, next));
      }
    }
  }
  return chunks;
}

/// What an index says of such chunks, as buildChunks() would fill it.
inline ChunkIndex indexOf(std::vector<Chunk> chunks) {
  ChunkIndex index;
  index.grid = "hand made";
  index.chunkSize = 8;
  index.transform = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  for (std::size_t k = 0; k < chunks[0].levels.size(); ++k) {
    index.tolerances.push_back(0.1 * static_cast<double>(1u << 2 * k));
  }
  std::sort(chunks.begin(), chunks.end(),
            [](const Chunk& a, const Chunk& b) { return a.index < b.index; });
  for (const Chunk& chunk : chunks) {
    ChunkEntry& entry = index.chunks.emplace_back();
    entry.index = chunk.index;
    for (std::size_t k = 0; k < chunk.levels.size(); ++k) {
      const ChunkLevel& level = chunk.levels[k];
      ChunkLevelEntry& out = entry.levels.emplace_back();
      out.vertices = level.positions.size();
      out.interiorTriangles = level.interior.size();
      for (const auto& strip : level.regular) out.regularTriangles += strip.size();
      for (const auto& strip : level.transition) out.transitionTriangles += strip.size();
      out.least = out.greatest = level.positions[0];
      for (const Position& p : level.positions) {
        out.least = {std::min(out.least.x, p.x), std::min(out.least.y, p.y),
                     std::min(out.least.z, p.z)};
        out.greatest = {std::max(out.greatest.x, p.x), std::max(out.greatest.y, p.y),
                        std::max(out.greatest.z, p.z)};
      }
      out.maxErrorVoxels = index.tolerances[k];
      out.transitionErrorVoxels = index.tolerances[std::min(k + 1, index.tolerances.size() - 1)];
    }
  }
  return index;
}

}  // namespace tufa::test
