#pragma once

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

/// For programs: a JSON object.
[[nodiscard]] std::string toJson(const WrittenGrid& written);

/// For people: a line on what was made, and one on what was written.
[[nodiscard]] std::string describe(const WrittenGrid& written);

}  // namespace tufa::tools
