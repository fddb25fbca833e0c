// Meshes the bracket with Tufa and with OpenVDB's own volumeToMesh, and compares both with the true
// shape. With a folder as its argument it writes the two meshes there, for a picture.

#include <openvdb/tools/VolumeToMesh.h>
#include <tufa/tufa.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

namespace {

tufa::Mesh volumeToMesh(const openvdb::FloatGrid& grid) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, quads);
  tufa::Mesh mesh;
  for (const openvdb::Vec3s& p : points) mesh.positions.emplace_back(p[0], p[1], p[2]);
  // OpenVDB's quads run clockwise seen from outside.
  for (const openvdb::Vec4I& q : quads) mesh.quads.emplace_back(q[3], q[2], q[1], q[0]);
  return mesh;
}

/// Largest distance, in voxels, from the middles of the triangles and their edges to the shape.
double largestError(const tufa::Mesh& mesh, double voxelSize) {
  double largest = 0;
  for (const tufa::Triangle& triangle : tufa::triangulate(mesh)) {
    const tufa::Position& a = mesh.positions[triangle.vertices[0]];
    const tufa::Position& b = mesh.positions[triangle.vertices[1]];
    const tufa::Position& c = mesh.positions[triangle.vertices[2]];
    for (const tufa::Position& p :
         {tufa::Position((a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2),
          tufa::Position((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3)}) {
      largest = std::max(largest, std::abs(tufa::shapeDistance(tufa::Shape::Bracket, p)));
    }
  }
  return largest / voxelSize;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    tufa::ShapeOptions shape;
    shape.voxelSize = 0.03;
    const openvdb::FloatGrid::Ptr grid = tufa::makeShape(tufa::Shape::Bracket, shape);
    tufa::ContourOptions options;
    options.uniform = true;  // as theirs
    const tufa::Mesh theirs = volumeToMesh(*grid), ours = tufa::contour(*grid, options);
    if (argc > 1) {
      const std::filesystem::path folder = argv[1];
      tufa::write(theirs, folder / "volume_to_mesh.ply");
      tufa::write(ours, folder / "tufa.ply");
    }
    const double theirError = largestError(theirs, shape.voxelSize);
    const double ourError = largestError(ours, shape.voxelSize);
    std::cout << "largest distance to the true shape, in voxels: volumeToMesh " << theirError
              << ", Tufa " << ourError << "\n";
    return ourError < theirError ? 0 : 1;
  } catch (const tufa::Error& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
