#include "octree/cut_polygons.h"

#include <algorithm>

#include "base/huge_pages.h"

#include "uniform/diagonal.h"

namespace tufa::octree {
namespace {

constexpr std::size_t kChunk = 4096;

void placeVertices(const ClusterForest& forest, const Cut& cut, const Mesh& base,
                   const grid::Affine& affine, Mesh& mesh, base::Job& job) {
  base::resizeLarge(mesh.positions, cut.clusters.size(), job);
  base::resizeLarge(mesh.normals, cut.clusters.size(), job);
  job.forRanges(cut.clusters.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const ClusterRef& ref = cut.clusters[i];
      if (ref.level == 0) {
        mesh.positions[i] = base.positions[ref.cluster];
        mesh.normals[i] = base.normals[ref.cluster];
        continue;
      }
      const ClusterLevel& level = forest.at(ref.level);
      const Cluster& cluster = level.clusters[ref.cluster];
      const double half = 0.5 * (1 << ref.level);
      const auto& p = cluster.point;
      mesh.positions[i] =
          affine.position(level.corner(cluster.cell), half + static_cast<double>(p[0]),
                          half + static_cast<double>(p[1]), half + static_cast<double>(p[2]));
      mesh.normals[i] = {cluster.normal[0], cluster.normal[1], cluster.normal[2]};
    }
  });
}

// The distinct vertices of the cut around a uniform quad, in order. Equal ones are neighbours: two
// opposite cells around an edge lie in one leaf only if all four do.
struct Polygon {
  std::array<VertexIndex, 4> vertices;
  int count = 0;
};

Polygon polygonOf(const Cut& cut, const Quad& quad) {
  Polygon polygon;
  for (const VertexIndex base : quad.vertices) {
    const VertexIndex vertex = cut.vertexOf[base];
    if (polygon.count == 0 || polygon.vertices[polygon.count - 1] != vertex) {
      polygon.vertices[polygon.count++] = vertex;
    }
  }
  if (polygon.count > 1 && polygon.vertices[0] == polygon.vertices[polygon.count - 1]) {
    --polygon.count;
  }
  return polygon;
}

// The point that a uniform quad stands for: the middle of its better diagonal, with the normal of
// the quad.
uniform::LatticeCrossing middleOf(const Mesh& base, const Quad& quad, double voxelSize) {
  Vec3 p[4];
  for (int i = 0; i < 4; ++i) {
    const Position& at = base.positions[quad.vertices[i]];
    p[i] = {at.x, at.y, at.z};
  }
  Vec3 outward = (p[2] - p[0]).cross(p[3] - p[1]);
  if (!outward.normalize()) outward = Vec3(0);
  return {(p[0] + p[2]) * 0.5, outward * voxelSize};
}

void startAtBetterDiagonal(const Mesh& mesh, const Mesh& base, const Quad& source, double voxelSize,
                           Quad& quad) {
  const uniform::SplitChooser chooser(mesh, quad, voxelSize);
  if (!chooser.isSecondDiagonalBetter([&] { return middleOf(base, source, voxelSize); })) return;
  std::rotate(quad.vertices.begin(), quad.vertices.begin() + 1, quad.vertices.end());
}

struct Counts {
  std::size_t quads = 0, triangles = 0;
};

}  // namespace

CutMesh meshCut(const ClusterForest& forest, const Cut& cut, const Mesh& base,
                const grid::Affine& affine, base::Job& job) {
  return meshCut(forest, cut, base, base.quads, affine, job);
}

CutMesh meshCut(const ClusterForest& forest, const Cut& cut, const Mesh& base,
                const std::vector<Quad>& quads, const grid::Affine& affine, base::Job& job) {
  CutMesh result;
  Mesh& mesh = result.mesh;
  placeVertices(forest, cut, base, affine, mesh, job);
  // Two passes over the quads, one to count and one to write, with a prefix sum between: polygons
  // keep the order of the quads for any number of threads.
  const std::size_t chunks = (quads.size() + kChunk - 1) / kChunk;
  std::vector<Counts> before(chunks + 1);
  const auto forChunk = [&](std::size_t chunk, const auto& body) {
    const std::size_t end = std::min((chunk + 1) * kChunk, quads.size());
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      const Polygon polygon = polygonOf(cut, quads[i]);
      if (polygon.count >= 3) body(i, polygon);
    }
  };
  job.forRanges(chunks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
      Counts& counts = before[chunk + 1];
      forChunk(chunk, [&](std::size_t, const Polygon& polygon) {
        ++(polygon.count == 4 ? counts.quads : counts.triangles);
      });
    }
  });
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
    before[chunk + 1].quads += before[chunk].quads;
    before[chunk + 1].triangles += before[chunk].triangles;
  }
  base::resizeLarge(mesh.quads, before[chunks].quads, job);
  base::resizeLarge(mesh.triangles, before[chunks].triangles, job);
  base::resizeLarge(result.quadSources, before[chunks].quads, job);
  base::resizeLarge(result.triangleSources, before[chunks].triangles, job);
  job.forRanges(chunks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
      Counts next = before[chunk];
      forChunk(chunk, [&](std::size_t source, const Polygon& polygon) {
        const auto& v = polygon.vertices;
        if (polygon.count == 3) {
          result.triangleSources[next.triangles] = static_cast<std::uint32_t>(source);
          mesh.triangles[next.triangles++] = {v[0], v[1], v[2]};
          return;
        }
        Quad& quad = mesh.quads[next.quads] = {v[0], v[1], v[2], v[3]};
        result.quadSources[next.quads++] = static_cast<std::uint32_t>(source);
        const bool unchanged = std::all_of(v.begin(), v.end(), [&](VertexIndex vertex) {
          return cut.clusters[vertex].level == 0;
        });
        if (!unchanged) {
          startAtBetterDiagonal(mesh, base, quads[source], affine.voxelSize(), quad);
        }
      });
    }
  });
  return result;
}

}  // namespace tufa::octree
