#pragma once

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <tufa/progress.h>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tufa {

/// One connected component of the surface: vertices that a chain of faces joins, if only at a
/// vertex.
struct CheckComponent {
  std::size_t vertices = 0;           ///< that its faces use
  std::size_t triangles = 0;          ///< quads count as two
  long long eulerCharacteristic = 0;  ///< V - E + F
  /// Handles: (2 - eulerCharacteristic) / 2; unset unless the component is a closed, oriented
  /// 2-manifold.
  std::optional<long long> genus;
};

/// What check() found. Everything counts triangles, quads being split from vertex 0 to vertex 2.
///
/// Invalid faces and those with a repeated vertex are counted and then left out: edges, vertices,
/// boundaries, components, area and volume are those of the other faces.
struct CheckReport {
  std::size_t vertices = 0;        ///< used by a face
  std::size_t triangles = 0;       ///< all of them, the faces that are left out included
  std::size_t unusedVertices = 0;  ///< positions that no face uses
  std::size_t boundaryEdges = 0;   ///< edges of one triangle
  /// Closed curves that the boundary edges form; curves that touch in a vertex count as one.
  std::size_t boundaryLoops = 0;
  std::size_t nonManifoldEdges = 0;  ///< edges of three or more triangles
  /// Vertices whose triangles are not one open or closed fan; the ends of a non-manifold edge too.
  std::size_t nonManifoldVertices = 0;
  std::size_t misorientedEdges = 0;  ///< edges of two triangles, both of which run the same way
  std::size_t degenerateFaces = 0;   ///< a repeated index, or three points on a line (exact)
  std::size_t collapsedFaces = 0;    ///< of these, the faces with a repeated index
  std::size_t duplicateFaces = 0;    ///< triangles with the vertex set of an earlier one
  std::size_t invalidFaces = 0;      ///< an index out of range, or a position that is not finite
  /// Pairs of triangles that intersect elsewhere than in the vertices or the edge whose indices
  /// they share (exact predicates). Degenerate faces are in no pair; duplicates are pairs. Unset if
  /// it was not asked for.
  std::optional<std::size_t> selfIntersectingPairs;
  std::vector<CheckComponent> components;  ///< largest first
  long long eulerCharacteristic = 0;       ///< of the whole mesh
  double area = 0;                         ///< world units squared
  /// World units cubed, by the divergence theorem: positive if normals point out. Means little
  /// unless the surface is closed and oriented.
  double volume = 0;
  double smallestAngleDegrees = 0;  ///< of all corners of all triangles
  double shareUnder10Degrees = 0;  ///< share, 0 to 1, of triangles whose smallest angle is under 10

  bool closed = false;    ///< no boundary edge, at least one face
  bool manifold = false;  ///< no non-manifold edge or vertex
  bool oriented = false;  ///< no misoriented edge
  /// Closed, oriented, and normals point away from the solid: out on outermost components, into the
  /// cavity on components inside those, and so on. A component that intersects others lies where
  /// most of its vertices do.
  bool outward = false;
  /// CGAL's does_bound_a_volume: the directions of nested components alternate; a mesh turned
  /// inside out as a whole bounds a volume too. False unless the mesh is closed, manifold, oriented
  /// and was searched for intersecting pairs and has none: CGAL promises nothing for other meshes.
  /// For meshes of more than 1000 components the test behind `outward` answers, as CGAL compares
  /// components in pairs.
  bool boundsVolume = false;
  double seconds = 0;  ///< wall clock

  /// Closed, manifold, oriented, outward, and free of invalid, collapsed and duplicate faces.
  [[nodiscard]] TUFA_API bool watertight() const;
};

/// Options of check().
struct CheckOptions {
  bool selfIntersections = true;  ///< search for intersecting pairs
  bool boundsVolume = true;       ///< ask CGAL whether the mesh bounds a volume; needs the search
  /// Weld vertices at bit-equal positions first: for formats without shared indices, such as STL.
  bool weld = false;
  int threads = 0;  ///< most threads; 0: as many as the TBB arena allows. Never changes the result.
  Progress progress = {};  ///< called from the calling thread; may cancel
};

/// Checks whether a mesh is closed, 2-manifold, oriented and free of self-intersections, and finds
/// its topology. Takes any mesh: faults are counted, never thrown. Throws Error only for the call
/// itself: InvalidArgument (threads), LimitExceeded (2^32 triangles), Cancelled.
///
/// Uses CGAL (GPL): it is in a target of its own, Tufa::check.
[[nodiscard]] TUFA_API CheckReport check(const Mesh& mesh, const CheckOptions& options = {});

/// Distances in voxels, where a voxel is the cube root of its world volume. Infinite where there
/// are samples but nothing to measure to.
struct DistanceSummary {
  std::size_t samples = 0;  ///< points measured at, all of equal weight
  double largest = 0;       ///< of all samples
  double mean = 0;          ///< arithmetic mean
  double rms = 0;           ///< root mean square
};

/// Two-sided distance between a mesh and the trilinear isosurface of a grid.
struct DistanceReport {
  DistanceSummary meshToSurface;  ///< samples on the mesh, Newton steps in the field
  DistanceSummary surfaceToMesh;  ///< samples on the isosurface, nearest triangle of an AABB tree
  double isovalue = 0;            ///< as used
  double voxelSize = 0;           ///< world length of one voxel of the figures above
  double seconds = 0;             ///< wall clock
};

/// Options of checkAgainst().
struct DistanceOptions {
  std::optional<double> isovalue = {};  ///< unset: as contour() chooses
  int samplesPerEdge =
      3;  ///< each triangle is sampled on a lattice with that many along an edge: 2 to 1000
  int threads = 0;         ///< as in CheckOptions
  Progress progress = {};  ///< called from the calling thread; may cancel
};

/// Measures how far the mesh is from the trilinear isosurface of `grid`, both ways. Throws Error as
/// contour() does for grids that cannot be meshed.
[[nodiscard]] TUFA_API DistanceReport checkAgainst(const Mesh& mesh, const openvdb::GridBase& grid,
                                                   const DistanceOptions& options = {});

/// The distance from each point to the nearest triangle of a mesh, in world units; infinite if the
/// mesh has none. Of the options, `threads` and `progress` are used. Points that lie near the point
/// before them are answered much faster.
[[nodiscard]] TUFA_API std::vector<double> distancesTo(const Mesh& mesh,
                                                       const std::vector<Position>& points,
                                                       const DistanceOptions& options = {});

}  // namespace tufa
