#pragma once

#include <tufa/contour.h>
#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <array>
#include <optional>
#include <string_view>

namespace tufa {

/// Ways to extract the surface of a field. docs/methods.md compares them.
enum class Method {
  Dual,  ///< dual contouring, adaptive or uniform: contour()
  /// Marching cubes (Lorensen and Cline 1987): a vertex on each crossed lattice edge, and triangles
  /// by a table of cases.
  MarchingCubes,
  /// Marching cubes with the topology of the trilinear interpolant (Chernyaev 1995): faces are
  /// joined by their saddles, whatever the rule for ambiguous ones, and there are tunnels.
  MarchingCubes33,
  /// Extended marching cubes (Kobbelt et al. 2001): with vertices on creases and corners.
  ExtendedMarchingCubes,
  /// Surface nets (Gibson 1998): like uniform dual contouring, but each vertex is the mean of the
  /// crossings around it.
  SurfaceNets,
  MarchingTetrahedra5,   ///< five tetrahedra a cell, mirrored from cell to cell
  MarchingTetrahedra6,   ///< six tetrahedra a cell, around its main diagonal
  MarchingTetrahedra24,  ///< 24 tetrahedra a cell, through the centres of cells and faces
  BodyCentred,           ///< tetrahedra of the body-centred cubic lattice
  /// Marching cubes on the dual grid of an octree (Schaefer and Warren 2004): adaptive, with leaves
  /// of up to 8 samples along an edge where the field is affine to half of the tolerance.
  OctreeCubes,
  /// Cubical marching squares (Ho et al. 2005): contours of the cells' faces first, with sharp
  /// points, then the loops that they form, with vertices on creases and corners; adaptive with
  /// ExtractOptions::mergeTolerance.
  CubicalMarchingSquares,
};

/// The method of that name ("dual", "mc", ...), if there is one.
[[nodiscard]] TUFA_API std::optional<Method> methodByName(std::string_view name);

/// Names of all methods, in the order of the enum.
[[nodiscard]] TUFA_API const std::array<std::string_view, 11>& methodNames();

/// Options of extract().
struct ExtractOptions {
  /// What surface is meant, and how: `isovalue`, `inside`, `ambiguity`, `normals`, `nonFinite`,
  /// `cap`, `tileFaces`, `threads` and `progress`; `tolerance` for Method::OctreeCubes.
  /// Method::Dual takes the others too.
  ContourOptions contour;
  /// Extended marching cubes and cubical marching squares: normals at the crossings of a cell that
  /// differ by more, in degrees, mean a crease; 0 to 180. The default is that of Kobbelt et al.: a
  /// cosine of 0.9.
  double sharpAngle = 25.84;
  /// Split triangles where their middle, or that of an edge, is farther from the trilinear surface,
  /// in voxels, with the new vertices on it, down to edges of a sixteenth of a voxel; 0: off.
  /// Vertices that are off the surface are moved onto it first, but for those on creases, which
  /// stay with the edges at them: the trilinear surface rounds creases off. Gives triangles alone;
  /// ContourReport::refinement tells what was reached. A mesh of Method::Dual has no certificate
  /// then, and triangles may intersect, though moves that would fold the mesh are refused.
  double refine = 0;
  /// Cubical marching squares: cells without a crease are merged into leaves of up to 8 cells along
  /// an edge where the surface in them lies between two planes that are so far apart, in voxels; 0:
  /// all cells are the finest.
  double mergeTolerance = 0;
};

/// Meshes the surface of `grid` at the isovalue by the method asked for. Grids, transforms, what is
/// inside, the edge of the data, progress and errors are those of contour(); so are the bytes: the
/// same for any number of threads.
///
/// Surface nets gives quads, the others triangles. All meshes are closed, consistently
/// oriented 2-manifolds wherever the surface does not reach the end of the data, but for
/// Ambiguity::Original. OctreeCubes, and CubicalMarchingSquares with a `mergeTolerance`, are
/// adaptive; the collapsed cells of the former could touch in an edge of four triangles. None is
/// searched for self-intersections. A cell whose sign changes are partly the end of the data gives
/// no triangles. Of the report, what concerns neither certificates nor repair is filled.
///
/// Throws Error as contour() does; InvalidArgument also for Ambiguity::Original with a method other
/// than marching cubes.
[[nodiscard]] TUFA_API Mesh extract(const openvdb::GridBase& grid, Method method,
                                    const ExtractOptions& options = {},
                                    ContourReport* report = nullptr);

}  // namespace tufa
