#pragma once

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/progress.h>
#include <cstddef>
#include <string>
#include <vector>

namespace tufa {

/// A blob: a density of `weight` in its centre that falls with the distance d as
/// exp(-blobbiness (d / radius)²), as Blinn's metaballs do.
struct Blob {
  Position centre{0, 0, 0};  ///< world units
  double radius = 1;         ///< world units
  double weight = 1;         ///< below 0 it takes away from others
};

/// Options of fitBlobs().
struct FitOptions {
  int blobs = 64;    ///< most blobs, 1 to 10,000
  double error = 0;  ///< stop once the rms distance is at most this share of the mesh's diagonal
  int samples = 0;   ///< points taken on the mesh, up to 10 million; 0: 2000, and 20 for each blob
  /// Weights of the three terms of the energy, 0 or more, the first above 0: squared differences of
  /// the field's value from the threshold, of its normals from the mesh's, and the square of the
  /// blobs' volumes, which keeps them from growing where no sample holds them.
  double valueWeight = 1;
  double normalWeight = 0.01;  ///< see valueWeight
  double shrinkWeight = 1e-4;  ///< see valueWeight
  int threads = 0;             ///< most threads; 0: all. Never changes the result.
  Progress progress;           ///< called from the calling thread; may cancel
};

/// Where fitBlobs() was after one of its steps.
struct FitStep {
  std::size_t blobs = 0;   ///< so many
  double energy = 0;       ///< never more than in the step before
  double rmsDistance = 0;  ///< of the samples from the surface, world units
};

/// A surface of blobs: where their densities' sum is the threshold; more of it is inside.
struct BlobFit {
  std::vector<Blob> blobs;  ///< in the order in which splitting made them
  double threshold = 0.5;   ///< of the sum of densities
  double blobbiness = 4;    ///< see Blob
  double diagonal = 0;      ///< of the box of the mesh's triangles, world units
  /// Distances of the samples from the surface, along the field's gradient, world units.
  double rmsDistance = 0;
  double largestDistance = 0;  ///< of these the largest
  std::vector<FitStep> steps;  ///< the first blob, and one for each step
};

/// Whether this library was built with what fitBlobs() needs: Ceres Solver's headers.
[[nodiscard]] TUFA_API bool canFitBlobs();

/// Describes a solid by blobs (Muraki 1991): from one blob on, the one whose split lowers the
/// energy most is split, its parts are optimized, and then those around in turn; now and then all
/// of them. Points of equal area are taken on the mesh, which should be closed and face outward;
/// holes are bridged. A step is one split or, where none lowers the energy, as of symmetric solids,
/// up to eight that do together; it is taken only if the energy falls. Solved by Ceres's
/// TinySolver, with derivatives in closed form and all blobs bounded. Cost: a minute for 200 blobs
/// on two cores.
///
/// Throws Error: InvalidArgument (options out of their range, a mesh without area or one that faces
/// inward, positions that are not finite, a library built without Ceres), Cancelled.
[[nodiscard]] TUFA_API BlobFit fitBlobs(const Mesh& mesh, const FitOptions& options = {});

/// The text of a scene that implicit::readScene() reads: metaballs of Blinn's kernel.
[[nodiscard]] TUFA_API std::string sceneOf(const BlobFit& fit);

}  // namespace tufa
