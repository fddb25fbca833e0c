// A chain of levels of detail: one volume in, one .glb out, and the level that a camera needs.

#include <tufa/tufa.h>

#include <iostream>

int main() {
  try {
    const openvdb::FloatGrid::Ptr grid = tufa::makeShape(tufa::Shape::Bracket);

    tufa::LodOptions options;
    options.levels = 4;                // at most; the surface's topology may allow fewer
    options.contour.tolerance = 0.05;  // voxels, of level 0
    options.factor = 4;                // each level's tolerance over that of the level before
    const tufa::LodChain chain = tufa::buildLods(*grid, options);
    for (const tufa::Lod& lod : chain.levels) {
      std::cout << lod.mesh.triangleCount() << " triangles, at most "
                << lod.certificate.maxErrorVoxels << " voxels off, while the model takes over "
                << 100 * lod.screenCoverage << " % of the screen's height\n";
    }

    tufa::LodWriteOptions writing;
    writing.name = "bracket";
    writing.up = tufa::UpAxis::Z;  // of the volume; glTF's is y
    writing.scale = 0.1;           // metres in a world unit
    tufa::writeLods(chain, "bracket.glb", writing);

    tufa::Camera camera;
    camera.eye = {0, -40, 10};
    std::cout << "from there: level " << tufa::selectLod(chain, camera) << "\n";
  } catch (const tufa::Error& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
