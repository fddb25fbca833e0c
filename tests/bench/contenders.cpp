#include "contenders.h"

#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <array>

#include "flying_edges.h"

namespace tufa::bench {
namespace {

ContourOptions adaptive(double isovalue) {
  ContourOptions options;
  options.isovalue = isovalue;
  return options;
}

ContourOptions uniform(double isovalue) {
  ContourOptions options = adaptive(isovalue);
  options.uniform = true;
  return options;
}

ContourOptions cut(double isovalue) {
  ContourOptions options = adaptive(isovalue);
  options.simplify = false;
  return options;
}

Outcome runTufa(const openvdb::FloatGrid& grid, ContourOptions options, int threads) {
  options.threads = threads;
  ContourReport report;
  const auto mesh = std::make_shared<Mesh>(contour(grid, options, &report));
  return {mesh->positions.size(), mesh->triangleCount(), report.stages, mesh};
}

Outcome runMethod(const openvdb::FloatGrid& grid, Method method, double isovalue, int threads) {
  ExtractOptions options;
  options.contour.isovalue = isovalue;
  options.contour.threads = threads;
  ContourReport report;
  const auto mesh = std::make_shared<Mesh>(extract(grid, method, options, &report));
  return {mesh->positions.size(), mesh->triangleCount(), report.stages, mesh};
}

struct VolumeToMeshResult {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
};

Outcome runVolumeToMesh(const openvdb::FloatGrid& grid, double isovalue, double adaptivity,
                        int threads) {
  const auto mesh = std::make_shared<VolumeToMeshResult>();
  tbb::task_arena arena(threads);
  arena.execute([&] {
    openvdb::tools::volumeToMesh(grid, mesh->points, mesh->triangles, mesh->quads, isovalue,
                                 adaptivity);
  });
  return {mesh->points.size(), mesh->triangles.size() + 2 * mesh->quads.size(), {}, mesh};
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

Contender readOfAllLeaves(const openvdb::FloatGrid& grid, std::size_t peer) {
  using Leaf = openvdb::FloatTree::LeafNodeType;
  const auto leaves = std::make_shared<std::vector<const Leaf*>>();
  grid.tree().getNodes(*leaves);
  return {"one read of all leaf values", peer, [leaves](int threads) {
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

void addFlyingEdges(const openvdb::FloatGrid& grid, double isovalue, std::size_t peer,
                    std::vector<Contender>& all) {
  const auto run = flyingEdgesOf(grid, isovalue);
  if (!run) return;
  all.push_back({"vtkFlyingEdges3D on a dense copy", peer, [run](int threads) {
                   const FlyingEdgesMesh mesh = run(threads);
                   return Outcome{mesh.vertices, mesh.triangles, {}, mesh.made};
                 }});
}

}  // namespace

std::string nameOf(Method method) {
  return "tufa, " + std::string(methodNames().at(static_cast<std::size_t>(method)));
}

std::vector<Contender> methodsFor(const openvdb::FloatGrid& grid, double isovalue) {
  constexpr std::size_t kVolumeToMesh = 0, kMarchingCubes = 1;
  std::vector<Contender> all = {
      {"volumeToMesh, adaptivity 0", kVolumeToMesh,
       [&grid, isovalue](int threads) { return runVolumeToMesh(grid, isovalue, 0, threads); }}};
  for (const std::string_view name : methodNames()) {
    const Method method = *methodByName(name);
    if (method == Method::Dual) continue;
    const std::size_t peer = method == Method::MarchingCubes ? kVolumeToMesh : kMarchingCubes;
    all.push_back({nameOf(method), peer, [&grid, method, isovalue](int threads) {
                     return runMethod(grid, method, isovalue, threads);
                   }});
  }
  addFlyingEdges(grid, isovalue, kMarchingCubes, all);
  return all;
}

std::vector<Contender> contendersFor(const openvdb::FloatGrid& grid, double isovalue) {
  constexpr std::size_t kUniformPeer = 1, kAdaptivePeer = 3;
  const auto tufa = [&grid](const ContourOptions& options) {
    return [&grid, options](int threads) { return runTufa(grid, options, threads); };
  };
  const auto volumeToMesh = [&grid, isovalue](double adaptivity) {
    return [&grid, isovalue, adaptivity](int threads) {
      return runVolumeToMesh(grid, isovalue, adaptivity, threads);
    };
  };
  std::vector<Contender> all = {
      {"tufa, uniform", kUniformPeer, tufa(uniform(isovalue))},
      {"volumeToMesh, adaptivity 0", kUniformPeer, volumeToMesh(0)},
      {"tufa, tolerance 0.1", kAdaptivePeer, tufa(adaptive(isovalue))},
      {"volumeToMesh, adaptivity 0.25", kAdaptivePeer, volumeToMesh(0.25)},
      {"tufa, tolerance 0.1, --fast", kAdaptivePeer, tufa(cut(isovalue))}};
  addFlyingEdges(grid, isovalue, kUniformPeer, all);
  all.push_back(readOfAllLeaves(grid, kUniformPeer));
  return all;
}

}  // namespace tufa::bench
