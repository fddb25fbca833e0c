#include <tufa/chunks.h>
#include <tufa/error.h>

#include <algorithm>
#include <cmath>

#include "lod/require_camera.h"

namespace tufa {
namespace {

void requireFit(const ChunkIndex& index, const std::vector<std::size_t>& lods) {
  if (lods.size() != index.chunks.size()) {
    throw Error(ErrorCode::InvalidArgument, std::to_string(lods.size()) + " levels for " +
                                                std::to_string(index.chunks.size()) + " chunks");
  }
  for (std::size_t chunk = 0; chunk < lods.size(); ++chunk) {
    const std::size_t levels = index.chunks[chunk].levels.size();
    if (lods[chunk] < levels) continue;
    throw Error(ErrorCode::InvalidArgument, "there is no level " + std::to_string(lods[chunk]) +
                                                " of chunk " + std::to_string(chunk) +
                                                ", which has " + std::to_string(levels));
  }
}

/// The distance from a point to the box around all LODs of a chunk; 0 inside.
double distanceTo(const ChunkEntry& chunk, const Position& eye) {
  if (chunk.levels.empty()) {
    throw Error(ErrorCode::InvalidArgument, "a chunk of the index has no levels");
  }
  const auto beyond = [&](double Position::*axis) {
    double least = chunk.levels.front().least.*axis;
    double greatest = chunk.levels.front().greatest.*axis;
    for (const ChunkLevelEntry& level : chunk.levels) {
      if (level.vertices == 0) continue;
      least = std::min(least, level.least.*axis);
      greatest = std::max(greatest, level.greatest.*axis);
    }
    return std::max({least - eye.*axis, 0.0, eye.*axis - greatest});
  };
  return std::hypot(beyond(&Position::x), beyond(&Position::y), beyond(&Position::z));
}

std::size_t coarsestAt(const ChunkEntry& chunk, double mostErrorVoxels) {
  std::size_t level = 0;
  for (std::size_t i = 1; i < chunk.levels.size(); ++i) {
    if (chunk.levels[i].maxErrorVoxels <= mostErrorVoxels) level = i;
  }
  return level;
}

}  // namespace

unsigned transitionMask(const ChunkIndex& index, std::size_t chunk,
                        const std::vector<std::size_t>& lods) {
  requireFit(index, lods);
  unsigned mask = 0;
  for (int face = 0; face < kChunkFaces; ++face) {
    const std::ptrdiff_t other = index.neighbour(chunk, face);
    if (other >= 0 && lods[static_cast<std::size_t>(other)] > lods[chunk]) mask |= 1u << face;
  }
  return mask;
}

void restrictLods(const ChunkIndex& index, std::vector<std::size_t>& lods) {
  requireFit(index, lods);
  if (lods.empty()) return;
  // The chunks of an LOD are final once all finer ones have been visited.
  const std::size_t coarsest = *std::max_element(lods.begin(), lods.end());
  for (std::size_t level = 0; level + 1 < coarsest; ++level) {
    for (std::size_t chunk = 0; chunk < lods.size(); ++chunk) {
      if (lods[chunk] != level) continue;
      for (int face = 0; face < kChunkFaces; ++face) {
        const std::ptrdiff_t other = index.neighbour(chunk, face);
        if (other < 0) continue;
        std::size_t& lod = lods[static_cast<std::size_t>(other)];
        lod = std::min(lod, level + 1);
      }
    }
  }
}

std::vector<std::size_t> selectLods(const ChunkIndex& index, const Camera& camera,
                                    double pixelError) {
  lod::requireCamera(camera, pixelError);
  // World units that one pixel covers at a distance of 1.
  const double pixel = 2 * std::tan(camera.verticalAngle / 2) / camera.screenHeight;
  std::vector<std::size_t> lods;
  lods.reserve(index.chunks.size());
  for (const ChunkEntry& chunk : index.chunks) {
    const double distance = distanceTo(chunk, camera.eye);
    lods.push_back(coarsestAt(chunk, pixelError * pixel * distance / index.voxelSize));
  }
  restrictLods(index, lods);
  return lods;
}

}  // namespace tufa
