// Built as C++17: headers of VTK 9.1 are not valid C++20.

#include "flying_edges.h"

#include <openvdb/tools/Dense.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>
#include <vtkSmartPointer.h>

namespace tufa::bench {
namespace {

constexpr double kMostSamples = 5e8;

vtkSmartPointer<vtkImageData> denseCopy(const openvdb::FloatGrid& grid,
                                        const openvdb::CoordBBox& box) {
  using DenseGrid = openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ>;
  const openvdb::Coord size = box.dim();
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(size[0], size[1], size[2]);
  image->AllocateScalars(VTK_FLOAT, 1);
  DenseGrid dense(box, static_cast<float*>(image->GetScalarPointer()));
  openvdb::tools::copyToDense(grid, dense);
  return image;
}

FlyingEdgesMesh run(vtkImageData* image, double isovalue, int threads) {
  vtkSMPTools::Initialize(threads);
  vtkNew<vtkFlyingEdges3D> filter;
  filter->SetInputData(image);
  filter->SetValue(0, isovalue);
  filter->ComputeNormalsOff();
  filter->ComputeScalarsOff();
  filter->Update();
  const vtkSmartPointer<vtkPolyData> mesh = filter->GetOutput();
  return {static_cast<std::size_t>(mesh->GetNumberOfPoints()),
          static_cast<std::size_t>(mesh->GetNumberOfPolys()),
          std::make_shared<vtkSmartPointer<vtkPolyData>>(mesh)};
}

}  // namespace

std::function<FlyingEdgesMesh(int)> flyingEdgesOf(const openvdb::FloatGrid& grid, double isovalue) {
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  const openvdb::Coord size = box.dim();
  if (1.0 * size[0] * size[1] * size[2] > kMostSamples) return {};
  vtkSMPTools::SetBackend("TBB");
  return [image = denseCopy(grid, box), isovalue](int threads) {
    return run(image, isovalue, threads);
  };
}

}  // namespace tufa::bench
