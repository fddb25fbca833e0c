#include "extract/tetrahedra.h"

#include <memory>
#include <utility>

#include "base/huge_pages.h"
#include "extract/place_crossings.h"
#include "extract/point_table.h"
#include "extract/tetrahedra_lattice.h"
#include "uniform/crossings.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {

using grid::BlockBits;
using grid::BlockSamples;
using grid::kBlockSize;
using uniform::SurfaceBlock;

namespace {

template <class Split>
class TetrahedraMesher {
  using L = TetrahedraLattice<Split>;
  using Points = PointTable<L>;
  using Edges = BlockEdges<L::kKinds>;
  using Table = typename L::Table;

 public:
  TetrahedraMesher(const grid::Volume& volume, const ContourOptions& options, base::Job& job)
      : volume_(volume), options_(options), job_(job) {}

  Mesh run(ContourReport& report) {
    job_.beginStage("cells", kCellsEnd);
    topology_ = uniform::findSurfaceCells(volume_.blocks, volume_.scale, options_.cap, job_);
    report = uniform::reportOf(volume_, topology_);
    job_.beginStage("cases", kCasesEnd);
    findEdges();
    const std::uint64_t vertices = numberEdges(edges_, job_);
    uniform::requireIndexable(vertices);
    std::uint64_t triangles = 0;
    for (std::uint64_t& first : firstTriangle_) triangles += std::exchange(first, triangles);
    job_.beginStage("vertices", kVerticesEnd);
    Mesh mesh;
    base::resizeLarge(mesh.positions, vertices, job_);
    if (options_.normals == Normals::Gradient) base::resizeLarge(mesh.normals, vertices, job_);
    place(mesh);
    job_.beginStage("triangles", kTrianglesEnd);
    base::resizeLarge(mesh.triangles, triangles, job_);
    emit(mesh);
    if (topology_.openEdges > 0) dropUnused(mesh, job_);
    return mesh;
  }

 private:
  // Shares of the time that stages took on the sample volumes.
  static constexpr double kCellsEnd = 0.2, kCasesEnd = 0.4, kVerticesEnd = 0.75,
                          kTrianglesEnd = 0.95;

  // 1 for cells whose coordinates have an odd sum; blocks start at even ones.
  static int parityOf(int x, int bit) { return (x + (bit >> 3) + (bit & 7)) & 1; }

  // Calls body(x, bit) for each surface cell of a block.
  template <class Body>
  static void forCells(const SurfaceBlock& block, const Body& body) {
    for (int x = 0; x < kBlockSize; ++x) {
      base::forEachBit(block.cells.slabs[x], [&](int bit) { body(x, bit); });
    }
  }

  void findEdges() {
    const std::size_t count = topology_.blocks.size();
    base::resizeLarge(edges_, count, job_);
    base::resizeLarge(bits_, topology_.cellCount, job_);
    firstTriangle_.assign(count, 0);
    if constexpr (L::kCentresBeyond) findCentres();
    job_.forRanges(count, 32, [&](std::size_t begin, std::size_t end) {
      const auto accessor = volume_.blocks.accessor();
      BlockSamples samples;
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = topology_.blocks[i];
        if constexpr (L::kCentres && !L::kCentresBeyond) {
          samples.gather(volume_.blocks, volume_.scale, block.block, block.neighbours, *accessor);
        }
        findEdges(block, i, samples);
      }
    });
  }

  // Finds on which side the centres of surface cells are, once for all cells that ask for them.
  void findCentres() {
    insideCentres_.resize(topology_.blocks.size());
    job_.forRanges(insideCentres_.size(), 32, [&](std::size_t begin, std::size_t end) {
      const auto accessor = volume_.blocks.accessor();
      BlockSamples samples;
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = topology_.blocks[i];
        samples.gather(volume_.blocks, volume_.scale, block.block, block.neighbours, *accessor);
        insideCentres_[i] = centresInside(block, samples);
      }
    });
  }

  // For each point of the cells of a block a bit a cell.
  struct Sides {
    std::array<BlockBits, kPoints> inside;
    std::array<BlockBits, 3> noCellBelow;  ///< no surface cell
  };

  void findEdges(const SurfaceBlock& block, std::size_t index, const BlockSamples& samples) {
    const grid::CornerWords corners = volume_.blocks.cornerWords(block.neighbours);
    Sides sides;
    findSides(block, corners, index, samples, sides);
    [&]<int... kKind>(std::integer_sequence<int, kKind...>) {
      (findEdges<kKind>(sides, block.cells, edges_[index]), ...);
    }
    (std::make_integer_sequence<int, L::kKinds>());
    edges_[index].countEdges();
    CellBits* cellBits = bits_.data() + block.firstVertex;
    forCells(block, [&](int x, int bit) {
      const CellBits bits = bitsOf(sides, x, bit, uniform::cornerMask(corners, x * 64 + bit)) |
                            droppedBits(block, {x, bit >> 3, bit & 7});
      *cellBits++ = bits;
      L::forGroups(bits, parityOf(x, bit),
                   [&](const typename L::Case& found) { firstTriangle_[index] += found.count; });
    });
  }

  // Finds the crossed edges of a kind. One to the centre below belongs to the cell there, if that
  // is a surface cell.
  template <int kKind>
  static void findEdges(const Sides& sides, const BlockBits& cells, Edges& edges) {
    constexpr EdgeKind kEdge = L::kEdges.kinds[kKind];
    constexpr int from = L::kEnds[kKind][0], to = L::kEnds[kKind][1];
    for (int x = 0; x < kBlockSize; ++x) {
      std::uint64_t crossed =
          (sides.inside[from].slabs[x] ^ sides.inside[to].slabs[x]) & cells.slabs[x];
      if constexpr (kEdge.parities[0] != kEdge.parities[1]) {
        constexpr std::uint64_t kOdd = 0x55aa55aa55aa55aau;  // of even x
        crossed &= ((x & 1) != 0) == kEdge.parities[1] ? ~kOdd : kOdd;
      }
      for (int axis = 0; L::kCentresBeyond && axis < 3; ++axis) {
        const int below = kCentreBeyond + axis * 2;
        if (from == below || to == below) crossed &= sides.noCellBelow[axis].slabs[x];
      }
      edges.crossed[kKind].slabs[x] = crossed;
    }
  }

  static CellBits bitsOf(const Sides& sides, int x, int bit, uniform::CornerMask mask) {
    CellBits bits = mask;
    [&]<int... i>(std::integer_sequence<int, i...>) {
      ((bits |= bitOf<kFaceCentre + i>(sides, x, bit)), ...);
    }
    (std::make_integer_sequence<int, kPoints - kFaceCentre>());
    for (int axis = 0; L::kCentresBeyond && axis < 3; ++axis) {
      const std::uint64_t none = sides.noCellBelow[axis].slabs[x] >> bit & 1;
      bits |= static_cast<CellBits>(none << (kFirstNoCellBelow + axis));
    }
    return bits;
  }
  template <int kPoint>
  static CellBits bitOf(const Sides& sides, int x, int bit) {
    if constexpr ((L::kUsedPoints >> kPoint & 1) == 0) return 0;
    return static_cast<CellBits>((sides.inside[kPoint].slabs[x] >> bit & 1) << kPoint);
  }

  // Of all points. Where all samples around one are on one side it is on that, whatever their mean
  // is rounded to.
  void findSides(const SurfaceBlock& block, const grid::CornerWords& corners, std::size_t index,
                 const BlockSamples& samples, Sides& sides) const {
    for (int corner = 0; corner < uniform::kCorners; ++corner) {
      for (int x = 0; x < kBlockSize; ++x) {
        sides.inside[corner].slabs[x] = corners.words[x + (corner >> 2)][corner & 3];
      }
    }
    if constexpr (L::kFaceCentres) {
      findFaceSides<0>(samples, sides);
      findFaceSides<1>(samples, sides);
      findFaceSides<2>(samples, sides);
    }
    if constexpr (L::kCentresBeyond) {
      sides.inside[kCellCentre] = insideCentres_[index];
      for (int face = 0; face < uniform::kFaces; ++face) {
        findSidesBeyond(block, face, insideCentres_[index], sides);
      }
    } else if constexpr (L::kCentres) {
      sides.inside[kCellCentre] = centresInside(block, samples);
    }
  }

  // Of the centres of the faces across an axis.
  template <int kAxis>
  static void findFaceSides(const BlockSamples& samples, Sides& sides) {
    constexpr std::uint64_t kAll = ~std::uint64_t{0}, kLastY = std::uint64_t{0xff} << 56,
                            kLastZ = 0x8080808080808080u;
    BlockBits& lower = sides.inside[kFaceCentre + 2 * kAxis];
    BlockBits& upper = sides.inside[kFaceCentre + 2 * kAxis + 1];
    for (int x = 0; x < kBlockSize; ++x) {
      lower.slabs[x] = faceSides<2 * kAxis>(samples, sides, x, kAll);
    }
    constexpr int kUpper = 2 * kAxis + 1;
    for (int x = 0; x < kBlockSize; ++x) {
      std::uint64_t& slab = upper.slabs[x];
      if constexpr (kAxis == 0) {
        slab = x + 1 < kBlockSize ? lower.slabs[x + 1] : faceSides<kUpper>(samples, sides, x, kAll);
      } else if constexpr (kAxis == 1) {
        slab = grid::stepY(lower.slabs[x], 0) | faceSides<kUpper>(samples, sides, x, kLastY);
      } else {
        slab = grid::stepZ(lower.slabs[x], 0) | faceSides<kUpper>(samples, sides, x, kLastZ);
      }
    }
  }
  template <int kFace>
  static std::uint64_t faceSides(const BlockSamples& samples, const Sides& sides, int x,
                                 std::uint64_t among) {
    constexpr PointsAround kAround{kPlaces[kFaceCentre + kFace]};
    std::uint64_t all = among, any = 0;
    for (const int corner : uniform::kFaceCorners[kFace]) {
      all &= sides.inside[corner].slabs[x];
      any |= sides.inside[corner].slabs[x];
    }
    base::forEachBit(any & ~all & among, [&](int bit) {
      const int lowest = BlockSamples::index(x, bit >> 3, bit & 7);
      if (valueAt<kAround>(samples, lowest) < 0) all |= std::uint64_t{1} << bit;
    });
    return all;
  }

  // Of the centres of surface cells.
  static BlockBits centresInside(const SurfaceBlock& block, const BlockSamples& samples) {
    constexpr PointsAround kAround{kPlaces[kCellCentre]};
    BlockBits inside;
    forCells(block, [&](int x, int bit) {
      const int lowest = BlockSamples::index(x, bit >> 3, bit & 7);
      if (valueAt<kAround>(samples, lowest) < 0) inside.set(x * 64 + bit);
    });
    return inside;
  }

  // Of the centres of the cells beyond a face. One of no surface cell is on the side of its
  // corners.
  void findSidesBeyond(const SurfaceBlock& block, int face, const BlockBits& own,
                       Sides& sides) const {
    const std::array<int, 3> step = stepped({0, 0, 0}, face);
    const auto index = topology_.neighbour(block, step[0], step[1], step[2]);
    const bool none = index == uniform::kNoSurfaceBlock;
    const BlockBits nextCells = none ? BlockBits{} : topology_.blocks[index].cells;
    const BlockBits nextCentres = none ? BlockBits{} : insideCentres_[index];
    for (int x = 0; x < kBlockSize; ++x) {
      const std::uint64_t isCell = beyond(block.cells, nextCells, face, x);
      const std::uint64_t corner = sides.inside[uniform::kFaceCorners[face][0]].slabs[x];
      sides.inside[kCentreBeyond + face].slabs[x] =
          (isCell & beyond(own, nextCentres, face, x)) | (~isCell & corner);
      if ((face & 1) == 0) sides.noCellBelow[face / 2].slabs[x] = ~isCell;
    }
  }
  // The bits of the cells beyond a face of those of a slab, of a block and the next one there.
  static std::uint64_t beyond(const BlockBits& own, const BlockBits& next, int face, int x) {
    constexpr std::uint64_t kFirstZ = 0x0101010101010101u;
    const std::uint64_t here = own.slabs[x], there = next.slabs[x];
    switch (face) {
      case 0:
        return x > 0 ? own.slabs[x - 1] : next.slabs[kBlockSize - 1];
      case 1:
        return x + 1 < kBlockSize ? own.slabs[x + 1] : next.slabs[0];
      case 2:
        return here << 8 | there >> 56;
      case 3:
        return grid::stepY(here, there);
      case 4:
        return (here << 1 & ~kFirstZ) | (there >> 7 & kFirstZ);
      default:
        return grid::stepZ(here, there);
    }
  }

  static std::array<int, 3> stepped(std::array<int, 3> at, int face) {
    at[face / 2] += (face & 1) != 0 ? 1 : -1;
    return at;
  }

  // Cells with open edges have no surface, nor is there one between them and others.
  CellBits droppedBits(const SurfaceBlock& block, const std::array<int, 3>& at) const {
    if (topology_.openEdges == 0) return 0;
    const auto isOpen = [&](const std::array<int, 3>& place) {
      const auto index = topology_.neighbour(block, place[0] >> 3, place[1] >> 3, place[2] >> 3);
      if (index == uniform::kNoSurfaceBlock) return false;
      const SurfaceBlock& owner = topology_.blocks[index];
      const int cell = grid::cellIndex(place[0] & 7, place[1] & 7, place[2] & 7);
      return owner.cells.get(cell) && topology_.openEdgesOf(owner, cell) != 0;
    };
    if (isOpen(at)) return kDropped;
    CellBits bits = 0;
    for (int axis = 0; L::kCentresBeyond && axis < 3; ++axis) {
      if (isOpen(stepped(at, axis * 2 + 1))) bits |= CellBits{1} << (kFirstDropped + axis);
    }
    return bits;
  }

  void place(Mesh& mesh) const {
    job_.forRanges(topology_.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
      const auto accessor = volume_.blocks.accessor();
      BlockSamples samples;
      const auto points = std::make_unique<Points>();
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = topology_.blocks[i];
        samples.gather(volume_.blocks, volume_.scale, block.block, block.neighbours, *accessor);
        points->fill(samples, block.cells);
        auto vertex = static_cast<std::size_t>(edges_[i].first);
        const Coord& origin = volume_.blocks.origin(block.block);
        [&]<int... kKind>(std::integer_sequence<int, kKind...>) {
          (placeKind<kKind>(edges_[i].crossed[kKind], *points, origin, vertex, mesh), ...);
        }
        (std::make_integer_sequence<int, L::kKinds>());
      }
    });
  }

  // Places the crossings of edges of a kind by linear interpolation, their normals by that of the
  // gradients at both ends. Where it vanishes beside the rise along the edge, the normal is along
  // the edge.
  template <int kKind>
  void placeKind(const BlockBits& crossed, const Points& points, const Coord& origin,
                 std::size_t& vertex, Mesh& mesh) const {
    constexpr EdgeKind kEdge = L::kEdges.kinds[kKind];
    constexpr int from = Points::offsetOf(kEdge.from), to = Points::offsetOf(kEdge.to);
    using Finder = uniform::CrossingFinder;
    for (int x = 0; x < kBlockSize; ++x) {
      base::forEachBit(crossed.slabs[x], [&](int bit) {
        const std::array<int, 3> cell = {x, bit >> 3, bit & 7};
        const int lowest = BlockSamples::index(cell[0], cell[1], cell[2]);
        const float first = points.value(lowest + from), last = points.value(lowest + to);
        const float along = Finder::keptOffEnds(Finder::linearRoot(first, last));
        std::array<double, 3> at;
        for (int axis = 0; axis < 3; ++axis) {
          const int step = kEdge.to[axis] - kEdge.from[axis];
          at[axis] = cell[axis] + 0.5 * (kEdge.from[axis] + step * static_cast<double>(along));
        }
        mesh.positions[vertex] = volume_.affine.position(origin, at[0], at[1], at[2]);
        if (!mesh.normals.empty()) {
          const float rise = last - first;
          uniform::Vector g, edge;
          for (int i = 0; i < 3; ++i) {
            const float lower = points.gradient(i, lowest + from);
            g[i] = lower + along * (points.gradient(i, lowest + to) - lower);
            edge[i] = static_cast<float>(kEdge.to[i] - kEdge.from[i]) * (rise > 0 ? 1.0F : -1.0F);
          }
          if (!(uniform::dot(g, g) > 1e-12F * rise * rise)) g = edge;
          mesh.normals[vertex] = volume_.affine.normal(g[0], g[1], g[2]);
        }
        ++vertex;
      });
    }
  }

  void emit(Mesh& mesh) const {
    const int second = volume_.affine.mirrored() ? 2 : 1;
    job_.forRanges(topology_.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
      Table table;
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = topology_.blocks[i];
        table.fill(topology_, block, edges_);
        const CellBits* bits = bits_.data() + block.firstVertex;
        Triangle* triangle = mesh.triangles.data() + firstTriangle_[i];
        forCells(block, [&](int x, int bit) {
          const int at = Table::placeOf(x, bit >> 3, bit & 7);
          L::forGroups(*bits++, parityOf(x, bit), [&](const typename L::Case& found) {
            for (int k = 0; k < found.count; ++k) {
              const auto& t = found.triangles[k];
              *triangle++ = {table[at + t[0]], table[at + t[second]], table[at + t[3 - second]]};
            }
          });
        });
      }
    });
  }

  const grid::Volume& volume_;
  const ContourOptions& options_;
  base::Job& job_;
  uniform::CellTopology topology_;
  std::vector<Edges> edges_;
  std::vector<CellBits> bits_;            ///< of each surface cell
  std::vector<BlockBits> insideCentres_;  ///< of each surface block, if L::kCentresBeyond
  std::vector<std::uint64_t> firstTriangle_;
};

}  // namespace

Mesh meshTetrahedra(const grid::Volume& volume, Method method, const ContourOptions& options,
                    ContourReport& report, base::Job& job) {
  switch (method) {
    case Method::MarchingTetrahedra5:
      return TetrahedraMesher<SplitInFive>(volume, options, job).run(report);
    case Method::MarchingTetrahedra24:
      return TetrahedraMesher<SplitInTwentyFour>(volume, options, job).run(report);
    case Method::BodyCentred:
      return TetrahedraMesher<BodyCentred>(volume, options, job).run(report);
    default:
      return TetrahedraMesher<SplitInSix>(volume, options, job).run(report);
  }
}

}  // namespace tufa::extraction
