#include <tufa/error.h>
#include <tufa/extract.h>
#include <cmath>
#include <string>

#include "base/job.h"
#include "base/known_enum.h"
#include "base/run_call.h"
#include "base/single_precision.h"
#include "extract/cube_mesher.h"
#include "extract/emc.h"
#include "extract/marching_cubes.h"
#include "extract/mc33.h"
#include "extract/octree_mc.h"
#include "extract/surface_nets.h"
#include "extract/tetrahedra.h"
#include "grid/volume.h"
#include "refine/rounding.h"
#include "uniform/place_vertices.h"

namespace tufa {
namespace {

constexpr double kBlocksEnd = 0.1;

Mesh meshOf(const grid::Volume& volume, Method method, const ExtractOptions& all,
            ContourReport& report, base::Job& job) {
  const ContourOptions& options = all.contour;
  switch (method) {
    case Method::MarchingCubes:
      return extraction::meshCubes(volume, extraction::marchingCubesRule(options.ambiguity),
                                   options, report, job);
    case Method::MarchingCubes33:
      return extraction::meshCubes(volume, extraction::mc33Rule(), options, report, job);
    case Method::ExtendedMarchingCubes:
      return extraction::meshSharp(volume, all.sharpAngle, options, report, job);
    case Method::SurfaceNets:
      return extraction::meshSurfaceNets(volume, options, report, job);
    case Method::OctreeCubes:
      return extraction::meshOctree(volume, options, report, job);
    default:
      return extraction::meshTetrahedra(volume, method, options, report, job);
  }
}

void requireAngle(double degrees) {
  if (degrees >= 0 && degrees <= 180) return;
  throw Error(ErrorCode::InvalidArgument,
              "the sharp angle is " + std::to_string(degrees) + ", must be 0 to 180 degrees");
}

void requireTolerance(double voxels) {
  if (voxels >= 0 && std::isfinite(voxels)) return;
  throw Error(ErrorCode::InvalidArgument, "the tolerance is " + std::to_string(voxels) +
                                              " voxels, must be 0 or a finite number above it");
}

// To world space and, where that is harmless, to single precision, as contour() does.
void finish(const grid::Affine& affine, Normals normals, Mesh& mesh, base::Job& job) {
  job.forRanges(mesh.positions.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mesh.positions[i] = affine.toWorld(mesh.positions[i]);
  });
  base::roundToSingle(mesh, refine::kMostRounding * affine.leastHeight(), job);
  if (normals == Normals::Faces) uniform::setFaceNormals(mesh, job);
  if (normals == Normals::None) mesh.normals = {};
}

}  // namespace

const std::array<std::string_view, 10>& methodNames() {
  static constexpr std::array<std::string_view, 10> kNames = {
      "dual", "mc", "mc33", "emc", "surface-nets", "mt5", "mt6", "mt24", "bcc", "octree-mc"};
  return kNames;
}

std::optional<Method> methodByName(std::string_view name) {
  for (std::size_t n = 0; n < methodNames().size(); ++n) {
    if (methodNames()[n] == name) return static_cast<Method>(n);
  }
  return std::nullopt;
}

Mesh extract(const openvdb::GridBase& grid, Method method, const ExtractOptions& options,
             ContourReport* report) {
  base::requireKnown(method, Method::OctreeCubes, "the method");
  requireAngle(options.sharpAngle);
  if (method == Method::Dual) return contour(grid, options.contour, report);
  if (method == Method::OctreeCubes) requireTolerance(options.contour.tolerance);
  grid::requireMeshable(grid);
  const auto work = [&](ContourReport& out, base::Job& job) {
    job.beginStage("blocks", kBlocksEnd);
    const grid::Volume volume = grid::openVolume(grid, options.contour, job);
    Mesh mesh = meshOf(volume, method, options, out, job);
    job.beginStage("finish", 1.0);
    finish(volume.affine, options.contour.normals, mesh, job);
    return mesh;
  };
  const bool mayLeaveHoles = method == Method::MarchingCubes;
  return base::runCall(options.contour, report, work,
                       mayLeaveHoles ? base::Rules::All : base::Rules::Closed);
}

}  // namespace tufa
