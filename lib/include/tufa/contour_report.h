#pragma once

#include <tufa/export.h>
#include <tufa/octree.h>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tufa {

/// Wall-clock seconds that one stage took.
struct StageTime {
  std::string stage;   ///< its name, as Progress has it
  double seconds = 0;  ///< wall clock
};

/// What was measured of an adaptive mesh: its distance to the uniform mesh, and counts.
struct Certificate {
  double maxErrorVoxels = 0;  ///< to the uniform mesh, both ways: a bound
  /// Mean over the vertices of the uniform mesh; of an LOD that was measured to LOD 0, over those
  /// of LOD 0, and LOD 0's own mean.
  double meanErrorVoxels = 0;
  double maxErrorWorld = 0;                ///< maxErrorVoxels in world units
  std::int64_t eulerCharacteristic = 0;    ///< vertices - edges + faces
  double smallestAngle = 0;                ///< of all triangles, degrees
  std::size_t trianglesUnderMinAngle = 0;  ///< with an angle below ContourOptions::minAngle
  /// Of a cut: number of leaf cells of each octree level that the surface passes; a cell of level l
  /// has 2^l voxels along its edge.
  std::vector<std::size_t> leafLevels;
  std::vector<LeafCell> leaves;  ///< if ContourOptions::keepLeaves, in the order of their levels
  int rounds = 0;                ///< meshes made and measured until the tolerance held
};

/// What splitting triangles came to, see ExtractOptions::refine. Distances are those of the corners
/// of triangles and of the middles of their edges and their own from the trilinear surface: to
/// first order where that is within what was asked for, else along the gradient, and 1 where there
/// is no surface within a voxel.
struct Refinement {
  int rounds = 0;                   ///< of splitting edges
  std::size_t addedVertices = 0;    ///< in the middle of edges
  double largestVoxels = 0;         ///< of all triangles but crease triangles
  std::size_t trianglesLeft = 0;    ///< of these: farther than asked for, but not to be split
  std::size_t creaseTriangles = 0;  ///< left alone for a corner that stays off, as on creases
};

/// What contour() did, beside the mesh.
struct ContourReport {
  double isovalue = 0;              ///< as used
  bool insideIsBelow = true;        ///< as used
  bool distanceField = false;       ///< the field has unit gradient: creases were restored from it
  std::size_t activeVoxels = 0;     ///< of the grid
  std::size_t nonFiniteValues = 0;  ///< treated as outside
  std::size_t surfaceCells = 0;     ///< cells of eight samples that the surface passes
  std::size_t creaseCells = 0;  ///< of these, cells whose vertex was placed on a crease or corner
  std::size_t faceFlips = 0;    ///< ambiguous faces joined against the rule to stay manifold
  std::size_t openEdges = 0;    ///< sign changes where the data ends, left open
  std::optional<Certificate> certificate;  ///< of an adaptive mesh
  std::optional<Refinement> refinement;    ///< of a mesh with ExtractOptions::refine
  std::size_t intersectionsFound = 0;      ///< pairs of intersecting polygons
  std::size_t intersectionsLeft = 0;       ///< pairs that still intersect
  std::size_t movedVertices = 0;           ///< by the repair
  std::size_t flippedDiagonals = 0;        ///< split along their other diagonal by the repair
  std::size_t fannedQuads = 0;             ///< replaced by four triangles around a new vertex
  std::vector<StageTime> stages;           ///< in the order they ran
};

}  // namespace tufa
