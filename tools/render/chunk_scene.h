#pragma once

#include <filesystem>

#include "scene.h"

namespace tufa::render {

/// What is drawn of a folder of chunks.
struct ChunkScene {
  Mesh mesh;
  SurfaceColors colors;  ///< by LOD; strips to coarser chunks are darker
};

/// Reads a folder of chunks and assembles them: those nearer to `eye` than `step` at LOD 0, than
/// twice as far at LOD 1, and so on; refined until neighbours differ by at most one. World units.
[[nodiscard]] ChunkScene readChunkScene(const std::filesystem::path& folder, const Position& eye,
                                        double step);

}  // namespace tufa::render
