#include "contenders.h"

#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <array>

#include "flying_edges.h"

namespace tufa::bench {
namespace {

Contender tufaUniform(const openvdb::FloatGrid& grid) {
  return {"tufa", [&grid](int threads) {
            ContourOptions options;
            options.uniform = true;
            options.threads = threads;
            ContourReport report;
            const auto mesh = std::make_shared<Mesh>(contour(grid, options, &report));
            return Outcome{mesh->positions.size(), mesh->triangleCount(), report.stages, mesh};
          }};
}

struct VolumeToMeshResult {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
};

Contender volumeToMesh(const openvdb::FloatGrid& grid, double adaptivity, std::string name) {
  return {std::move(name), [&grid, adaptivity](int threads) {
            const auto mesh = std::make_shared<VolumeToMeshResult>();
            tbb::task_arena arena(threads);
            arena.execute([&] {
              openvdb::tools::volumeToMesh(grid, mesh->points, mesh->triangles, mesh->quads, 0.0,
                                           adaptivity);
            });
            return Outcome{
                mesh->points.size(), mesh->triangles.size() + 2 * mesh->quads.size(), {}, mesh};
          }};
}

// In sixteen lanes, which compilers turn into vector additions.
float sumOf(const float* values) {
  std::array<float, 16> lanes{};
  for (std::size_t i = 0; i < openvdb::FloatTree::LeafNodeType::SIZE; i += 16) {
    for (std::size_t lane = 0; lane < 16; ++lane) lanes[lane] += values[i + lane];
  }
  float sum = 0;
  for (const float lane : lanes) sum += lane;
  return sum;
}

}  // namespace

std::vector<Contender> contendersFor(const openvdb::FloatGrid& grid) {
  std::vector<Contender> all = {tufaUniform(grid), volumeToMesh(grid, 0, "volumeToMesh")};
  if (const auto run = flyingEdgesOf(grid)) {
    all.push_back({"vtkFlyingEdges3D on a dense copy", [run](int threads) {
                     const FlyingEdgesMesh mesh = run(threads);
                     return Outcome{mesh.vertices, mesh.triangles, {}, mesh.made};
                   }});
  }
  return all;
}

Contender floorFor(const openvdb::FloatGrid& grid) {
  using Leaf = openvdb::FloatTree::LeafNodeType;
  const auto leaves = std::make_shared<std::vector<const Leaf*>>();
  grid.tree().getNodes(*leaves);
  return {"one read of all leaf values", [leaves](int threads) {
            using Range = tbb::blocked_range<std::size_t>;
            const auto sum = std::make_shared<float>();
            tbb::task_arena arena(threads);
            arena.execute([&] {
              *sum = tbb::parallel_reduce(
                  Range(0, leaves->size(), 64), 0.0F,
                  [&](const Range& range, float before) {
                    for (std::size_t i = range.begin(); i < range.end(); ++i) {
                      before += sumOf((*leaves)[i]->buffer().data());
                    }
                    return before;
                  },
                  [](float a, float b) { return a + b; });
            });
            return Outcome{0, 0, {}, sum};
          }};
}

}  // namespace tufa::bench
