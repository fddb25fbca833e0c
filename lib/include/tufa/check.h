#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <optional>
#include <string>
#include <tufa/mesh.h>
#include <tufa/progress.h>
#include <vector>

namespace tufa {

/// One connected piece of the surface.
struct CheckComponent {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  long long eulerCharacteristic = 0;  ///< V - E + F
  /// Handles: (2 - eulerCharacteristic) / 2; unset unless the piece is a closed 2-manifold.
  std::optional<long long> genus;
};

/// What check() found. Everything counts triangles, quads being split from vertex 0 to vertex 2.
struct CheckReport {
  std::size_t vertices = 0;  ///< used by a face
  std::size_t triangles = 0;
  std::size_t unusedVertices = 0;       ///< positions that no face uses
  std::size_t boundaryEdges = 0;        ///< edges of one triangle
  std::size_t boundaryLoops = 0;        ///< closed curves that the boundary edges form
  std::size_t nonManifoldEdges = 0;     ///< edges of three or more triangles
  std::size_t nonManifoldVertices = 0;  ///< vertices whose triangles are not one fan
  std::size_t misorientedEdges = 0;     ///< edges that two triangles run through in one direction
  std::size_t degenerateFaces = 0;      ///< a repeated index, or three points on a line (exact)
  std::size_t duplicateFaces = 0;       ///< triangles with the vertex set of an earlier one
  std::size_t invalidFaces = 0;         ///< an index out of range, or a position that is not finite
  /// Pairs of triangles that meet elsewhere than in a shared vertex or edge (exact predicates);
  /// unset if it was not asked for.
  std::optional<std::size_t> selfIntersectingPairs;
  std::vector<CheckComponent> components;  ///< largest first
  long long eulerCharacteristic = 0;       ///< of the whole mesh
  double area = 0;                         ///< world units squared
  double volume = 0;                       ///< world units cubed, by the divergence theorem
  double smallestAngleDegrees = 0;         ///< of all corners of all triangles
  double shareUnder10Degrees = 0;          ///< triangles whose smallest angle is under 10 degrees

  bool closed = false;         ///< no boundary edge, at least one face
  bool manifold = false;       ///< no non-manifold edge or vertex
  bool oriented = false;       ///< no misoriented edge
  bool outward = false;        ///< closed, oriented, and normals point away from the solid
  bool boundsVolume = false;   ///< CGAL's does_bound_a_volume: nested pieces alternate in direction
  double seconds = 0;

  /// Closed, manifold, oriented, outward, free of invalid, degenerate-by-index and duplicate faces.
  [[nodiscard]] bool watertight() const;
};

/// Options of check().
struct CheckOptions {
  bool selfIntersections = true;  ///< search for intersecting pairs
  bool boundsVolume = true;       ///< ask CGAL whether the mesh bounds a volume
  /// Weld vertices at bit-equal positions first: for formats without shared indices, such as STL.
  bool weld = false;
  int threads = 0;                ///< most threads; 0: as many as the TBB arena allows
  Progress progress;
};

/// Answers whether a mesh is closed, 2-manifold, oriented, free of self-intersections, and what its
/// topology is. Takes any mesh, broken ones too: what is wrong is counted, never thrown.
///
/// Uses CGAL (GPL): lives in the target tufa::check, apart from tufa::tufa.
[[nodiscard]] CheckReport check(const Mesh& mesh, const CheckOptions& options = {});

/// Distances in voxels, where a voxel is the cube root of its world volume.
struct DistanceSummary {
  std::size_t samples = 0;
  double largest = 0;
  double mean = 0;
  double rms = 0;
};

/// Two-sided distance between a mesh and the trilinear isosurface of a grid.
struct DistanceReport {
  DistanceSummary meshToSurface;  ///< samples on the mesh, Newton steps in the field
  DistanceSummary surfaceToMesh;  ///< samples on the isosurface, nearest triangle of an AABB tree
  double isovalue = 0;            ///< as used
  double voxelSize = 0;           ///< world length of one voxel of the figures above
  double seconds = 0;
};

/// Options of checkAgainst().
struct DistanceOptions {
  std::optional<double> isovalue;  ///< unset: as contour() chooses
  int samplesPerEdge = 3;          ///< each triangle is sampled on a lattice with that many a side
  int threads = 0;
  Progress progress;
};

/// Measures how far the mesh is from the trilinear isosurface of `grid`, both ways. Throws Error as
/// contour() does for grids that cannot be meshed.
[[nodiscard]] DistanceReport checkAgainst(const Mesh& mesh, const openvdb::GridBase& grid,
                                          const DistanceOptions& options = {});

}  // namespace tufa
