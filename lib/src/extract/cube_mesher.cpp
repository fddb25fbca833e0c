#include "extract/cube_mesher.h"

#include <bit>

#include "base/huge_pages.h"
#include "extract/place_crossings.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {

using uniform::SurfaceBlock;

namespace {

class CubeMesher {
 public:
  CubeMesher(const grid::Volume& volume, const CubeCells& cells, base::Job& job)
      : volume_(volume), cells_(cells), job_(job) {}

  Mesh run(bool normals) {
    job_.beginStage("vertices", kVerticesEnd);
    number();
    Mesh mesh;
    base::resizeLarge(mesh.positions, vertexCount_, job_);
    if (normals) base::resizeLarge(mesh.normals, vertexCount_, job_);
    placeCrossings(volume_, cells_.topology, cells_.edges, mesh, job_);
    job_.beginStage("triangles", kTrianglesEnd);
    emit(mesh);
    // Edges around which no cell is whole.
    if (cells_.topology.openEdges > 0) dropUnused(mesh, job_);
    return mesh;
  }

 private:
  // Shares of the time that stages took on the sample volumes.
  static constexpr double kVerticesEnd = 0.75, kTrianglesEnd = 0.95;

  // The numbers of what a block adds to the mesh beside the vertices on edges.
  struct First {
    std::uint64_t triangle = 0;
    std::uint64_t centre = 0;
  };

  void number() {
    vertexCount_ = cells_.edgeCount;
    first_.resize(cells_.counts.size());
    for (std::size_t i = 0; i < first_.size(); ++i) {
      job_.pollCancelled(i);
      first_[i] = {triangleCount_, vertexCount_};
      triangleCount_ += cells_.counts[i].triangles;
      vertexCount_ += cells_.counts[i].centres;
    }
    uniform::requireIndexable(vertexCount_);
  }

  void emit(Mesh& mesh) {
    base::resizeLarge(mesh.triangles, triangleCount_, job_);
    job_.forRanges(cells_.topology.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
      CubeTable table;
      for (std::size_t i = begin; i < end; ++i) {
        table.fill(cells_.topology, cells_.topology.blocks[i], cells_.edges);
        emit(cells_.topology.blocks[i], first_[i], table, mesh);
      }
    });
  }

  void emit(const SurfaceBlock& block, const First& first, const CubeTable& table, Mesh& mesh) {
    Triangle* triangle = mesh.triangles.data() + first.triangle;
    auto centre = static_cast<VertexIndex>(first.centre);
    // An odd number of mirrors turns the triangles over.
    const int second = volume_.affine.mirrored() ? 2 : 1;
    cells_.forCells(block, [&](int x, int bit, CaseCode code) {
      const CubeCase& chosen = caseOf(code);
      const int place = CubeTable::placeOf(x, bit >> 3, bit & 7);
      const auto vertexOf = [&](std::uint8_t corner) {
        return corner < kEdges ? table[place + kEdgeOffsets[corner]] : centre + (corner - kCentre);
      };
      for (int i = 0; i < chosen.count; ++i) {
        const auto& t = chosen.triangles[i];
        *triangle++ = {vertexOf(t[0]), vertexOf(t[second]), vertexOf(t[3 - second])};
      }
      for (int i = 0; i < chosen.centreCount; ++i) {
        placeCentre(chosen.aroundCentre[i], place, table, centre++, mesh);
      }
    });
  }

  const grid::Volume& volume_;
  const CubeCells& cells_;
  base::Job& job_;
  std::vector<First> first_;  ///< of each surface block
  std::uint64_t vertexCount_ = 0;
  std::uint64_t triangleCount_ = 0;
};

}  // namespace

void placeCentre(unsigned around, int place, const CubeTable& table, VertexIndex centre,
                 Mesh& mesh) {
  Vec3 sum(0), normal(0);
  int count = 0;
  base::forEachBit(around, [&](int edge) {
    const VertexIndex vertex = table[place + kEdgeOffsets[edge]];
    const Position& p = mesh.positions[vertex];
    sum += Vec3(p.x, p.y, p.z);
    ++count;
    if (mesh.normals.empty()) return;
    const Normal& n = mesh.normals[vertex];
    normal += Vec3(n.x, n.y, n.z);
  });
  sum = sum / count;
  mesh.positions[centre] = {sum[0], sum[1], sum[2]};
  if (mesh.normals.empty()) return;
  if (!normal.normalize()) {
    normal = Vec3(mesh.normals[table[place + kEdgeOffsets[std::countr_zero(around)]]]);
  }
  mesh.normals[centre] = {static_cast<float>(normal[0]), static_cast<float>(normal[1]),
                          static_cast<float>(normal[2])};
}

Mesh meshCubes(const grid::Volume& volume, const CubeRule& rule, const ContourOptions& options,
               ContourReport& report, base::Job& job) {
  const CubeCells cells = chooseCases(volume, rule, options.cap, job);
  report = uniform::reportOf(volume, cells.topology);
  return CubeMesher(volume, cells, job).run(options.normals == Normals::Gradient);
}

}  // namespace tufa::extraction
