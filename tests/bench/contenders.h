#pragma once

#include <openvdb/openvdb.h>

#include <tufa/contour.h>
#include <tufa/extract.h>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tufa::bench {

/// What one run made.
struct Outcome {
  std::size_t vertices = 0;
  std::size_t triangles = 0;      ///< once every quad is split in two
  std::vector<StageTime> stages;  ///< of Tufa's own
  std::shared_ptr<void> made;     ///< keeps the result, so that freeing it is not timed
};

/// One way to mesh a grid.
struct Contender {
  std::string name;
  std::size_t peer;  ///< place among all contenders of the one that its time is compared with
  std::function<Outcome(int threads)> run;
};

/// Every way to mesh `grid` at an isovalue that there is on this machine, and last the floor: one
/// parallel read of all leaf values, which no mesher that looks at the whole grid can beat. What a
/// contender needs beside the grid is made here, outside of what is timed. `grid` must outlive the
/// result.
[[nodiscard]] std::vector<Contender> contendersFor(const openvdb::FloatGrid& grid, double isovalue);

/// volumeToMesh at adaptivity 0, every method of tufa::extract() but dual contouring, and flying
/// edges where VTK is at hand. Marching cubes is compared with volumeToMesh, the others with
/// marching cubes. `grid` must outlive the result.
[[nodiscard]] std::vector<Contender> methodsFor(const openvdb::FloatGrid& grid, double isovalue);

/// How methodsFor() names a method.
[[nodiscard]] std::string nameOf(Method method);

}  // namespace tufa::bench
