#pragma once

#include <tufa/check.h>
#include <tufa/export.h>
#include <tufa/extract.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tufa {

/// Options of compareMethods().
struct CompareOptions {
  /// Which ways to mesh, of comparedNames(), in that order; none: all of them.
  std::vector<std::string> methods;
  /// How each is run, and the threads and the progress of the whole. The rule for ambiguous faces
  /// must be one that makes closed meshes: "mc-original" shows the other.
  ExtractOptions extract;
  int repeats = 1;         ///< runs of each method, of which the quickest counts: 1 to 1000
  int samplesPerEdge = 3;  ///< as in DistanceOptions
  /// The true shape, if it is known: the signed distance to it in world units, at a point of world
  /// space. Called from several threads at a time.
  std::function<double(const Position&)> truth;
  /// Points of the true shape, such as those along its creases, whose distance to each mesh counts.
  std::vector<Position> truthPoints;
  /// Measure the memory of each method. That gives freed memory of the whole process back to the
  /// system, and resets the process's own record of the most memory it held.
  bool memory = false;
  bool keepMeshes = false;  ///< keep the meshes in the result
};

/// How far a mesh is from the true shape, in voxels.
struct TruthReport {
  DistanceSummary meshToTruth;   ///< at samples on the mesh, as in DistanceReport
  DistanceSummary pointsToMesh;  ///< of CompareOptions::truthPoints
  double pointsShare99 = 0;      ///< 99 % of those points are no farther from the mesh
};

/// What one way to mesh made.
struct MethodResult {
  std::string name;       ///< of comparedNames()
  double seconds = 0;     ///< wall clock of the quickest run
  double cpuSeconds = 0;  ///< least processor time of a run, of all threads of the process
  std::optional<std::uint64_t> extraBytes;  ///< most memory beyond that before, the mesh included
  CheckReport check;                        ///< counts, topology, faults, angles
  DistanceReport distance;                  ///< to the trilinear isosurface and back
  std::optional<TruthReport> truth;         ///< if the true shape is known
  Mesh mesh;                                ///< if CompareOptions::keepMeshes
};

/// Several ways to mesh one grid.
struct Comparison {
  double isovalue = 0;           ///< as used
  bool insideIsBelow = true;     ///< as used
  double voxelSize = 0;          ///< world length of one voxel
  std::size_t activeVoxels = 0;  ///< of the grid
  /// V - E + F of the surface of the trilinear interpolant, whose topology marching cubes 33 has.
  long long trilinearEuler = 0;
  /// The point of the isosurface, in world space, whose distances to the meshes differ most; unset
  /// without a surface.
  std::optional<Position> differsAt;
  Normal outward{0, 0, 0};            ///< of the surface there; 0 if the field is flat
  double difference = 0;              ///< of these distances, in voxels
  std::vector<MethodResult> methods;  ///< those asked for, in the order of comparedNames()
};

/// Names of what compareMethods() can run: "dual" as contour() is by default, "dual-uniform", the
/// other methods of methodNames(), "mc-original" (marching cubes with Ambiguity::Original),
/// "cms-adaptive" (cubical marching squares whose cells are merged by the tolerance of dual), and
/// OpenVDB's own mesher as a peer: "volume-to-mesh-0" and "volume-to-mesh-0.25", by its adaptivity.
[[nodiscard]] TUFA_API const std::vector<std::string_view>& comparedNames();

/// Meshes one grid in several ways and measures each: time, memory, size, topology, faults,
/// distances and angles. All figures but times and memory are the same for any number of threads.
///
/// Uses CGAL (GPL): it is in Tufa::check. OpenVDB's mesher cannot be cancelled while it runs.
/// Throws Error as extract() does, InvalidArgument for unknown names and options out of range too.
[[nodiscard]] TUFA_API Comparison compareMethods(const openvdb::GridBase& grid,
                                                 const CompareOptions& options = {});

}  // namespace tufa
