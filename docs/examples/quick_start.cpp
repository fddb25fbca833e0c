// Tufa in ten lines: a volume in, a closed mesh out.

#include <tufa/tufa.h>

#include <iostream>

int main(int argc, char** argv) {
  try {
    // Any openvdb::FloatGrid or DoubleGrid will do: readGrid("part.vdb") reads one from a file.
    const openvdb::FloatGrid::Ptr grid = tufa::makeShape(tufa::Shape::Bracket);

    const tufa::Mesh mesh = tufa::contour(*grid);
    tufa::write(mesh, argc > 1 ? argv[1] : "bracket.ply");

    std::cout << mesh.triangleCount() << " triangles, " << mesh.positions.size() << " vertices\n";
  } catch (const tufa::Error& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
