#include "extract/cube_mesher.h"

#include <algorithm>

#include "base/huge_pages.h"
#include "extract/place_crossings.h"
#include "grid/samples.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {

using grid::BlockSamples;
using grid::kBlockSize;
using uniform::SurfaceBlock;

namespace {

using Edges = BlockEdges<CubeLattice::kKinds>;
using Table = EdgeTable<CubeLattice>;

// Shares of the time that stages took on the sample volumes.
constexpr double kCellsEnd = 0.25, kCasesEnd = 0.4, kVerticesEnd = 0.75, kTrianglesEnd = 0.95;

// What to add to the place of a cell for each of its edges.
constexpr auto kOffsets = [] {
  std::array<int, kEdges> offsets{};
  for (int edge = 0; edge < kEdges; ++edge) {
    const int lower = uniform::edgeCorners(edge)[0];
    offsets[edge] = Table::offsetOf(edge / 4, lower >> 2, (lower >> 1) & 1, lower & 1);
  }
  return offsets;
}();

CornerValues valuesAt(const BlockSamples& samples, int cell) {
  CornerValues values;
  const int lowest = BlockSamples::index(cell >> 6, (cell >> 3) & 7, cell & 7);
  for (int corner = 0; corner < kCorners; ++corner) {
    values[corner] = samples[lowest + (corner >> 2) * BlockSamples::kStrideX +
                             ((corner >> 1) & 1) * BlockSamples::kStrideY + (corner & 1)];
  }
  return values;
}

// What a block adds to the mesh beside the vertices of its edges.
struct BlockCells {
  std::uint64_t firstTriangle = 0;
  std::uint64_t firstCentre = 0;  ///< number of its first vertex inside a cell
  std::uint32_t triangles = 0;
  std::uint32_t centres = 0;
};

class CubeMesher {
 public:
  CubeMesher(const grid::Volume& volume, const CubeRule& rule, const ContourOptions& options,
             base::Job& job)
      : volume_(volume), rule_(rule), options_(options), job_(job) {}

  Mesh run(ContourReport& report) {
    job_.beginStage("cells", kCellsEnd);
    topology_ = uniform::findSurfaceCells(volume_.blocks, volume_.scale, options_.cap, job_);
    report = uniform::reportOf(volume_, topology_);
    job_.beginStage("cases", kCasesEnd);
    chooseCases();
    number();
    job_.beginStage("vertices", kVerticesEnd);
    Mesh mesh;
    base::resizeLarge(mesh.positions, vertexCount_, job_);
    if (options_.normals == Normals::Gradient) {
      base::resizeLarge(mesh.normals, vertexCount_, job_);
    }
    placeCrossings(volume_, topology_, edges_, mesh, job_);
    job_.beginStage("triangles", kTrianglesEnd);
    emit(mesh);
    // Edges around which no cell is whole.
    if (topology_.openEdges > 0) dropUnused(mesh, job_);
    return mesh;
  }

 private:
  template <class Body>
  void forBlocks(const Body& body) {
    job_.forRanges(topology_.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(topology_.blocks[i], i);
    });
  }

  void chooseCases() {
    const std::size_t count = topology_.blocks.size();
    base::resizeLarge(edges_, count, job_);
    base::resizeLarge(codes_, topology_.cellCount, job_);
    cells_.resize(count);
    job_.forRanges(count, 32, [&](std::size_t begin, std::size_t end) {
      const auto accessor = volume_.blocks.accessor();
      for (std::size_t i = begin; i < end; ++i) {
        const grid::CornerWords corners =
            volume_.blocks.cornerWords(topology_.blocks[i].neighbours);
        findEdges(topology_.blocks[i], corners, edges_[i]);
        chooseCases(topology_.blocks[i], corners, cells_[i], *accessor);
      }
    });
  }

  void findEdges(const SurfaceBlock& block, const grid::CornerWords& corners, Edges& edges) const {
    for (int x = 0; x < kBlockSize; ++x) {
      const auto crossed = uniform::crossedEdges(corners, x);
      for (int axis = 0; axis < 3; ++axis) {
        const std::uint64_t open =
            block.special < 0 ? 0 : topology_.specials[block.special].cut[axis].slabs[x];
        edges.crossed[axis].slabs[x] = crossed[axis] & ~open;
      }
    }
    edges.countEdges();
  }

  void chooseCases(const SurfaceBlock& block, const grid::CornerWords& corners, BlockCells& cells,
                   grid::Accessor& accessor) {
    CaseCode* code = codes_.data() + block.firstVertex;
    const bool mayBeOpen = topology_.openEdges > 0;
    BlockSamples samples;
    bool gathered = false;
    for (int x = 0; x < kBlockSize; ++x) {
      base::forEachBit(block.cells.slabs[x], [&](int bit) {
        const int cell = x * 64 + bit;
        const CornerMask mask = uniform::cornerMask(corners, cell);
        *code = rule_.codes[mask];
        if (mayBeOpen && topology_.openEdgesOf(block, cell) != 0) {
          *code = 0;
        } else if (rule_.asks[mask]) {
          if (!gathered) {
            samples.gather(volume_.blocks, volume_.scale, block.block, block.neighbours, accessor);
          }
          gathered = true;
          *code = rule_.decide(mask, valuesAt(samples, cell));
        }
        const CubeCase& chosen = caseOf(*code++);
        cells.triangles += chosen.count;
        cells.centres += chosen.centreCount;
      });
    }
  }

  void number() {
    vertexCount_ = numberEdges(edges_, job_);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      job_.pollCancelled(i);
      cells_[i].firstTriangle = triangleCount_;
      cells_[i].firstCentre = vertexCount_;
      triangleCount_ += cells_[i].triangles;
      vertexCount_ += cells_[i].centres;
    }
    uniform::requireIndexable(vertexCount_);
  }

  void emit(Mesh& mesh) {
    base::resizeLarge(mesh.triangles, triangleCount_, job_);
    job_.forRanges(topology_.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
      Table table;
      for (std::size_t i = begin; i < end; ++i) {
        table.fill(topology_, topology_.blocks[i], edges_);
        emit(topology_.blocks[i], cells_[i], table, mesh);
      }
    });
  }

  void emit(const SurfaceBlock& block, const BlockCells& cells, const Table& table, Mesh& mesh) {
    const CaseCode* code = codes_.data() + block.firstVertex;
    Triangle* triangle = mesh.triangles.data() + cells.firstTriangle;
    auto centre = static_cast<VertexIndex>(cells.firstCentre);
    // An odd number of mirrors turns the triangles over.
    const int second = volume_.affine.mirrored() ? 2 : 1;
    for (int x = 0; x < kBlockSize; ++x) {
      base::forEachBit(block.cells.slabs[x], [&](int bit) {
        const CubeCase& chosen = caseOf(*code++);
        const int place = Table::placeOf(x, bit >> 3, bit & 7);
        const auto vertexOf = [&](std::uint8_t corner) {
          return corner < kEdges ? table[place + kOffsets[corner]] : centre + (corner - kCentre);
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
  }

  // The mean of the crossings around it.
  static void placeCentre(std::uint16_t around, int place, const Table& table, VertexIndex centre,
                          Mesh& mesh) {
    Vec3 sum(0), normal(0);
    int count = 0;
    base::forEachBit(around, [&](int edge) {
      const VertexIndex vertex = table[place + kOffsets[edge]];
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
    if (!normal.normalize()) normal = Vec3(0);
    mesh.normals[centre] = {static_cast<float>(normal[0]), static_cast<float>(normal[1]),
                            static_cast<float>(normal[2])};
  }

  const grid::Volume& volume_;
  const CubeRule& rule_;
  const ContourOptions& options_;
  base::Job& job_;
  uniform::CellTopology topology_;
  std::vector<Edges> edges_;
  std::vector<BlockCells> cells_;
  std::vector<CaseCode> codes_;  ///< of each surface cell
  std::uint64_t vertexCount_ = 0;
  std::uint64_t triangleCount_ = 0;
};

}  // namespace

Mesh meshCubes(const grid::Volume& volume, const CubeRule& rule, const ContourOptions& options,
               ContourReport& report, base::Job& job) {
  return CubeMesher(volume, rule, options, job).run(report);
}

}  // namespace tufa::extraction
