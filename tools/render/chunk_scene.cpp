#include "chunk_scene.h"

#include <tufa/chunk_files.h>
#include <tufa/chunks.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/box.h"
#include "base/flat_triangle.h"

namespace tufa::render {
namespace {

constexpr std::array<Color, 4> kOfLod{
    {{0.30F, 0.72F, 0.42F}, {0.92F, 0.72F, 0.22F}, {0.35F, 0.58F, 0.92F}, {0.90F, 0.42F, 0.24F}}};
constexpr float kStripShare = 0.45F;  // of a colour's light

std::vector<std::size_t> chooseLods(const ChunkIndex& index, const Position& eye, double step) {
  std::vector<std::size_t> lods;
  for (const ChunkEntry& chunk : index.chunks) {
    base::Box box = base::Box::empty();
    box.add(chunk.levels.front().least);
    box.add(chunk.levels.front().greatest);
    const double far = std::sqrt(box.distanceSquared(Vec3(eye))) / step;
    const double lod = far < 1 ? 0 : std::floor(std::log2(far)) + 1;
    lods.push_back(std::min(index.tolerances.size() - 1, static_cast<std::size_t>(lod)));
  }
  restrictLods(index, lods);
  return lods;
}

/// The triangles of a chunk and their colours.
struct ColoredChunk {
  base::Box box = base::Box::empty();
  std::vector<base::FlatTriangle> triangles;
  std::vector<Color> colors;

  void add(const ChunkLevel& level, const std::vector<Triangle>& part, const Color& color) {
    for (const Triangle& t : part) {
      const auto corner = [&](std::size_t i) { return Vec3(level.positions[t.vertices[i]]); };
      triangles.emplace_back(corner(0), corner(1), corner(2));
      for (std::size_t i = 0; i < 3; ++i) box.add(corner(i));
      colors.push_back(color);
    }
  }
};

std::vector<ColoredChunk> colored(const ChunkIndex& index, const std::vector<Chunk>& chunks,
                                  const std::vector<std::size_t>& lods) {
  std::vector<ColoredChunk> out(chunks.size());
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const ChunkLevel& level = chunks[i].levels[lods[i]];
    const unsigned mask = transitionMask(index, i, lods);
    const Color own = kOfLod[lods[i] % kOfLod.size()];
    Color dark = own;
    for (float& channel : dark) channel *= kStripShare;
    out[i].add(level, level.interior, own);
    for (std::size_t face = 0; face < kChunkFaces; ++face) {
      if ((mask >> face & 1U) != 0) {
        out[i].add(level, level.transition[face], dark);
      } else {
        out[i].add(level, level.regular[face], own);
      }
    }
  }
  return out;
}

/// The colour of the triangle nearest to a point.
Color colorAt(const std::vector<ColoredChunk>& chunks, const Vec3& point) {
  Color color{1, 1, 1};
  double best = std::numeric_limits<double>::infinity();
  for (const ColoredChunk& chunk : chunks) {
    if (chunk.triangles.empty() || chunk.box.distanceSquared(point) >= best) continue;
    for (std::size_t t = 0; t < chunk.triangles.size(); ++t) {
      const double squared = chunk.triangles[t].squaredDistance(point);
      if (squared < best) best = squared, color = chunk.colors[t];
    }
  }
  return color;
}

}  // namespace

ChunkScene readChunkScene(const std::filesystem::path& folder, const Position& eye, double step) {
  const ChunkIndex index = readChunkIndex(folder.string());
  const std::vector<std::size_t> lods = chooseLods(index, eye, step);
  std::vector<Chunk> chunks;
  for (std::size_t i = 0; i < index.chunks.size(); ++i) {
    chunks.push_back(readChunk(index, i, folder.string()));
  }
  ChunkScene scene;
  scene.mesh = assembleChunks(chunks, lods);
  scene.colors = [own = colored(index, chunks, lods)](const std::vector<Position>& points) {
    std::vector<Color> out;
    for (const Position& p : points) out.push_back(colorAt(own, Vec3(p)));
    return out;
  };
  return scene;
}

}  // namespace tufa::render
