#include <tufa/error.h>
#include <tufa/extract.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/job.h"
#include "base/known_enum.h"
#include "base/number_text.h"
#include "base/part_of_progress.h"
#include "base/run_call.h"
#include "extract/cms.h"
#include "extract/cube_mesher.h"
#include "extract/emc.h"
#include "extract/marching_cubes.h"
#include "extract/mc33.h"
#include "extract/octree_mc.h"
#include "extract/refine_triangles.h"
#include "extract/surface_nets.h"
#include "extract/tetrahedra.h"
#include "grid/volume.h"
#include "refine/keep_apart.h"
#include "refine/rounding.h"
#include "uniform/place_vertices.h"

namespace tufa {
namespace {

constexpr double kBlocksEnd = 0.1, kRefineEnd = 0.98;
// Of a dual mesh: when it is there, to be refined.
constexpr double kDualEnd = 0.6;

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
    case Method::CubicalMarchingSquares:
      return extraction::meshSquares(volume, all.sharpAngle, all.mergeTolerance, options, report,
                                     job);
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
              "the sharp angle is " + base::numberText(degrees) + ", must be 0 to 180 degrees");
}

void requireTolerance(const std::string& what, double voxels) {
  if (voxels >= 0 && std::isfinite(voxels)) return;
  throw Error(ErrorCode::InvalidArgument, what + " is " + base::numberText(voxels) +
                                              " voxels, must be 0 or a finite number above it");
}

// Two sheets in a cell may have theirs at one place.
bool hasPointsInCells(Method method) {
  return method == Method::ExtendedMarchingCubes || method == Method::CubicalMarchingSquares;
}

// To world space and, where that is harmless, to single precision, as contour() does. `hasPoints`:
// see hasPointsInCells().
void finish(const grid::Affine& affine, Normals normals, bool hasPoints, Mesh& mesh,
            base::Job& job) {
  if (hasPoints) {
    const bool isSingle = refine::isWrittenInSingle(mesh.positions, affine, job);
    (void)refine::keepApart(mesh.positions, mesh.triangles, affine, isSingle, job);
  }
  (void)refine::takeToWorld(mesh, affine, job);
  if (normals == Normals::Faces) uniform::setFaceNormals(mesh, job);
  if (normals == Normals::None) mesh.normals = {};
}

// How far off the surface vertices are moved onto it: those beyond are on creases, see RefineRule.
double stayBeyond(Method method, const ExtractOptions& options) {
  switch (method) {
    case Method::Dual: {
      // Other vertices are nearer, by about what the mesh is off the uniform one.
      constexpr double kOfCreases = 0.2;
      const double merged = options.contour.uniform ? 0 : options.contour.tolerance;
      return std::max({options.refine, merged, kOfCreases});
    }
    // Off the surface are crossings found to the sub-cell, beside creases, and vertices on them.
    case Method::MarchingCubes:
    case Method::MarchingCubes33:
    case Method::ExtendedMarchingCubes:
      return options.refine;
    // And vertices inside merged cells, which are to be moved.
    case Method::CubicalMarchingSquares:
      return std::max(options.refine, options.mergeTolerance);
    default:
      return std::numeric_limits<double>::infinity();
  }
}

void refineMesh(const grid::Volume& volume, const extraction::RefineRule& rule, Mesh& mesh,
                ContourReport& report, base::Job& job) {
  job.beginStage("refine", kRefineEnd, base::Length::Unknown);
  report.refinement = extraction::refineTriangles(volume, rule, mesh, job);
}

// Contours, and refines that mesh in a second call.
Mesh refinedDual(const openvdb::GridBase& grid, const ExtractOptions& options,
                 ContourReport* report) {
  ContourOptions first = options.contour, second = options.contour;
  first.progress = base::partOf(options.contour.progress, 0, kDualEnd);
  second.progress = base::partOf(options.contour.progress, kDualEnd, 1);
  ContourReport made, refined;
  Mesh mesh = contour(grid, first, &made);
  const auto work = [&](ContourReport& out, base::Job& job) {
    job.beginStage("blocks of refining", kBlocksEnd);
    const grid::Volume volume = grid::openVolume(grid, second, job);
    const grid::Affine& affine = volume.affine;
    for (Position& position : mesh.positions) position = affine.fromWorld(position);
    refineMesh(volume, {options.refine, stayBeyond(Method::Dual, options)}, mesh, out, job);
    job.beginStage("finish", 1.0);
    finish(affine, second.normals, false, mesh, job);
    if (second.keepCells) mesh.cells = grid::cellsOf(mesh.positions, volume.transform, job);
    return std::move(mesh);
  };
  mesh = base::runCall(second, &refined, work);
  made.certificate.reset();
  made.refinement = refined.refinement;
  made.stages.insert(made.stages.end(), refined.stages.begin(), refined.stages.end());
  if (report != nullptr) *report = std::move(made);
  return mesh;
}

}  // namespace

const std::array<std::string_view, 11>& methodNames() {
  static constexpr std::array<std::string_view, 11> kNames = {
      "dual", "mc", "mc33", "emc", "surface-nets", "mt5", "mt6", "mt24", "bcc", "octree-mc", "cms"};
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
  base::requireKnown(method, Method::CubicalMarchingSquares, "the method");
  requireAngle(options.sharpAngle);
  requireTolerance("the distance to refine to", options.refine);
  requireTolerance("the tolerance of merging cells", options.mergeTolerance);
  if (method == Method::Dual) {
    if (options.refine > 0) return refinedDual(grid, options, report);
    return contour(grid, options.contour, report);
  }
  if (method == Method::OctreeCubes) requireTolerance("the tolerance", options.contour.tolerance);
  grid::requireMeshable(grid);
  const auto work = [&](ContourReport& out, base::Job& job) {
    job.beginStage("blocks", kBlocksEnd);
    const grid::Volume volume = grid::openVolume(grid, options.contour, job);
    Mesh mesh = meshOf(volume, method, options, out, job);
    if (options.refine > 0) {
      refineMesh(volume, {options.refine, stayBeyond(method, options)}, mesh, out, job);
    }
    job.beginStage("finish", 1.0);
    finish(volume.affine, options.contour.normals, hasPointsInCells(method), mesh, job);
    if (options.contour.keepCells) {
      mesh.cells = grid::cellsOf(mesh.positions, volume.transform, job);
    }
    return mesh;
  };
  const bool mayLeaveHoles = method == Method::MarchingCubes;
  return base::runCall(options.contour, report, work,
                       mayLeaveHoles ? base::Rules::All : base::Rules::Closed);
}

}  // namespace tufa
