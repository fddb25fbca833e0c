#include "support/chunk_mixtures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>

#include "support/mesh_oracle.h"
#include "support/print.h"
#include "support/uniform_mesh.h"

namespace tufa::test {
namespace {

/// Meshes put together as an engine would: vertices at the same bits become one. Counts vertices
/// that have other normals at the same place.
class Welder {
 public:
  void add(const Mesh& mesh) {
    std::vector<VertexIndex> places;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const Position& p = mesh.positions[i];
      const auto [found, isNew] = vertices_.emplace(
          std::array{p.x, p.y, p.z}, static_cast<VertexIndex>(welded.positions.size()));
      places.push_back(found->second);
      if (isNew) {
        welded.positions.push_back(p);
        welded.normals.push_back(mesh.normals[i]);
      } else if (!(welded.normals[found->second] == mesh.normals[i])) {
        ++otherNormals;
      }
    }
    for (const Triangle& t : mesh.triangles) {
      welded.triangles.emplace_back(places[t.vertices[0]], places[t.vertices[1]],
                                    places[t.vertices[2]]);
    }
  }

  Mesh welded;
  std::size_t otherNormals = 0;

 private:
  std::map<std::array<double, 3>, VertexIndex> vertices_;
};

void expectWhole(const Mesh& mesh, const MeshTopology& uniform, const std::string& what) {
  const MeshTopology found = inspect(mesh);
  EXPECT_TRUE(found.manifold() && found.closed()) << what << found;
  EXPECT_EQ(found.euler(), uniform.euler()) << what << found;
  EXPECT_EQ(found.components, uniform.components) << what << found;
}

// Of a grid or a file.
template <class Volume>
Made chunksOf(Volume& volume, const ChunkOptions& options, ContourReport* report) {
  Made made;
  std::map<Coord, Chunk> chunks;
  const ChunkSink keep = [&](const ChunkIndex&, Chunk&& chunk) {
    const Coord at = chunk.index;
    EXPECT_TRUE(chunks.emplace(at, std::move(chunk)).second) << at;
  };
  made.index = buildChunks(volume, options, keep, report);
  for (auto& [at, chunk] : chunks) made.chunks.push_back(std::move(chunk));
  EXPECT_EQ(made.index.chunks.size(), made.chunks.size());
  for (std::size_t i = 0; i < made.chunks.size(); ++i) {
    EXPECT_EQ(made.index.chunks[i].index, made.chunks[i].index);
  }
  return made;
}

}  // namespace

Made makeChunks(const openvdb::GridBase& grid, const ChunkOptions& options, ContourReport* report) {
  return chunksOf(grid, options, report);
}

Made makeChunks(GridFile& file, const ChunkOptions& options, ContourReport* report) {
  return chunksOf(file, options, report);
}

std::vector<std::size_t> randomLods(const Made& made, std::mt19937& random) {
  const bool coarse = random() % 2 == 0;
  std::vector<std::size_t> lods;
  for (const Chunk& chunk : made.chunks) {
    const std::size_t levels = chunk.levels.size();
    lods.push_back(coarse && random() % 4 != 0 ? levels - 1 : random() % levels);
  }
  return lods;
}

std::set<unsigned> expectMixturesToClose(const openvdb::GridBase& grid, ChunkOptions options,
                                         int rounds) {
  if (const char* most = std::getenv("TUFA_MIXTURES")) rounds = std::max(1, std::atoi(most));
  options.creaseAngle = 180;  // one normal a vertex, and the same for all that meet in it
  const Made made = makeChunks(grid, options);
  const MeshTopology uniform = inspect(uniformMesh(grid));
  std::set<unsigned> masks;
  std::mt19937 random(11);
  for (int round = 0; round < rounds; ++round) {
    const std::string what =
        "chunks of " + std::to_string(options.chunkSize) + ", round " + std::to_string(round);
    std::vector<std::size_t> lods = randomLods(made, random);
    expectWhole(assembleChunks(made.chunks, lods), uniform, what + ", not restricted");
    restrictLods(made.index, lods);
    Welder welder;
    for (std::size_t i = 0; i < lods.size(); ++i) {
      const unsigned mask = transitionMask(made.index, i, lods);
      masks.insert(mask);
      welder.add(meshForMask(made.chunks[i], lods[i], mask));
    }
    expectWhole(welder.welded, uniform, what);
    EXPECT_EQ(welder.otherNormals, 0u) << what;
    EXPECT_EQ(assembleChunks(made.chunks, lods).triangles.size(), welder.welded.triangles.size());
    if (::testing::Test::HasFailure()) break;
  }
  ::testing::Test::RecordProperty("mixtures", rounds);
  return masks;
}

void expectTolerancesKept(const Made& made) {
  for (const ChunkEntry& entry : made.index.chunks) {
    for (std::size_t level = 0; level < entry.levels.size(); ++level) {
      const ChunkLevelEntry& own = entry.levels[level];
      const std::size_t next = std::min(level + 1, entry.levels.size() - 1);
      EXPECT_GT(own.maxErrorVoxels, 0);
      EXPECT_LE(own.maxErrorVoxels, made.index.tolerances[level]);
      EXPECT_LE(own.transitionErrorVoxels, made.index.tolerances[next]);
      EXPECT_EQ(own.intersectionsLeft, 0U);
    }
  }
}

}  // namespace tufa::test
