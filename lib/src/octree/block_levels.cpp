#include "octree/block_levels.h"

#include <algorithm>
#include <cmath>

#include "base/bits.h"
#include "octree/solve_patch.h"

namespace tufa::octree {

using grid::CornerWords;
using grid::kBlockSize;
using uniform::Components;
using uniform::CornerMask;
using uniform::SurfaceBlock;
using uniform::SurfaceBlockIndex;
using Kind = uniform::VertexSheets::Kind;

namespace {

// The child of a cell at position `child` of its eight, in cells of the level below.
Coord childOf(const Coord& cell, int child) {
  return (cell << 1).offsetBy(child >> 2, (child >> 1) & 1, child & 1);
}

}  // namespace

void BlockLevelsBuilder::append(std::size_t index, BlockLevels& out) {
  for (Patches& level : levels_) {
    level.patches.clear();
    level.count.fill(0);
    level.occupied = level.safe = 0;
  }
  forbidden1_ = 0;
  readVertices(index);
  for (int level = 1; level <= ClusterForest::kBlockLevel; ++level) {
    firstCluster_[level] = static_cast<std::uint32_t>(out.levels[level - 1].clusters.size());
    buildLevel(level, level > 1 ? &out.levels[level - 2] : nullptr, out.levels[level - 1], index);
  }
  for (const std::uint32_t parent : parents_) out.parents.push_back(parent);
  const std::vector<Patch>& top = levels_[ClusterForest::kBlockLevel].patches;
  out.patches.insert(out.patches.end(), top.begin(), top.end());
}

// Builds the cells of one level in the block, from the children's patches. `below` is the level
// below as written so far; it gets its parent cells here, as an occupied cell's index is known only
// once all cells of the block are counted. A cell with a child that is not safe is not safe either,
// and gets no patches, so a refused cell costs nothing on the levels above.
void BlockLevelsBuilder::buildLevel(int level, ClusterLevel* below, ClusterLevel& out,
                                    std::size_t index) {
  const int cells = 1 << (ClusterForest::kBlockLevel - level);
  Patches& own = levels_[level];
  const Coord firstCell = base_.origin(index) >> level;
  const auto firstOfBlock = static_cast<std::uint32_t>(out.cells.size());
  for (int slot = 0; slot < cells * cells * cells; ++slot) {
    const Coord cell(slot / (cells * cells), slot / cells % cells, slot % cells);
    if (level > 1) {
      for (int child = 0; child < 8; ++child) {
        const int under = ClusterForest::slotInBlock(level - 1, childOf(cell, child));
        own.occupied |= ((levels_[level - 1].occupied >> under) & 1) << slot;
      }
    }
    if (((own.occupied >> slot) & 1) == 0) continue;
    out.first.push_back(static_cast<std::uint32_t>(out.clusters.size()));
    const bool safe = isTried(level, cell) && join(level, cell, below, out);
    own.safe |= std::uint64_t{safe} << slot;
    out.cells.push_back(firstCell + cell);
    out.safe.push_back(safe ? 1 : 0);
  }
  if (below != nullptr) {
    const int bits = ClusterForest::kBlockLevel - level;
    const std::uint64_t occupied = levels_[level - 1].occupied;
    base::forEachBit(occupied, [&](int slot) {
      const int mask = (2 << bits) - 1, shift = bits + 1;
      const Coord child(slot >> (2 * shift), (slot >> shift) & mask, slot & mask);
      const std::uint64_t before =
          base::bitsBelow(ClusterForest::slotInBlock(level, child >> 1)) & own.occupied;
      below->parentCells.push_back(firstOfBlock +
                                   static_cast<std::uint32_t>(base::countBits(before)));
    });
  }
  if (level == ClusterForest::kBlockLevel) return;
  out.occupied.push_back(own.occupied);
  out.firstInBlock.push_back(firstOfBlock);
}

// Whether a cell can be safe at all: no child is unsafe. A cell of level 1 has cells of level 0 as
// children, which are safe unless an open edge or an ambiguous face forbids it.
bool BlockLevelsBuilder::isTried(int level, const Coord& cell) const {
  if (level == 1) return ((forbidden1_ >> ClusterForest::slotInBlock(1, cell)) & 1) == 0;
  const Patches& below = levels_[level - 1];
  for (int child = 0; child < 8; ++child) {
    const int slot = ClusterForest::slotInBlock(level - 1, childOf(cell, child));
    if ((((below.occupied & ~below.safe) >> slot) & 1) != 0) return false;
  }
  return true;
}

// Joins the patches of a cell's children. If the cell is safe, adds up their planes and normals,
// links their clusters to their parents, and solves for the cell's own clusters.
bool BlockLevelsBuilder::join(int level, const Coord& cell, ClusterLevel* below,
                              ClusterLevel& out) {
  const Patches& under = levels_[level - 1];
  PatchJoiner::Children children;
  std::array<int, 8> slots{};
  for (int child = 0; child < 8; ++child) {
    slots[child] = ClusterForest::slotInBlock(level - 1, childOf(cell, child));
    const std::uint32_t count = under.count[slots[child]];
    if (count != 0) children[child] = {under.patches.data() + under.first[slots[child]], count};
  }
  if (!joiner_.join(children)) return false;
  Patches& own = levels_[level];
  const auto first = static_cast<std::uint32_t>(own.patches.size());
  const auto count = static_cast<std::uint32_t>(joiner_.patches().size());
  const int slot = ClusterForest::slotInBlock(level, cell);
  own.first[slot] = first;
  own.count[slot] = count;
  own.patches.insert(own.patches.end(), joiner_.patches().begin(), joiner_.patches().end());
  std::size_t next = 0;
  for (int child = 0; child < 8; ++child) {
    for (std::uint32_t i = 0; i < children[child].size(); ++i) {
      const std::uint32_t parent = first + joiner_.parents()[next++];
      own.patches[parent].planes += children[child][i].planes;
      if (angles_) own.patches[parent].cone.add(children[child][i].cone);
      const std::uint32_t patch = under.first[slots[child]] + i;
      std::uint32_t& link = below == nullptr
                                ? parents_[patch]
                                : below->clusters[firstCluster_[level - 1] + patch].parent;
      link = firstCluster_[level] + parent;
    }
  }
  const int size = 1 << level;
  for (std::uint32_t i = first; i < first + count; ++i) {
    out.clusters.push_back(solvePatch(own.patches[i], Vec3(cell << level), size, base_.affine));
    out.clusters.back().cell = static_cast<std::uint32_t>(out.cells.size());
  }
  return true;
}

// Makes the patches of level 0, one for each uniform vertex of the block: its planes, and its
// crossings as the lattice coordinates that tell equal ones apart. A cell with an open edge forbids
// its parent: the surface ends there, and its patch is no disk with the boundary that the safety
// test counts.
void BlockLevelsBuilder::readVertices(std::size_t index) {
  const uniform::CellTopology& topology = base_.topology;
  const SurfaceBlock& block = topology.blocks[index];
  const CornerWords corners = base_.blocks.cornerWords(block.neighbours);
  const Coord& origin = base_.origin(index);
  const bool special = block.special >= 0;
  Patches& level = levels_[0];
  auto vertex = static_cast<VertexIndex>(block.firstVertex);
  for (int x = 0; x < kBlockSize; ++x) {
    base::forEachBit(block.cells.slabs[x], [&](int bit) {
      const int cell = x * 64 + bit;
      const int y = bit >> 3, z = bit & 7;
      const std::uint64_t parent = std::uint64_t{1}
                                   << ClusterForest::slotInBlock(1, Coord(x, y, z) >> 1);
      levels_[1].occupied |= parent;
      const CornerMask mask = uniform::cornerMask(corners, cell);
      const Components components =
          special ? topology.componentsAt(block, cell, mask) : uniform::componentsOf(mask, 0);
      const unsigned cut = special ? topology.openEdgesOf(block, cell) : 0;
      if (cut != 0) forbidden1_ |= parent;
      level.first[cell] = static_cast<std::uint32_t>(level.patches.size());
      level.count[cell] = static_cast<std::uint32_t>(components.count());
      for (int i = 0; i < components.count(); ++i) {
        addVertexPlanes(vertex++, origin, level.patches.emplace_back());
      }
      const std::array<int, 3> at = {origin[0] + x, origin[1] + y, origin[2] + z};
      for (int edge = 0; edge < uniform::kEdges; ++edge) {
        if (!uniform::isCrossed(mask, edge) || ((cut >> edge) & 1) != 0) continue;
        level.patches[level.first[cell] + components.of(edge)].crossings[edge] = at[edge / 4];
      }
    });
  }
  parents_.assign(level.patches.size(), kNone);
  if (special) forbidBeside(index);
}

// One plane for a smooth vertex, one for each sheet on a crease or corner, so that coarse clusters
// keep the crease. The planes pass through the vertex, not through its crossings: coarse cells
// approximate the uniform mesh.
void BlockLevelsBuilder::addVertexPlanes(VertexIndex vertex, const Coord& origin,
                                         Patch& patch) const {
  const Vec3 point = base_.affine.latticePoint(base_.mesh.positions[vertex], origin);
  patch.planes.addPoint(point);
  const Normal& mean = base_.mesh.normals[vertex];
  const Kind kind = base_.sheets.kind(vertex);
  const bool flat = mean.x == 0 && mean.y == 0 && mean.z == 0;
  patch.cone.axis = {mean.x, mean.y, mean.z};
  if (kind == Kind::Meeting) {
    const uniform::MeetingSheets sheets = base_.sheets.sheets(base_.mesh, vertex);
    for (int i = 0; i < sheets.count; ++i) {
      patch.planes.addPlane(point, base_.affine.planeInLattice(sheets.normals[i]));
      NormalCone side;
      side.axis = {sheets.normals[i].x, sheets.normals[i].y, sheets.normals[i].z};
      if (angles_) patch.cone.add(side);
    }
    if (sheets.count > 0) return;
  }
  if (!flat) patch.planes.addPlane(point, base_.affine.planeInLattice(mean));
  if (kind < Kind::Meeting && !flat) return;
  // Several sheets that could not be told apart, or no normal: three planes hold the vertex itself.
  for (int axis = 0; axis < 3; ++axis) {
    patch.planes.addPlane(point, base_.affine.planeInLattice(Normal(
                                     axis == 0 ? 1 : 0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0)));
  }
}

// Forbids cells of level 1 beside an ambiguous face of which one component of the cell across owns
// both arcs, unless both cells have the same parent. Were the near cell merged with its siblings,
// both arcs of the face might join the same two vertices: one edge, used by four polygons. Without
// this test white noise gives such edges; the first two conditions of PatchJoiner do not see them,
// as they look at one cell alone.
void BlockLevelsBuilder::forbidBeside(std::size_t index) {
  const SurfaceBlock& block = base_.topology.blocks[index];
  const CornerWords corners = base_.blocks.cornerWords(block.neighbours);
  for (int x = 0; x < kBlockSize; ++x) {
    base::forEachBit(block.cells.slabs[x], [&](int bit) {
      const int cell = x * 64 + bit;
      const CornerMask mask = uniform::cornerMask(corners, cell);
      const uniform::FaceBits ambiguous = uniform::ambiguousFaces(mask);
      const std::array<int, 3> at = {x, bit >> 3, bit & 7};
      for (int face = 0; face < uniform::kFaces; ++face) {
        const bool betweenParents = (at[face / 2] & 1) == (face & 1);
        if (((ambiguous >> face) & 1) == 0 || !betweenParents) continue;
        if (!neighbourOwnsBothArcs(index, cell, face)) continue;
        forbidden1_ |= std::uint64_t{1}
                       << ClusterForest::slotInBlock(1, Coord(at[0], at[1], at[2]) >> 1);
      }
    });
  }
}

// Whether one component of the cell across a face, which may lie in the next block, owns both of
// its arcs.
bool BlockLevelsBuilder::neighbourOwnsBothArcs(std::size_t index, int cell, int face) const {
  const uniform::CellTopology& topology = base_.topology;
  const SurfaceBlock* owner = &topology.blocks[index];
  const int axis = face / 2, shift = 6 - 3 * axis, step = (face & 1) != 0 ? 1 : -1;
  const int along = ((cell >> shift) & 7) + step;
  int across = cell + (step << shift);
  if ((along & ~7) != 0) {
    across = cell - ((7 * step) << shift);
    const SurfaceBlockIndex next = topology.neighbour(*owner, axis == 0 ? step : 0,
                                                      axis == 1 ? step : 0, axis == 2 ? step : 0);
    if (next == uniform::kNoSurfaceBlock) return false;
    owner = &topology.blocks[next];
  }
  const CornerWords corners = base_.blocks.cornerWords(owner->neighbours);
  return topology.ownsBothArcs(*owner, across, uniform::cornerMask(corners, across), face ^ 1);
}

}  // namespace tufa::octree
