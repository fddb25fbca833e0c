#pragma once

#include <openvdb/openvdb.h>

#include <tufa/voxelize.h>
#include <cstddef>
#include <optional>
#include <string>

#include "filter_options.h"

namespace tufa::tools {

/// A mesh that was voxelized.
struct VoxelizedMesh {
  std::size_t triangles = 0;
  MeshDistances distances = MeshDistances::OpenVdb;
};

/// What sampling a scene took.
struct SampledScene {
  std::size_t samples = 0;
  std::size_t hiddenVoxels = 0;     ///< as VoxelizeReport has them
  std::size_t undecidedVoxels = 0;  ///< as VoxelizeReport has them
};

/// What `make`, `voxelize`, `model` and `filter` tell of the volume that they wrote.
struct WrittenGrid {
  std::string input;  ///< the mesh, scene or volume it was made of; empty for a shape
  std::string output;
  std::string grid;                   ///< its name
  std::optional<VoxelizedMesh> mesh;  ///< if it was made of one
  std::optional<SampledScene> scene;  ///< if it was made of one
  std::optional<FilterRun> filters;   ///< if it was made by them
  std::size_t activeVoxels = 0;
  double voxelSize = 0;
  double makeSeconds = 0;
  double writeSeconds = 0;
};

/// How it is told.
struct Telling {
  bool json = false;   ///< for programs: a JSON object
  bool quiet = false;  ///< not at all, unless as JSON
};

/// Writes a grid to `written.output` and tells of it, for people with a line on what was made and
/// one on what was written. Fills in what the grid and the writing give.
void writeAndTell(const openvdb::GridBase::Ptr& grid, WrittenGrid written, Telling telling);

}  // namespace tufa::tools
