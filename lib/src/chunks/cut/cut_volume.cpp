#include "chunks/cut/cut_volume.h"

#include <cmath>
#include <utility>

#include "chunks/cut/separate_rounded.h"
#include "refine/surface_model.h"

namespace tufa::chunks {
namespace {

// The model, which takes more memory than its mesh, is gone after that.
Mesh uniformMesh(grid::Volume volume, const ContourOptions& options, const uniform::StageEnds& ends,
                 ContourReport& report, base::Job& job) {
  refine::SurfaceModel model(std::move(volume), options, ends, job);
  report = model.report();
  return model.takeMesh();
}

}  // namespace

double latticeMove(const CutOptions& options, const grid::Affine& affine) {
  return 0.5 * std::sqrt(3.0) * options.latticeStep / affine.voxelSize();
}

CutMesh cutVolume(grid::Volume volume, const CutOptions& options, const CutEnds& ends,
                  ContourReport& report, base::Job& job) {
  const grid::Affine affine = volume.affine;
  Mesh uniform = uniformMesh(std::move(volume), options.contour, ends.uniform, report, job);
  job.beginStage("cut", ends.cut);
  CutMesh cut = cutAtChunks(std::move(uniform), affine, options.chunkSize, options.singlePrecision,
                            options.flatDistance, job);
  if (std::exchange(report.intersectionsLeft, 0) > 0) {
    cut.isNew.assign(cut.isNew.size(), 1);  // triangles of the uniform mesh intersect
    cut.isSeparated = false;
  }
  separateRounded(cut, affine, options.singlePrecision, job);
  keepApart(cut, affine, options.singlePrecision, job);
  cut.moved += latticeMove(options, affine);
  return cut;
}

}  // namespace tufa::chunks
