// Draws chunks of a terrain as an engine would, at LODs chosen for a camera, and makes sure that no
// crack is left: every edge of what is drawn has a triangle on either side.

#include <tufa/tufa.h>

#include <array>
#include <iostream>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "chunk_table.h"

namespace {

using Place = std::array<double, 3>;

/// Edges of the triangles drawn, by the bits of their ends.
class Edges {
 public:
  void add(const Place& a, const Place& b, const Place& c) {
    for (const auto& edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      const auto other = open_.find({edge.second, edge.first});
      if (other == open_.end()) {
        open_.insert(edge);
      } else {
        open_.erase(other);
      }
    }
  }
  [[nodiscard]] std::size_t open() const { return open_.size(); }

 private:
  std::set<std::pair<Place, Place>> open_;  ///< that have a triangle on one side so far
};

}  // namespace

int main() {
  try {
    tufa::ShapeOptions shape;
    shape.voxelSize = 0.03;
    tufa::ChunkOptions options;
    options.chunkSize = 16;
    std::map<tufa::Coord, tufa::Chunk> chunks;
    const tufa::ChunkIndex index =
        tufa::buildChunks(*tufa::makeShape(tufa::Shape::Terrain, shape), options,
                          [&](const tufa::ChunkIndex&, tufa::Chunk&& chunk) {
                            const tufa::Coord at = chunk.index;
                            chunks.emplace(at, std::move(chunk));
                          });
    tufa::Camera camera;
    camera.eye = {-1.5, -1, 1};
    const std::vector<std::size_t> lods = tufa::selectLods(index, camera, 10);
    Edges edges;
    std::size_t triangles = 0, calls = 0;
    for (std::size_t i = 0; i < lods.size(); ++i) {
      const tufa::ChunkLevel& level = chunks.at(index.chunks[i].index).levels[lods[i]];
      const ChunkTable table(level);
      const auto place = [&](std::size_t n) {
        const tufa::Position& p = level.positions[table.indices[n]];
        return Place{p.x, p.y, p.z};
      };
      table.draw(tufa::transitionMask(index, i, lods), [&](std::size_t first, std::size_t count) {
        for (std::size_t n = first; n < first + count; n += 3) {
          edges.add(place(n), place(n + 1), place(n + 2));
        }
        triangles += count / 3;
        ++calls;
      });
    }
    std::cout << lods.size() << " chunks, " << triangles << " triangles in " << calls
              << " draw calls, " << edges.open() << " open edges\n";
    const std::set<std::size_t> different(lods.begin(), lods.end());
    return edges.open() == 0 && different.size() > 1 ? 0 : 1;
  } catch (const tufa::Error& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
