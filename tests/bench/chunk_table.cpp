// What chunks cost beside a chain of the same tolerances. Prints a Markdown table:
// tufa_chunk_table [--voxels N] [--chunk SIZE...] SHAPE|MESH|VDB...
//
// Triangles are those of all chunks at one LOD, over those of the chain's level; slivers have an
// angle under 10 degrees. The ends of curves are the vertices that chunks keep at every LOD, and
// the least number is that of the shortest polylines through vertices of the cut mesh that are
// within the tolerance of its curves.

#include <openvdb/openvdb.h>

#include <tufa/chunks.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/shapes.h>
#include <tufa/voxelize.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "table_text.h"

namespace {

using namespace tufa;
using bench::number;

constexpr double kSliverCosine = 0.98480775301;  // of 10 degrees

double cpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

openvdb::GridBase::Ptr volumeOf(const std::string& name, int voxels) {
  if (const auto shape = shapeByName(name)) {
    ShapeOptions options;
    options.voxelSize = 3.0 / voxels;
    return makeShape(*shape, options);
  }
  const std::filesystem::path path(name);
  if (path.extension() == ".vdb") return readGrid(path);
  const Mesh mesh = readMesh(path);
  openvdb::BBoxd box;
  for (const Position& p : mesh.positions) box.expand(openvdb::Vec3d(p.x, p.y, p.z));
  VoxelizeOptions options;
  options.voxelSize = box.extents()[static_cast<int>(box.maxExtent())] / voxels;
  options.exactDistances = false;  // as other programs make volumes of meshes
  return voxelize(mesh, options);
}

struct Count {
  std::size_t triangles = 0, slivers = 0;

  void add(const std::vector<Position>& positions, const std::vector<Triangle>& all) {
    for (const Triangle& t : all) {
      openvdb::Vec3d p[3];
      for (std::size_t i = 0; i < 3; ++i) {
        const Position& at = positions[t.vertices[i]];
        p[i] = {at.x, at.y, at.z};
      }
      bool isSliver = false;
      for (std::size_t i = 0; i < 3; ++i) {
        const openvdb::Vec3d a = p[(i + 1) % 3] - p[i], b = p[(i + 2) % 3] - p[i];
        isSliver |= !(a.dot(b) < kSliverCosine * a.length() * b.length());
      }
      ++triangles, slivers += isSliver ? 1 : 0;
    }
  }
  [[nodiscard]] double share() const {
    return 100.0 * static_cast<double>(slivers) /
           static_cast<double>(std::max<std::size_t>(triangles, 1));
  }
};

struct LevelCount {
  Count own, beside;  ///< beside: with all strips to the next LOD
  std::size_t pairs = 0;
  std::set<std::array<double, 3>> onCurves, ends;
  std::size_t closed = 0;  ///< curves, on the lower faces of chunks so that each counts once

  void add(const ChunkLevel& level, std::size_t intersections) {
    own.add(level.positions, level.interior);
    beside.add(level.positions, level.interior);
    pairs += intersections;
    for (std::size_t face = 0; face < kChunkFaces; ++face) {
      own.add(level.positions, level.regular[face]);
      beside.add(level.positions, level.transition[face]);
      for (const ChunkSeam& seam : level.seams[face]) {
        const auto placeOf = [&](VertexIndex v) {
          const Position& p = level.positions[v];
          return std::array{p.x, p.y, p.z};
        };
        for (const VertexIndex v : seam.vertices) onCurves.insert(placeOf(v));
        if (seam.closed) {
          closed += face % 2 == 0 ? 1 : 0;
          continue;
        }
        ends.insert(placeOf(seam.vertices.front()));
        ends.insert(placeOf(seam.vertices.back()));
      }
    }
  }
};

using Curve = std::vector<openvdb::Vec3d>;

// The curves of the cut mesh, each once; closed ones have their first vertex at both ends.
std::vector<Curve> finestCurves(const openvdb::GridBase& grid, int chunkSize) {
  ChunkOptions options;
  options.chunkSize = chunkSize;
  options.levels = 1;
  options.contour.tolerance = 1e-6;  // nothing is reduced
  std::vector<Curve> curves;
  (void)buildChunks(grid, options, [&](const ChunkIndex&, Chunk&& chunk) {
    for (std::size_t face = 0; face < kChunkFaces; face += 2) {
      for (const ChunkSeam& seam : chunk.levels[0].seams[face]) {
        Curve& curve = curves.emplace_back();
        for (const VertexIndex v : seam.vertices) {
          const Position& p = chunk.levels[0].positions[v];
          curve.emplace_back(p.x, p.y, p.z);
        }
        if (seam.closed) curve.push_back(curve.front());
      }
    }
  });
  return curves;
}

double distance(const openvdb::Vec3d& p, const openvdb::Vec3d& a, const openvdb::Vec3d& b) {
  const openvdb::Vec3d d = b - a;
  const double along = d.lengthSqr() > 0 ? std::clamp((p - a).dot(d) / d.lengthSqr(), 0.0, 1.0) : 0;
  return (p - a - d * along).length();
}

// Inner vertices of the shortest polyline through vertices of a curve, from its start to its end.
std::size_t leastVertices(const Curve& curve, double tolerance) {
  std::vector<std::size_t> edges(curve.size(), 0);
  for (std::size_t i = 1; i < curve.size(); ++i) {
    edges[i] = edges[i - 1] + 1;
    for (std::size_t j = i - 1; j-- > 0;) {
      if (edges[j] + 1 >= edges[i]) continue;
      bool isNear = true;
      for (std::size_t k = j + 1; k < i && isNear; ++k) {
        isNear = distance(curve[k], curve[j], curve[i]) <= tolerance;
      }
      if (isNear) edges[i] = edges[j] + 1;
    }
  }
  const bool isClosed = curve.front() == curve.back();
  return isClosed ? std::max<std::size_t>(edges.back(), 3) : edges.back() - 1;
}

std::vector<LevelCount> countsOf(const openvdb::GridBase& grid, int chunkSize, double& seconds) {
  ChunkOptions options;
  options.chunkSize = chunkSize;
  std::vector<std::vector<ChunkLevel>> chunks;
  const double start = cpuSeconds();
  const ChunkIndex index = buildChunks(grid, options, [&](const ChunkIndex&, Chunk&& chunk) {
    chunks.push_back(std::move(chunk.levels));
  });
  seconds = cpuSeconds() - start;
  std::vector<LevelCount> counts(index.tolerances.size());
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      counts[i].add(chunks[c][i], index.chunks[c].levels[i].intersectionsLeft);
    }
  }
  return counts;
}

// Triangles of a closed surface of a mesh's topology that has so many vertices: by Euler's formula,
// as each triangle has three half edges.
std::size_t leastTriangles(std::size_t vertices, const Mesh& mesh) {
  const std::size_t triangles = triangulate(mesh).size();
  // Vertices that others part from a crease's other side count once.
  std::set<std::array<double, 3>> places;
  for (const Position& p : mesh.positions) places.insert({p.x, p.y, p.z});
  const auto twiceEuler =
      2 * static_cast<std::ptrdiff_t>(places.size()) - static_cast<std::ptrdiff_t>(triangles);
  return static_cast<std::size_t>(
      std::max<std::ptrdiff_t>(0, 2 * static_cast<std::ptrdiff_t>(vertices) - twiceEuler));
}

void print(const std::string& volume, int voxels, const std::vector<int>& chunkSizes) {
  const openvdb::GridBase::Ptr grid = volumeOf(volume, voxels);
  LodOptions lods;
  lods.levels = ChunkOptions().levels;
  const double start = cpuSeconds();
  const LodChain chain = buildLods(*grid, lods);
  const double chainSeconds = cpuSeconds() - start;
  const std::string name = std::filesystem::path(volume).stem().string();
  for (const int chunkSize : chunkSizes) {
    double seconds = 0;
    const std::vector<LevelCount> counts = countsOf(*grid, chunkSize, seconds);
    const std::vector<Curve> curves = finestCurves(*grid, chunkSize);
    for (std::size_t i = 0; i < chain.levels.size(); ++i) {
      Count whole;
      const Mesh& mesh = chain.levels[i].mesh;
      whole.add(mesh.positions, triangulate(mesh));
      const LevelCount& level = counts[i];
      std::size_t least = level.ends.size();
      for (const Curve& curve : curves) {
        least += leastVertices(curve, chain.levels[i].tolerance * grid->voxelSize()[0]);
      }
      std::cout << "| " << name << " | " << chunkSize << " | " << i << " | " << whole.triangles
                << " | " << level.own.triangles << " | "
                << number("%.2f", static_cast<double>(level.own.triangles) /
                                      static_cast<double>(whole.triangles))
                << " | " << number("%.1f", whole.share()) << ", "
                << number("%.1f", level.own.share()) << ", " << number("%.1f", level.beside.share())
                << " | " << level.onCurves.size() << ", " << least << ", " << level.ends.size()
                << ", " << level.closed << " | " << leastTriangles(least, mesh) << ", "
                << leastTriangles(level.ends.size() + 3 * level.closed, mesh) << " | "
                << level.pairs << " | " << number("%.2f", seconds / chainSeconds) << " |"
                << std::endl;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares chunks with a chain of the same tolerances. Prints a Markdown table.");
  std::vector<std::string> volumes;
  std::vector<int> chunkSizes{64, 16};
  int voxels = 150;
  app.add_option("VOLUME", volumes, "shapes, mesh files to voxelize, or level sets in .vdb files")
      ->required();
  app.add_option("--voxels", voxels, "along a mesh's longest side; shapes have two thirds")
      ->capture_default_str();
  app.add_option("--chunk", chunkSizes, "voxels along an edge of a chunk")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  openvdb::initialize();
  std::cout
      << "| volume | chunk | LOD | chain | chunks | ratio | slivers, %: chain, chunks, beside "
         "the next LOD | vertices on curves, least number, ends, closed curves | triangles of as "
         "many "
         "vertices as the least number, as ends and 3 of each closed curve | pairs | CPU time over "
         "the "
         "chain's |\n"
         "| --- | ---: | ---: | ---: | ---: | ---: | --- | --- | --- | ---: | ---: |\n";
  try {
    for (const std::string& volume : volumes) print(volume, voxels, chunkSizes);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
