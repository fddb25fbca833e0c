#pragma once

#include <tufa/contour.h>

#include <cstdint>

#include "base/job.h"
#include "grid/volume.h"
#include "uniform/cell_topology.h"
#include "uniform/surface_view.h"
#include "uniform/vertex_sheets.h"

namespace tufa::uniform {

/// The share of a call's progress that is reached at the end of each stage, 0 to 1.
struct StageEnds {
  double blocks, topology, vertices, polygons, creases, repair;
};

/// The uniform mesh of a grid, or of a box of its blocks, and all that is known of its cells.
/// Positions are counted from affine().origin(). Snapping vertices to creases may have made
/// polygons intersect; refine/uniform_repair.h removes that.
struct UniformSurface {
  grid::Volume volume;
  CellTopology topology;
  VertexSheets sheets;
  Mesh mesh;

  [[nodiscard]] const grid::Affine& affine() const { return volume.affine; }
  [[nodiscard]] SurfaceView view() const {
    return {volume.blocks, volume.scale, volume.affine, topology, sheets, mesh};
  }
};

/// Runs the stages of the uniform mesh. Throws Error(LimitExceeded) if it would have more vertices
/// than 32-bit indices can name, or more triangles.
[[nodiscard]] UniformSurface makeUniformSurface(grid::Volume volume, const ContourOptions& options,
                                                const StageEnds& ends, base::Job& job);

/// Throws Error(LimitExceeded) for more vertices than 32-bit indices can name.
void requireIndexable(std::uint64_t vertices);

/// Throws Error(LimitExceeded) for more triangles than 32 bits can number, or if there are `each`
/// of something for each of them.
void requireFaces(std::uint64_t triangles, std::uint64_t each);

/// What a report says of the cells of a surface.
[[nodiscard]] ContourReport reportOf(const grid::Volume& volume, const CellTopology& topology);

/// What a report says of a surface before anything is changed.
[[nodiscard]] ContourReport reportOf(const UniformSurface& surface);

}  // namespace tufa::uniform
