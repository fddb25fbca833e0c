#pragma once

#include <openvdb/openvdb.h>

#include <tufa/chunks.h>
#include <cstddef>
#include <random>
#include <set>
#include <vector>

namespace tufa::test {

/// All chunks of a volume.
struct Made {
  ChunkIndex index;
  std::vector<Chunk> chunks;  ///< as in the index
};

[[nodiscard]] Made makeChunks(const openvdb::GridBase& grid, const ChunkOptions& options,
                              ContourReport* report = nullptr);

[[nodiscard]] Made makeChunks(GridFile& file, const ChunkOptions& options,
                              ContourReport* report = nullptr);

/// A few fine chunks among coarse ones, or as many of each: both kinds of mixtures occur.
[[nodiscard]] std::vector<std::size_t> randomLods(const Made& made, std::mt19937& random);

/// Draws `rounds` mixtures of levels, and as many that are not restricted; if TUFA_MIXTURES is set,
/// so many. Gives the masks drawn.
std::set<unsigned> expectMixturesToClose(const openvdb::GridBase& grid, ChunkOptions options,
                                         int rounds);

/// With strips of either kind: the certificate is a bound, no tolerance is exceeded, and no
/// triangles intersect.
void expectTolerancesKept(const Made& made);

}  // namespace tufa::test
