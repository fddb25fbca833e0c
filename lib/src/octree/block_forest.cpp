#include "octree/block_forest.h"

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
using Kind = uniform::VertexSides::Kind;

BlockForest BlockForestBuilder::build(std::size_t index, BlockGroup& group) {
  forest_ = {};
  for (auto* clusters : {&clusters1_, &clusters2_, &clusters3_}) clusters->clear();
  for (Patches& level : levels_) {
    level.patches.clear();
    level.count.fill(0);
  }
  forbidden1_ = 0;
  readVertices(index);
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) {
      for (int z = 0; z < 4; ++z) {
        const std::uint64_t bit = std::uint64_t{1} << cellIndex1(x, y, z);
        if ((forest_.surface1 & bit) == 0 || (forbidden1_ & bit) != 0) continue;
        if (tryCell(1, x, y, z, clusters1_)) forest_.safe1 |= bit;
      }
    }
  }
  for (int cell = 0; cell < 8; ++cell) {
    const int x = cell >> 2, y = (cell >> 1) & 1, z = cell & 1;
    std::uint64_t children = 0;
    for (int child = 0; child < 8; ++child) {
      children |= std::uint64_t{1} << cellIndex1(2 * x + (child >> 2), 2 * y + ((child >> 1) & 1),
                                                 2 * z + (child & 1));
    }
    children &= forest_.surface1;
    if (children == 0) continue;
    forest_.surface2 |= static_cast<std::uint8_t>(1 << cell);
    if ((children & ~forest_.safe1) != 0) continue;
    if (tryCell(2, x, y, z, clusters2_)) forest_.safe2 |= static_cast<std::uint8_t>(1 << cell);
  }
  safe3_ = forest_.safe2 == forest_.surface2 && tryCell(3, 0, 0, 0, clusters3_);
  forest_.vertices = static_cast<std::uint16_t>(parents_.size());
  forest_.clusters1 = static_cast<std::uint16_t>(clusters1_.size());
  forest_.clusters2 = static_cast<std::uint16_t>(clusters2_.size());
  forest_.firstVertex = static_cast<std::uint32_t>(group.parents.size());
  forest_.firstCluster = static_cast<std::uint32_t>(group.clusters.size());
  group.parents.insert(group.parents.end(), parents_.begin(), parents_.end());
  group.clusters.insert(group.clusters.end(), clusters1_.begin(), clusters1_.end());
  group.clusters.insert(group.clusters.end(), clusters2_.begin(), clusters2_.end());
  return forest_;
}

void BlockForestBuilder::readVertices(std::size_t index) {
  const uniform::Topology& topology = base_.topology;
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
      const std::uint64_t parent = std::uint64_t{1} << cellIndex1(x >> 1, y >> 1, z >> 1);
      forest_.surface1 |= parent;
      const CornerMask mask = uniform::cornerMask(corners, cell);
      const Components components =
          special ? topology.componentsAt(block, cell, mask) : uniform::componentsOf(mask, 0);
      const unsigned cut = special ? topology.cutEdgesOf(block, cell) : 0;
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
  parents_.assign(level.patches.size(), BlockGroup::kNoParent);
  if (special) forbidBeside(index);
}

void BlockForestBuilder::addVertexPlanes(VertexIndex vertex, const Coord& origin,
                                         Patch& patch) const {
  const Vec3 point = base_.affine.latticePoint(base_.mesh.positions[vertex], origin);
  patch.planes.addPoint(point);
  const Normal& mean = base_.mesh.normals[vertex];
  const Kind kind = base_.sides.kind(vertex);
  const bool flat = mean.x == 0 && mean.y == 0 && mean.z == 0;
  patch.cone.axis = {mean.x, mean.y, mean.z};
  if (kind == Kind::Meeting) {
    const uniform::MeetingSides sides = base_.sides.sides(base_.mesh, vertex);
    for (int i = 0; i < sides.count; ++i) {
      patch.planes.addPlane(point, base_.affine.planeInLattice(sides.normals[i]));
      NormalCone side;
      side.axis = {sides.normals[i].x, sides.normals[i].y, sides.normals[i].z};
      if (angles_) patch.cone.add(side);
    }
    if (sides.count > 0) return;
  }
  if (!flat) patch.planes.addPlane(point, base_.affine.planeInLattice(mean));
  if (kind < Kind::Meeting && !flat) return;
  // Several sides that could not be told apart: the vertex itself must be kept.
  for (int axis = 0; axis < 3; ++axis) {
    patch.planes.addPlane(point, base_.affine.planeInLattice(Normal(
                                     axis == 0 ? 1 : 0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0)));
  }
}

// A component that owns both arcs of an ambiguous face forbids the cell across that face to
// collapse, unless both have one parent: the two pieces of the face would become one edge, used
// twice.
void BlockForestBuilder::forbidBeside(std::size_t index) {
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
        forbidden1_ |= std::uint64_t{1} << cellIndex1(at[0] >> 1, at[1] >> 1, at[2] >> 1);
      }
    });
  }
}

bool BlockForestBuilder::neighbourOwnsBothArcs(std::size_t index, int cell, int face) const {
  const uniform::Topology& topology = base_.topology;
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

void BlockForestBuilder::setParent(int level, std::uint32_t patch, std::uint32_t parent) {
  if (level == 0) parents_[patch] = static_cast<std::uint16_t>(parent);
  if (level == 1) clusters1_[patch].parent = parent;
  if (level == 2) clusters2_[patch].parent = parent;
}

bool BlockForestBuilder::tryCell(int level, int x, int y, int z, std::vector<Cluster>& clusters) {
  const Patches& below = levels_[level - 1];
  PatchJoiner::Children children;
  std::array<int, 8> slots{};
  for (int child = 0; child < 8; ++child) {
    slots[child] =
        slot(level - 1, 2 * x + (child >> 2), 2 * y + ((child >> 1) & 1), 2 * z + (child & 1));
    const std::uint32_t count = below.count[slots[child]];
    if (count != 0) children[child] = {below.patches.data() + below.first[slots[child]], count};
  }
  if (!joiner_.join(children)) return false;
  Patches& here = levels_[level];
  const int own = slot(level, x, y, z);
  const auto first = static_cast<std::uint32_t>(here.patches.size());
  here.first[own] = first;
  here.count[own] = static_cast<std::uint32_t>(joiner_.patches().size());
  here.patches.insert(here.patches.end(), joiner_.patches().begin(), joiner_.patches().end());
  std::size_t next = 0;
  for (int child = 0; child < 8; ++child) {
    for (std::uint32_t i = 0; i < children[child].size(); ++i) {
      const std::uint32_t parent = first + joiner_.parents()[next++];
      here.patches[parent].planes += children[child][i].planes;
      if (angles_) here.patches[parent].cone.add(children[child][i].cone);
      setParent(level - 1, below.first[slots[child]] + i, parent);
    }
  }
  const int size = 1 << level;
  const Vec3 corner(x * size, y * size, z * size);
  for (std::uint32_t i = 0; i < here.count[own]; ++i) {
    clusters.push_back(solvePatch(here.patches[first + i], corner, size, base_.affine));
    clusters.back().cell = static_cast<std::uint16_t>(own);
  }
  return true;
}

}  // namespace tufa::octree
