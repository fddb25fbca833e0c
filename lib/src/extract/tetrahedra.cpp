#include "extract/tetrahedra.h"

#include <utility>

#include "base/huge_pages.h"
#include "extract/block_edges.h"
#include "extract/half_places.h"
#include "extract/place_crossings.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {

using grid::BlockSamples;
using grid::kBlockSize;
using uniform::SurfaceBlock;

namespace {

// Shares of the time that stages took on the sample volumes.
constexpr double kCellsEnd = 0.2, kCasesEnd = 0.4, kVerticesEnd = 0.75, kTrianglesEnd = 0.95;

// What is known of a cell: a bit for each point that is inside, and some more.
using CellBits = std::uint32_t;
constexpr int kFirstNoCellBelow = kPoints;  // three bits
constexpr int kFirstDropped = kPoints + 3;  // three bits: no tetrahedra across that upper face
constexpr CellBits kDropped = CellBits{1} << (kFirstDropped + 3);  // no tetrahedra at all

template <class Split>
struct Lattice {
  static constexpr auto kTetrahedra = Split::kTetrahedra;
  static constexpr auto kEdges = edgesOf(kTetrahedra);
  static constexpr int kKinds = kEdges.count;
  static constexpr auto kReach = [] {
    std::array<int, kKinds> reach{};
    for (int kind = 0; kind < kKinds; ++kind) reach[kind] = kEdges.kinds[kind].reach;
    return reach;
  }();
  using Table = EdgeTable<Lattice>;
  // For each tetrahedron, what to add to the place of a cell for its edges.
  static constexpr auto kOffsets = [] {
    std::array<std::array<int, 6>, kTetrahedra.size()> offsets{};
    for (std::size_t t = 0; t < kTetrahedra.size(); ++t) {
      for (int e = 0; e < 6; ++e) {
        const EdgeOfCell& edge = kEdges.edges[t][e];
        offsets[t][e] = Table::offsetOf(edge.kind, edge.steps[0], edge.steps[1], edge.steps[2]);
      }
    }
    return offsets;
  }();
  // Whether a point at this place is one of the cell's, and which.
  static constexpr int pointAt(const HalfPlace& place) {
    for (int point = 0; point < kPoints; ++point) {
      if (kPlaces[point] == place) return point;
    }
    return -1;
  }
  static constexpr auto kEnds = [] {
    std::array<std::array<int, 2>, kKinds> ends{};
    for (int kind = 0; kind < kKinds; ++kind) {
      ends[kind] = {pointAt(kEdges.kinds[kind].from), pointAt(kEdges.kinds[kind].to)};
    }
    return ends;
  }();
  static constexpr unsigned kUsedPoints = [] {
    unsigned used = 0;
    for (const Tetrahedron& tetrahedron : kTetrahedra) {
      for (const int point : tetrahedron.points) used |= 1u << point;
    }
    return used;
  }();
  static constexpr bool kCentresBeyond = kUsedPoints >> kCentreBeyond != 0;
  static constexpr bool kCentres = kUsedPoints >> kFaceCentre != 0;
};

template <class Split>
class TetrahedraMesher {
  using L = Lattice<Split>;
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
        findEdges(block, samples, edges_[i], firstTriangle_[i]);
      }
    });
  }

  // Finds on which side the centres of surface cells are, once for all cells that ask for them.
  void findCentres() {
    insideCentres_.resize(topology_.blocks.size());
    job_.forRanges(insideCentres_.size(), 32, [&](std::size_t begin, std::size_t end) {
      constexpr PointsAround kAround{kPlaces[kCellCentre]};
      const auto accessor = volume_.blocks.accessor();
      BlockSamples samples;
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = topology_.blocks[i];
        samples.gather(volume_.blocks, volume_.scale, block.block, block.neighbours, *accessor);
        forCells(block, [&](int x, int bit) {
          const int lowest = BlockSamples::index(x, bit >> 3, bit & 7);
          if (valueAt<kAround>(samples, lowest) < 0) insideCentres_[i].set(x * 64 + bit);
        });
      }
    });
  }

  // Of the centre of a cell up to one step beyond a block, which must be a surface cell.
  bool isCentreInside(const SurfaceBlock& block, const std::array<int, 3>& at) const {
    const auto index = topology_.neighbour(block, at[0] >> 3, at[1] >> 3, at[2] >> 3);
    return insideCentres_[index].get(grid::cellIndex(at[0] & 7, at[1] & 7, at[2] & 7));
  }

  void findEdges(const SurfaceBlock& block, const BlockSamples& samples, Edges& edges,
                 std::uint64_t& triangles) {
    const grid::CornerWords corners = volume_.blocks.cornerWords(block.neighbours);
    CellBits* cellBits = bits_.data() + block.firstVertex;
    forCells(block, [&](int x, int bit) {
      const int cell = x * 64 + bit;
      const uniform::CornerMask mask = uniform::cornerMask(corners, cell);
      const CellBits bits = bitsOf(block, samples, cell, mask);
      *cellBits++ = bits;
      const int parity = parityOf(x, bit);
      [&]<int... kKind>(std::integer_sequence<int, kKind...>) {
        ((edges.crossed[kKind].slabs[x] |= isCrossed<kKind>(bits, parity) << bit), ...);
      }
      (std::make_integer_sequence<int, L::kKinds>());
      forTetrahedra(bits, parity,
                    [&](std::size_t, int inside) { triangles += kTetrahedronCases[inside].count; });
    });
    edges.countEdges();
  }

  // Whether an edge of a cell is crossed and belongs to it: 0 or 1. One to the centre below belongs
  // to the cell there, if that is a surface cell.
  template <int kKind>
  static std::uint64_t isCrossed(CellBits bits, int parity) {
    constexpr EdgeKind kEdge = L::kEdges.kinds[kKind];
    constexpr int from = L::kEnds[kKind][0], to = L::kEnds[kKind][1];
    std::uint64_t crossed = ((bits >> from) ^ (bits >> to)) & 1;
    if constexpr (kEdge.parities[0] != kEdge.parities[1]) {
      crossed &= (parity != 0) == kEdge.parities[1] ? 1 : 0;
    }
    for (int axis = 0; L::kCentresBeyond && axis < 3; ++axis) {
      const int below = kCentreBeyond + axis * 2;
      if (from == below || to == below) crossed &= bits >> (kFirstNoCellBelow + axis);
    }
    return crossed;
  }

  CellBits bitsOf(const SurfaceBlock& block, const BlockSamples& samples, int cell,
                  uniform::CornerMask mask) const {
    CellBits bits = mask;
    const std::array<int, 3> at = {cell >> 6, (cell >> 3) & 7, cell & 7};
    if constexpr (L::kCentres) {
      const int lowest = BlockSamples::index(at[0], at[1], at[2]);
      [&]<int... kCentre>(std::integer_sequence<int, kCentre...>) {
        ((bits |= bitOf<kFaceCentre + kCentre>(block, samples, lowest, at, mask)), ...);
      }
      (std::make_integer_sequence<int, kPoints - kFaceCentre>());
    }
    if constexpr (L::kCentresBeyond) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!isSurfaceCell(block, stepped(at, axis * 2))) {
          bits |= CellBits{1} << (kFirstNoCellBelow + axis);
        }
      }
    }
    if (topology_.openEdges > 0) bits |= droppedBits(block, at);
    return bits;
  }

  // Of a centre. Where all samples around it are on one side it is on that, whatever their mean is
  // rounded to.
  template <int kPoint>
  CellBits bitOf(const SurfaceBlock& block, const BlockSamples& samples, int lowest,
                 const std::array<int, 3>& at, uniform::CornerMask mask) const {
    if constexpr (((L::kUsedPoints >> kPoint) & 1) == 0) return 0;
    constexpr PointsAround kAround{kPlaces[kPoint]};
    constexpr CellBits bit = CellBits{1} << kPoint;
    if constexpr (kPoint != kCellCentre) {
      constexpr int face = (kPoint - kFaceCentre) % (kCentreBeyond - kFaceCentre);
      constexpr auto corners = uniform::kFaceCorners[face];
      constexpr unsigned all =
          1u << corners[0] | 1u << corners[1] | 1u << corners[2] | 1u << corners[3];
      const unsigned inside = mask & all;
      const bool oneSide = kPoint < kCellCentre ? inside == 0 || inside == all
                                                : !isSurfaceCell(block, stepped(at, face));
      if (oneSide) return inside != 0 ? bit : 0;
      if constexpr (kPoint > kCellCentre) {
        return isCentreInside(block, stepped(at, face)) ? bit : 0;
      }
    } else if constexpr (L::kCentresBeyond) {
      return isCentreInside(block, at) ? bit : 0;
    }
    return valueAt<kAround>(samples, lowest) < 0 ? bit : 0;
  }

  static std::array<int, 3> stepped(std::array<int, 3> at, int face) {
    at[face / 2] += (face & 1) != 0 ? 1 : -1;
    return at;
  }

  // The surface block that holds a cell up to one step beyond `block`, and its index there.
  const SurfaceBlock* blockOf(const SurfaceBlock& block, const std::array<int, 3>& at,
                              int& cell) const {
    cell = grid::cellIndex(at[0] & 7, at[1] & 7, at[2] & 7);
    const uniform::SurfaceBlockIndex index =
        topology_.neighbour(block, at[0] >> 3, at[1] >> 3, at[2] >> 3);
    return index == uniform::kNoSurfaceBlock ? nullptr : &topology_.blocks[index];
  }

  bool isSurfaceCell(const SurfaceBlock& block, const std::array<int, 3>& at) const {
    if (((at[0] | at[1] | at[2]) & ~7) == 0) {
      return block.cells.get(grid::cellIndex(at[0], at[1], at[2]));
    }
    int cell = 0;
    const SurfaceBlock* owner = blockOf(block, at, cell);
    return owner != nullptr && owner->cells.get(cell);
  }

  // Cells with open edges have no surface, nor is there one between them and others.
  CellBits droppedBits(const SurfaceBlock& block, const std::array<int, 3>& at) const {
    const auto isOpen = [&](const std::array<int, 3>& place) {
      int cell = 0;
      const SurfaceBlock* owner = blockOf(block, place, cell);
      return owner != nullptr && owner->cells.get(cell) && topology_.openEdgesOf(*owner, cell) != 0;
    };
    if (isOpen(at)) return kDropped;
    CellBits bits = 0;
    for (int axis = 0; L::kCentresBeyond && axis < 3; ++axis) {
      if (isOpen(stepped(at, axis * 2 + 1))) bits |= CellBits{1} << (kFirstDropped + axis);
    }
    return bits;
  }

  // Calls body(t, inside) for the tetrahedra of a cell that the surface passes. Written out for
  // each, which takes half of the time of a loop.
  template <class Body>
  static void forTetrahedra(CellBits bits, int parity, const Body& body) {
    if ((bits & kDropped) != 0) return;
    [&]<std::size_t... t>(std::index_sequence<t...>) {
      (visitTetrahedron<t>(bits, parity, body), ...);
    }
    (std::make_index_sequence<L::kTetrahedra.size()>());
  }

  template <std::size_t t, class Body>
  static void visitTetrahedron(CellBits bits, int parity, const Body& body) {
    constexpr Tetrahedron tetrahedron = L::kTetrahedra[t];
    constexpr auto p = tetrahedron.points;
    constexpr Where where = tetrahedron.where;
    const unsigned inside = ((bits >> p[0]) & 1) | ((bits >> p[1]) & 1) << 1 |
                            ((bits >> p[2]) & 1) << 2 | ((bits >> p[3]) & 1) << 3;
    if (inside == 0 || inside == 15) return;
    if (where == Where::EvenCells && parity != 0) return;
    if (where == Where::OddCells && parity == 0) return;
    if constexpr (where >= Where::NoCellBelow0) {
      constexpr int axis = static_cast<int>(where) - static_cast<int>(Where::NoCellBelow0);
      if (((bits >> (kFirstNoCellBelow + axis)) & 1) == 0) return;
    } else if constexpr (L::kCentresBeyond) {
      constexpr int axis = (p[1] - kCentreBeyond) / 2;
      if (((bits >> (kFirstDropped + axis)) & 1) != 0) return;
    }
    body(t, static_cast<int>(inside));
  }

  void place(Mesh& mesh) const {
    job_.forRanges(topology_.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
      const auto accessor = volume_.blocks.accessor();
      BlockSamples samples;
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = topology_.blocks[i];
        samples.gather(volume_.blocks, volume_.scale, block.block, block.neighbours, *accessor);
        auto vertex = static_cast<std::size_t>(edges_[i].first);
        const Coord& origin = volume_.blocks.origin(block.block);
        [&]<int... kKind>(std::integer_sequence<int, kKind...>) {
          (placeKind<kKind>(edges_[i], samples, origin, vertex, mesh), ...);
        }
        (std::make_integer_sequence<int, L::kKinds>());
      }
    });
  }

  template <int kKind>
  void placeKind(const Edges& edges, const BlockSamples& samples, const Coord& origin,
                 std::size_t& vertex, Mesh& mesh) const {
    const EdgePlacer<L, kKind> placer(volume_, samples);
    for (int x = 0; x < kBlockSize; ++x) {
      base::forEachBit(edges.crossed[kKind].slabs[x], [&](int bit) {
        placer.place(origin, {x, bit >> 3, bit & 7}, vertex++, mesh);
      });
    }
  }

  void emit(Mesh& mesh) const {
    const bool mirrored = volume_.affine.mirrored();
    job_.forRanges(topology_.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
      Table table;
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = topology_.blocks[i];
        table.fill(topology_, block, edges_);
        const CellBits* bits = bits_.data() + block.firstVertex;
        Triangle* triangle = mesh.triangles.data() + firstTriangle_[i];
        forCells(block, [&](int x, int bit) {
          const int at = Table::placeOf(x, bit >> 3, bit & 7);
          forTetrahedra(*bits++, parityOf(x, bit), [&](std::size_t t, int inside) {
            const TetrahedronCase& found = kTetrahedronCases[inside];
            for (int k = 0; k < found.count; ++k) {
              const auto& [a, b, c] = found.triangles[k];
              *triangle = {table[at + L::kOffsets[t][a]], table[at + L::kOffsets[t][b]],
                           table[at + L::kOffsets[t][c]]};
              if (mirrored) std::swap(triangle->vertices[1], triangle->vertices[2]);
              ++triangle;
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
  std::vector<CellBits> bits_;                  ///< of each surface cell
  std::vector<grid::BlockBits> insideCentres_;  ///< of each surface block, if L::kCentresBeyond
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
