// Meshes a sequence of volumes, frame by frame: one that fails does not stop the others.

#include <tufa/tufa.h>

#include <filesystem>
#include <iostream>
#include <string>

namespace {

/// A sequence to work on: a sphere that grows.
void makeFrames(const std::filesystem::path& folder, int frames) {
  for (int frame = 1; frame <= frames; ++frame) {
    tufa::ShapeOptions options;
    options.voxelSize = 0.2 / frame;
    tufa::writeGrids({tufa::makeShape(tufa::Shape::Sphere, options)},
                     folder / ("frame." + std::to_string(frame) + ".vdb"));
  }
}

}  // namespace

int main() {
  const std::filesystem::path folder = "sequence";
  std::filesystem::create_directories(folder);
  constexpr int kFrames = 3;
  makeFrames(folder, kFrames);

  int failures = 0;
  for (int frame = 1; frame <= kFrames + 1; ++frame) {  // the last one is missing
    const auto volume = folder / ("frame." + std::to_string(frame) + ".vdb");
    try {
      tufa::ContourOptions options;
      options.isovalue = 0;     // one for all frames: what is chosen for a fog volume differs
      options.tolerance = 0.1;  // voxels: the error follows the resolution of each frame
      options.nonFinite = tufa::NonFinite::Outside;
      tufa::ContourReport report;
      const tufa::Mesh mesh = tufa::contour(*tufa::readGrid(volume), options, &report);
      tufa::write(mesh, std::filesystem::path(volume).replace_extension(".ply"));
      std::cout << volume << ": " << mesh.triangleCount() << " triangles, "
                << report.certificate->maxErrorVoxels << " voxels from the uniform mesh\n";
    } catch (const tufa::Error& error) {
      std::cout << "frame " << frame << " is left out: " << error.what() << "\n";
      ++failures;
    }
  }
  return failures == 1 ? 0 : 1;
}
