#pragma once

#include <tufa/contour_report.h>
#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <tufa/progress.h>
#include <cstdint>
#include <memory>
#include <optional>

namespace tufa {

/// Which side of the isovalue is inside the solid.
enum class Inside {
  Auto,   ///< below for level sets, above for fog volumes; other grids: the side without background
  Below,  ///< values below the isovalue are inside (signed distance fields)
  Above,  ///< values above the isovalue are inside (densities)
};

/// How a cell face whose corners alternate inside, outside, inside, outside is joined. Every rule
/// but Original gives a closed 2-manifold; they differ in which thin links they keep.
enum class Ambiguity {
  Separate,    ///< inside corners are kept apart
  Join,        ///< inside corners are joined
  Asymptotic,  ///< by the bilinear interpolant's saddle value (Nielson and Hamann 1991)
  Chord,       ///< by the value where the chords between opposite crossings cross
  /// As the marching cubes of 1987 do, by the corners of the cell on either side: the inside ones
  /// are kept apart unless the cell has more than four. Cells disagree, which leaves holes:
  /// extract() takes it for marching cubes, to show them; other calls refuse it.
  Original,
};

/// Where the normals of the vertices come from.
enum class Normals {
  Gradient,  ///< the field's gradient at the crossings around the vertex
  Faces,     ///< the faces around the vertex, weighted by their angle
  None,      ///< no normals
};

/// What to do with NaN and infinite samples. A grid whose background is not finite is refused
/// whatever this says.
enum class NonFinite {
  Refuse,   ///< throw Error with their count and the first coordinate
  Outside,  ///< treat them as outside
};

/// Options of contour(). The defaults suit signed distance fields and densities alike.
struct ContourOptions {
  /// Value of the field on the surface, in the grid's own unit. Unset: 0 for level sets, else half
  /// way between the least and the greatest value.
  std::optional<double> isovalue;
  Inside inside = Inside::Auto;               ///< which side of the isovalue is solid
  Ambiguity ambiguity = Ambiguity::Separate;  ///< how ambiguous cell faces are joined
  Normals normals = Normals::Gradient;        ///< where the vertices' normals come from
  NonFinite nonFinite = NonFinite::Refuse;    ///< what to do with NaN and infinite samples
  /// Close the surface where it runs out of a level set's band (a clipped level set) instead of
  /// leaving an open boundary there.
  bool cap = false;
  /// Mesh every cell on its own, at the finest level, instead of adaptively.
  bool uniform = false;
  /// Largest distance, both ways, between the adaptive mesh and the uniform one, in voxels (the
  /// cube root of a voxel's world volume), 0 to 10^6. Certified: it is measured. Where a
  /// mesh exceeds it, fewer edges are collapsed there; without `simplify`, cells are split there.
  double tolerance = 0.1;
  /// Largest angle between the normals of the surface that one cell gathers, in degrees: its cost
  /// follows curvature. 180: no bound.
  double maxAngle = 180;
  /// Size in voxels, a power of two, up to which cells are merged whatever the tolerance, as long
  /// as topology allows. The certificate then tells the resulting error. 1: none.
  int minCell = 1;
  /// Size in voxels, a power of two, of the largest cells.
  int maxCell = 1 << 20;
  /// Collapse edges as far as the tolerance allows: few triangles, and no quads. Otherwise, and
  /// with bounds on cells or angles, an adaptive mesh is a cut of the octree.
  bool simplify = true;
  /// The angle that triangles are to keep, in degrees, 0 to 30, at the price of more triangles: a
  /// collapse makes no triangle with a smaller angle but in the place of as many, and flips aim at
  /// it. Where vertices have to stay close together, as at corners and the ends of creases, smaller
  /// angles are left: the certificate tells how many. Angles above 30 throw
  /// Error(InvalidArgument): they are not to be had, and there would be more triangles under 30. 0:
  /// triangles of less than 10 degrees are few, and the others as they come. Needs edge collapse:
  /// `simplify`, and no bounds on cells or angles. Means nothing to a uniform mesh.
  double minAngle = 0;
  /// Keep the leaves of the octree in the certificate.
  bool keepLeaves = false;
  /// Fill Mesh::cells.
  bool keepCells = false;
  /// Multiplies the tolerance in space: its value at the nearest voxel to the surface, in world
  /// space. Values of 0 and less, and NaN, keep the surface at the finest level; infinity stands
  /// for the largest float. Null: 1 everywhere.
  std::shared_ptr<const openvdb::GridBase> toleranceGrid;
  /// Most faces of voxels, in estimate, on the surface between tiles, of which a few bytes make
  /// millions: more are refused as LimitExceeded.
  std::uint64_t tileFaces = std::uint64_t{1} << 25;
  /// Find polygons that intersect and repair them: by small moves of vertices, other diagonals,
  /// smaller cells and, rarely, four triangles in place of a quad.
  bool repair = true;
  /// Most threads to use; 0: as many as the caller's TBB arena allows. Never changes the result.
  int threads = 0;
  Progress progress;  ///< called from the calling thread; may cancel
};

/// Meshes the surface of `grid` at the isovalue: dual contouring with one vertex for each surface
/// component of a cell and one quad for each crossed lattice edge.
///
/// Unless `uniform`, that mesh is reduced to the tolerance, edge by edge, or with `simplify` off
/// its cells are merged into the leaves of a restricted octree where the surface is flat, each with
/// one vertex for each disk of surface in it. The mesh keeps the topology of the uniform one.
///
/// The mesh is a closed, consistently oriented 2-manifold whenever the surface does not reach the
/// end of the data, in world space, outward by the right-hand rule under any affine transform. A
/// grid without surface gives an empty mesh. The result is the same, byte for byte, for any number
/// of threads. FloatGrid and DoubleGrid are supported.
///
/// Throws Error: UnsupportedGrid (other value types, frustum transforms), NonFiniteValues,
/// InvalidArgument (isovalue not finite, an option out of its range), LimitExceeded (2^32 vertices
/// or more, or quads of the uniform mesh: 2^31, or 2^32 / 6 if it is to be reduced), Cancelled.
[[nodiscard]] TUFA_API Mesh contour(const openvdb::GridBase& grid,
                                    const ContourOptions& options = {},
                                    ContourReport* report = nullptr);

}  // namespace tufa
