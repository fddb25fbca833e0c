// Small grids of any topology and any values through buildChunks(). The oracle is the promise:
// chunks of any mixture of LODs fit together, closed where the data is closed, with the topology of
// the uniform mesh, each within its tolerance.

#include <tufa/chunks.h>
#include <tufa/error.h>
#include <cmath>

#include "fuzz.h"
#include "grids.h"
#include "support/mesh_oracle.h"

namespace {

using tufa::fuzz::require;
using tufa::fuzz::Source;

void requireFinite(const tufa::Mesh& mesh) {
  for (const tufa::Position& p : mesh.positions) {
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite positions");
  }
}

/// Returns the Euler characteristic.
long long requirePromises(const tufa::Mesh& mesh, bool closed) {
  requireFinite(mesh);
  const tufa::test::MeshTopology topology = tufa::test::inspect(mesh);
  require(topology.nonManifoldEdges == 0, "manifold edges");
  require(topology.misorientedEdges == 0, "one orientation");
  require(topology.collapsedFaces == 0, "no collapsed faces");
  if (closed) {
    require(topology.boundaryEdges == 0, "closed");
    require(topology.manifold(), "manifold vertices, no duplicate faces, no unused vertices");
  }
  return topology.euler();
}

tufa::ChunkOptions optionsFrom(Source& source) {
  tufa::ChunkOptions options;
  options.chunkSize = 8;
  options.levels = 1 + source.below(3);
  options.factor = 1.5 + source.below(16);
  if (source.coin()) options.contour.isovalue = (source.next() - 128) / 128.0;
  options.contour.inside = static_cast<tufa::Inside>(source.below(3));
  options.contour.ambiguity = static_cast<tufa::Ambiguity>(source.below(4));
  options.contour.nonFinite = tufa::NonFinite::Outside;
  options.contour.cap = source.coin();
  options.contour.repair = source.coin();
  options.contour.tolerance = source.next() / 64.0;
  if (options.contour.tolerance == 0) options.levels = 1;  // no other can follow
  options.contour.threads = 1;
  return options;
}

void fitTogether(const openvdb::GridBase& grid, Source& source) {
  const tufa::ChunkOptions options = optionsFrom(source);
  std::vector<tufa::Chunk> chunks;
  tufa::ContourReport report;
  const tufa::ChunkIndex index = tufa::buildChunks(
      grid, options,
      [&](const tufa::ChunkIndex&, tufa::Chunk&& chunk) { chunks.push_back(std::move(chunk)); },
      &report);
  require(index.chunks.size() == chunks.size(), "as many chunks as the index has");
  constexpr double kMoved = 0.02;  // vertices near planes between chunks are moved to them
  for (const tufa::Chunk& chunk : chunks) {
    for (std::size_t level = 0; level < chunk.levels.size(); ++level) {
      const double most = index.tolerances[level] + kMoved;
      require(chunk.levels[level].maxErrorVoxels <= most, "the tolerance");
    }
  }
  const auto levels = static_cast<int>(index.tolerances.size());
  std::vector<std::size_t> finest(chunks.size(), 0);
  std::vector<std::size_t> mixture;
  for (std::size_t n = 0; n < chunks.size(); ++n) {
    mixture.push_back(static_cast<std::size_t>(source.below(levels)));
  }
  const bool closed = report.openEdges == 0;
  const long long euler = requirePromises(tufa::assembleChunks(chunks, finest), closed);
  require(requirePromises(tufa::assembleChunks(chunks, mixture), closed) == euler,
          "the same topology of every mixture");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Source source(data, size);
  const openvdb::GridBase::Ptr grid = tufa::fuzz::gridFrom(source);
  try {
    fitTogether(*grid, source);
  } catch (const tufa::Error& error) {
    require(error.code() == tufa::ErrorCode::UnsupportedGrid, error.what());
  }
  return 0;
}
