// For each volume: the triangles that volumeToMesh needs for the error it reaches at adaptivity
// 0.25 and 1, and those of Tufa at the same error. Prints rows of a Markdown table.
//
// Both errors are measured alike, by checkAgainst(): the largest distance to the trilinear
// isosurface, both ways. Tufa's tolerance is that error less what its uniform mesh already has, as
// the tolerance counts from there: creases that Tufa restores are off the trilinear surface.

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <tufa/check.h>
#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

namespace {

// Share of the triangles that have an angle under 10 degrees, and the least angle, in degrees.
struct Angles {
  double least = 180;
  double thin = 0;
};

Angles anglesOf(const tufa::Mesh& mesh) {
  constexpr double kDegrees = 180 / 3.14159265358979323846;
  Angles angles;
  const std::vector<tufa::Triangle> triangles = tufa::triangulate(mesh);
  for (const tufa::Triangle& triangle : triangles) {
    openvdb::Vec3d p[3];
    for (int i = 0; i < 3; ++i) {
      const tufa::Position& at = mesh.positions[triangle.vertices[i]];
      p[i] = {at.x, at.y, at.z};
    }
    double least = 180;
    for (int i = 0; i < 3; ++i) {
      const openvdb::Vec3d a = p[(i + 1) % 3] - p[i], b = p[(i + 2) % 3] - p[i];
      least = std::min(least, std::atan2(a.cross(b).length(), a.dot(b)) * kDegrees);
    }
    angles.least = std::min(angles.least, least);
    if (least < 10) angles.thin += 1;
  }
  if (!triangles.empty()) angles.thin /= static_cast<double>(triangles.size());
  return angles;
}

tufa::Mesh volumeToMesh(const openvdb::FloatGrid& grid, double isovalue, double adaptivity) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, triangles, quads, isovalue, adaptivity);
  tufa::Mesh mesh;
  for (const openvdb::Vec3s& p : points) mesh.positions.emplace_back(p[0], p[1], p[2]);
  for (const openvdb::Vec3I& t : triangles) mesh.triangles.emplace_back(t[2], t[1], t[0]);
  for (const openvdb::Vec4I& q : quads) mesh.quads.emplace_back(q[3], q[2], q[1], q[0]);
  return mesh;
}

double errorOf(const tufa::Mesh& mesh, const openvdb::FloatGrid& grid) {
  const tufa::DistanceReport report = tufa::checkAgainst(mesh, grid);
  return std::max(report.meshToSurface.largest, report.surfaceToMesh.largest);
}

void printRow(const std::string& name, const openvdb::FloatGrid& grid) {
  tufa::ContourOptions options;
  options.uniform = true;
  tufa::ContourReport report;
  const tufa::Mesh uniform = tufa::contour(grid, options, &report);
  const double own = errorOf(uniform, grid);
  options.uniform = false;
  for (const double adaptivity : {0.25, 1.0}) {
    const tufa::Mesh theirs = volumeToMesh(grid, report.isovalue, adaptivity);
    const double error = errorOf(theirs, grid);
    options.tolerance = std::max(0.05, error - own);
    const tufa::Mesh ours = tufa::contour(grid, options, &report);
    const Angles theirAngles = anglesOf(theirs), ourAngles = anglesOf(ours);
    std::cout << "| " << name << " | " << adaptivity << " | " << std::setprecision(3) << error
              << " | " << theirs.triangleCount() << " | " << options.tolerance << " | "
              << errorOf(ours, grid) << " | " << ours.triangleCount() << " | "
              << static_cast<double>(ours.triangleCount()) /
                     static_cast<double>(theirs.triangleCount())
              << " | " << 100 * theirAngles.thin << " % | " << 100 * ourAngles.thin << " % |"
              << std::endl;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: tufa_error_table FILE.vdb...\n";
    return 2;
  }
  openvdb::initialize();
  std::cout
      << "| volume | adaptivity | its error | its triangles | Tufa's tolerance | Tufa's error "
         "| Tufa's triangles | ratio | its thin | Tufa's thin |\n"
         "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string file = argv[i];
      const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(tufa::readGrid(file));
      if (!grid) continue;
      const std::size_t slash = file.find_last_of('/');
      std::string name = slash == std::string::npos ? file : file.substr(slash + 1);
      printRow(name.substr(0, name.find_last_of('.')), *grid);
    }
  } catch (const tufa::Error& error) {
    std::cerr << error.what() << "\n";
    return 3;
  }
  return 0;
}
