#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <string>

namespace tufa::tools {

/// What `make` and `voxelize` tell of the volume that they wrote.
struct WrittenGrid {
  std::string input;  ///< the mesh it was made of; empty for a shape
  std::string output;
  std::string grid;           ///< its name
  std::size_t triangles = 0;  ///< of the mesh it was made of
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
void writeAndTell(const openvdb::FloatGrid::Ptr& grid, WrittenGrid written, Telling telling);

}  // namespace tufa::tools
