#include "uniform/place_vertices.h"

#include <algorithm>
#include <mutex>

#include "base/huge_pages.h"
#include "uniform/block_ranges.h"
#include "uniform/block_vertices.h"

namespace tufa::uniform {
namespace {

MeetingSheets worldSheets(const BlockVertices::Meeting& meeting, const grid::Affine& affine) {
  MeetingSheets sheets;
  sheets.count = static_cast<std::uint8_t>(meeting.count);
  for (int i = 0; i < meeting.count; ++i) {
    const Vector& n = meeting.normals[i];
    sheets.normals[i] = affine.normal(n[0], n[1], n[2]);
  }
  return sheets;
}

// A point given in voxels from the middle of a cell of a block.
Position inCell(const grid::Affine& affine, const Coord& origin, int cell, const Vector& point) {
  return affine.position(origin, (cell >> 6) + 0.5 + static_cast<double>(point[0]),
                         ((cell >> 3) & 7) + 0.5 + static_cast<double>(point[1]),
                         (cell & 7) + 0.5 + static_cast<double>(point[2]));
}

}  // namespace

VertexSheets placeVertices(const grid::Blocks& blocks, const grid::FieldScale& scale,
                           const CellTopology& topology, const grid::Affine& affine, bool normals,
                           Mesh& mesh, base::Job& job) {
  VertexSheets sheets(topology.vertexCount);
  std::mutex mutex;
  base::resizeLarge(mesh.positions, topology.vertexCount, job);
  if (normals) base::resizeLarge(mesh.normals, topology.vertexCount, job);
  job.forRanges(topology.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
    const auto accessor = blocks.accessor();
    BlockVertices work(scale);
    for (std::size_t i = begin; i < end; ++i) {
      const SurfaceBlock& block = topology.blocks[i];
      work.place(blocks, topology, block, *accessor);
      const Coord& origin = blocks.origin(block.block);
      for (std::size_t v = 0; v < work.cells().size(); ++v) {
        const int cell = work.cells()[v];
        const Vector& point = work.points()[v];
        mesh.positions[block.firstVertex + v] = inCell(affine, origin, cell, point);
        if (!normals) continue;
        const Vector& n = work.normals()[v];
        mesh.normals[block.firstVertex + v] = affine.normal(n[0], n[1], n[2]);
      }
      sheets.setKinds(block.firstVertex, work.kinds());
      for (const std::uint32_t vertex : work.outOfCell()) {
        sheets.setOutOfCell(static_cast<VertexIndex>(block.firstVertex + vertex));
      }
      if (!work.meetings().empty()) {
        const std::scoped_lock lock(mutex);
        for (const BlockVertices::Meeting& meeting : work.meetings()) {
          sheets.setMeeting(static_cast<VertexIndex>(block.firstVertex + meeting.vertex),
                            worldSheets(meeting, affine));
        }
      }
    }
  });
  return sheets;
}

FallbackPoints fallbackPoints(const grid::Blocks& blocks, const grid::FieldScale& scale,
                              const CellTopology& topology, const grid::Affine& affine,
                              const std::vector<VertexIndex>& vertices, base::Job& job) {
  FallbackPoints points{std::vector<Position>(vertices.size()),
                        std::vector<Position>(vertices.size())};
  const std::vector<BlockRange> ranges = blocksOfVertices(topology, vertices);
  job.forRanges(ranges.size(), 16, [&](std::size_t begin, std::size_t end) {
    const auto accessor = blocks.accessor();
    BlockVertices work(scale);
    std::vector<VertexIndex> wanted;
    for (std::size_t i = begin; i < end; ++i) {
      const SurfaceBlock& block = topology.blocks[ranges[i].block];
      const Coord& origin = blocks.origin(block.block);
      wanted.clear();
      for (std::size_t slot = ranges[i].begin; slot < ranges[i].end; ++slot) {
        wanted.push_back(static_cast<VertexIndex>(vertices[slot] - block.firstVertex));
      }
      work.gatherFor(wanted, blocks, topology, block, *accessor);
      for (std::size_t slot = ranges[i].begin; slot < ranges[i].end; ++slot) {
        const std::size_t vertex = vertices[slot] - block.firstVertex;
        points.plain[slot] = inCell(affine, origin, work.cells()[vertex], work.plainPoint(vertex));
        const Vector point = work.massPoint(vertex);
        points.mass[slot] =
            affine.position(origin, static_cast<double>(point[0]), static_cast<double>(point[1]),
                            static_cast<double>(point[2]));
      }
    }
  });
  return points;
}

}  // namespace tufa::uniform
