#pragma once

#include <tufa/contour.h>
#include <tufa/contour_report.h>

#include "base/job.h"
#include "chunks/cut/cut_mesh.h"
#include "grid/affine.h"
#include "grid/volume.h"
#include "uniform/uniform_surface.h"

namespace tufa::chunks {

/// How a volume's uniform mesh is made and cut.
struct CutOptions {
  ContourOptions contour;  ///< with gradient normals and repair
  int chunkSize = 0;       ///< voxels
  bool singlePrecision = true;
  double flatDistance = 0;  ///< of faces that lie along planes, see cutAtChunks()
  double latticeStep = 0;  ///< of the lattice that positions will be moved to, world units; 0: none
};

/// The farthest that a vertex moves to the lattice, voxels.
[[nodiscard]] double latticeMove(const CutOptions& options, const grid::Affine& affine);

/// The share of a call's progress that is reached at the end of each stage.
struct CutEnds {
  uniform::StageEnds uniform;
  double cut;
};

/// The uniform mesh of a volume, without self-intersections, divided into chunks. `report`: what
/// was found, without the times of stages. Throws Error as contour() does.
[[nodiscard]] CutMesh cutVolume(grid::Volume volume, const CutOptions& options, const CutEnds& ends,
                                ContourReport& report, base::Job& job);

}  // namespace tufa::chunks
