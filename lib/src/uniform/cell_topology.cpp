#include "uniform/cell_topology.h"

#include <algorithm>

#include "base/bits.h"
#include "uniform/ambiguity.h"

namespace tufa::uniform {

using grid::CornerWords;

CornerMask cornerMask(const CornerWords& corners, int cell) {
  const int x = cell >> 6;
  const int bit = cell & 63;
  unsigned mask = 0;
  for (int corner = 0; corner < kCorners; ++corner) {
    mask |= static_cast<unsigned>((corners.words[x + (corner >> 2)][corner & 3] >> bit) & 1)
            << corner;
  }
  return static_cast<CornerMask>(mask);
}

std::array<std::uint64_t, 3> crossedEdges(const CornerWords& corners, int x) {
  const auto& here = corners.words[x];
  return {here[0] ^ corners.words[x + 1][0], here[0] ^ here[2], here[0] ^ here[1]};
}

// The rank of the cell among the surface cells, and what cells before it have beyond one vertex.
bool CellTopology::isOpenAt(const SurfaceBlock& block) const {
  if (openEdges == 0) return false;
  for (int n = 0; n < 27; ++n) {
    const SurfaceBlockIndex index = neighbour(block, n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    if (index != kNoSurfaceBlock && blocks[index].special >= 0) return true;
  }
  return false;
}

std::uint32_t CellTopology::firstVertexInBlock(const SurfaceBlock& block, int cell) const {
  const int slab = cell >> 6;
  const std::uint64_t before = block.cells.slabs[slab] & base::bitsBelow(cell & 63);
  const auto rank = static_cast<std::uint32_t>(block.cellsBefore[slab] + base::countBits(before));
  if (block.special < 0) return rank;
  const SpecialBlock& special = specials[block.special];
  const auto next = std::lower_bound(
      special.exceptions.begin(), special.exceptions.end(), cell,
      [](const CellException& exception, int wanted) { return exception.cell < wanted; });
  const std::int32_t extra = next == special.exceptions.end() ? special.extra : next->extraBefore;
  return rank + static_cast<std::uint32_t>(extra);
}

namespace {

struct Step {
  int dx, dy, dz;
};

// Finds the special block that holds the lattice point at a step from a cell, which may be one past
// the end of the block on each axis, and its index there. Null where nothing is special.
const SpecialBlock* specialAt(const CellTopology& topology, const SurfaceBlock& block, int cell,
                              Step step, int& local) {
  const int x = (cell >> 6) + step.dx, y = ((cell >> 3) & 7) + step.dy, z = (cell & 7) + step.dz;
  local = grid::cellIndex(x & 7, y & 7, z & 7);
  const SurfaceBlock* owner = &block;
  if (((x | y | z) & 8) != 0) {
    const SurfaceBlockIndex index = topology.neighbour(block, x >> 3, y >> 3, z >> 3);
    if (index == kNoSurfaceBlock) return nullptr;
    owner = &topology.blocks[index];
  }
  return owner->special < 0 ? nullptr : &topology.specials[owner->special];
}

}  // namespace

FaceBits CellTopology::faceBits(const SurfaceBlock& block, int cell) const {
  unsigned bits = 0;
  for (int face = 0; face < kFaces; ++face) {
    const int axis = face / 2;
    const int up = face & 1;
    int local = 0;
    const SpecialBlock* special = specialAt(
        *this, block, cell, {axis == 0 ? up : 0, axis == 1 ? up : 0, axis == 2 ? up : 0}, local);
    if (special != nullptr && special->joined[axis].get(local)) bits |= 1u << face;
  }
  return static_cast<FaceBits>(bits);
}

unsigned CellTopology::openEdgesOf(const SurfaceBlock& block, int cell) const {
  if (openEdges == 0) return 0;
  unsigned bits = 0;
  for (int edge = 0; edge < kEdges; ++edge) {
    const int corner = edgeCorners(edge)[0];
    int local = 0;
    const SpecialBlock* special =
        specialAt(*this, block, cell, {corner >> 2, (corner >> 1) & 1, corner & 1}, local);
    if (special != nullptr && special->cut[edge / 4].get(local)) bits |= 1u << edge;
  }
  return bits;
}

Components CellTopology::componentsAt(const SurfaceBlock& block, int cell, CornerMask mask) const {
  const FaceBits ambiguous = ambiguousFaces(mask);
  const FaceBits joined =
      ambiguous == 0 ? FaceBits{0} : static_cast<FaceBits>(faceBits(block, cell) & ambiguous);
  const unsigned cut = openEdgesOf(block, cell);
  return cut == 0 ? componentsOf(mask, joined) : joinCrossings(mask, joined, cut);
}

// The two arcs cut off the inside corners of the face, or the outside ones if the inside ones are
// joined.
bool CellTopology::ownsBothArcs(const SurfaceBlock& block, int cell, CornerMask mask,
                                int face) const {
  const unsigned cut = openEdgesOf(block, cell);
  const auto& edges = kFaceEdges[face];
  const FaceBits joined = faceBits(block, cell) & ambiguousFaces(mask);
  const Components components =
      cut == 0 ? componentsOf(mask, joined) : joinCrossings(mask, joined, cut);
  const bool cutOffInside = ((joined >> face) & 1) == 0;
  const int first = isInside(mask, kFaceCorners[face][0]) == cutOffInside ? 0 : 1;
  // An arc belongs to the component of either of its ends that is not open.
  const auto ownerOf = [&](int a, int b) {
    if (((cut >> a) & 1) == 0) return components.of(a);
    return ((cut >> b) & 1) == 0 ? components.of(b) : -1;
  };
  const int owner = ownerOf(edges[(first + 3) % 4], edges[first]);
  return owner >= 0 && owner == ownerOf(edges[first + 1], edges[first + 2]);
}

}  // namespace tufa::uniform
