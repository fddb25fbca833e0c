#include "contenders.h"

#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <array>

#include "flying_edges.h"

namespace tufa::bench {
namespace {

ContourOptions uniform() {
  ContourOptions options;
  options.uniform = true;
  return options;
}

ContourOptions cut() {
  ContourOptions options;
  options.simplify = false;
  return options;
}

Outcome runTufa(const openvdb::FloatGrid& grid, ContourOptions options, int threads) {
  options.threads = threads;
  ContourReport report;
  const auto mesh = std::make_shared<Mesh>(contour(grid, options, &report));
  return {mesh->positions.size(), mesh->triangleCount(), report.stages, mesh};
}

Outcome runMethod(const openvdb::FloatGrid& grid, Method method, int threads) {
  ExtractOptions options;
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

Outcome runVolumeToMesh(const openvdb::FloatGrid& grid, double adaptivity, int threads) {
  const auto mesh = std::make_shared<VolumeToMeshResult>();
  tbb::task_arena arena(threads);
  arena.execute([&] {
    openvdb::tools::volumeToMesh(grid, mesh->points, mesh->triangles, mesh->quads, 0.0, adaptivity);
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

void addFlyingEdges(const openvdb::FloatGrid& grid, std::size_t peer, std::vector<Contender>& all) {
  const auto run = flyingEdgesOf(grid);
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

std::vector<Contender> methodsFor(const openvdb::FloatGrid& grid) {
  constexpr std::size_t kVolumeToMesh = 0, kMarchingCubes = 1;
  std::vector<Contender> all = {{"volumeToMesh, adaptivity 0", kVolumeToMesh,
                                 [&](int threads) { return runVolumeToMesh(grid, 0, threads); }}};
  for (const std::string_view name : methodNames()) {
    const Method method = *methodByName(name);
    if (method == Method::Dual) continue;
    const std::size_t peer = method == Method::MarchingCubes ? kVolumeToMesh : kMarchingCubes;
    all.push_back({nameOf(method), peer,
                   [&grid, method](int threads) { return runMethod(grid, method, threads); }});
  }
  addFlyingEdges(grid, kMarchingCubes, all);
  return all;
}

std::vector<Contender> contendersFor(const openvdb::FloatGrid& grid) {
  constexpr std::size_t kUniformPeer = 1, kAdaptivePeer = 3;
  std::vector<Contender> all = {{"tufa, uniform", kUniformPeer,
                                 [&](int threads) { return runTufa(grid, uniform(), threads); }},
                                {"volumeToMesh, adaptivity 0", kUniformPeer,
                                 [&](int threads) { return runVolumeToMesh(grid, 0, threads); }},
                                {"tufa, tolerance 0.1", kAdaptivePeer,
                                 [&](int threads) { return runTufa(grid, {}, threads); }},
                                {"volumeToMesh, adaptivity 0.25", kAdaptivePeer,
                                 [&](int threads) { return runVolumeToMesh(grid, 0.25, threads); }},
                                {"tufa, tolerance 0.1, --fast", kAdaptivePeer,
                                 [&](int threads) { return runTufa(grid, cut(), threads); }}};
  addFlyingEdges(grid, kUniformPeer, all);
  all.push_back(readOfAllLeaves(grid, kUniformPeer));
  return all;
}

}  // namespace tufa::bench
