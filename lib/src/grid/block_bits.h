#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/bits.h"

namespace tufa::grid {

/// Lattice points (or cells) along one edge of a block; equal to OpenVDB's leaf size.
inline constexpr int kBlockSize = 8;
inline constexpr int kBlockCells = kBlockSize * kBlockSize * kBlockSize;

/// One bit for each of a block's 512 lattice points or cells: slab x holds bit y * 8 + z. That is
/// the order of OpenVDB's leaf values and masks.
struct BlockBits {
  std::array<std::uint64_t, kBlockSize> slabs{};

  [[nodiscard]] bool get(int cell) const { return (slabs[cell >> 6] >> (cell & 63)) & 1; }
  void set(int cell) { slabs[cell >> 6] |= std::uint64_t{1} << (cell & 63); }
  void flip(int cell) { slabs[cell >> 6] ^= std::uint64_t{1} << (cell & 63); }
  [[nodiscard]] bool any() const {
    std::uint64_t all = 0;
    for (const std::uint64_t slab : slabs) all |= slab;
    return all != 0;
  }
  [[nodiscard]] std::size_t count() const {
    std::size_t sum = 0;
    for (const std::uint64_t slab : slabs) sum += static_cast<std::size_t>(base::countBits(slab));
    return sum;
  }
};

/// Index of a cell or lattice point inside its block.
inline constexpr int cellIndex(int x, int y, int z) { return x * 64 + y * 8 + z; }

/// Where the block (dx, dy, dz) steps away, each -1..1, is among a block and the 26 around it.
inline constexpr int neighbourIndex(int dx, int dy, int dz) {
  return (dx + 1) * 9 + (dy + 1) * 3 + dz + 1;
}

/// A slab read one step further in z: what lies beyond comes from `next`, the same slab of the
/// block above in z.
inline std::uint64_t stepZ(std::uint64_t slab, std::uint64_t next) {
  constexpr std::uint64_t kFirst = 0x0101010101010101u;
  return ((slab >> 1) & 0x7f7f7f7f7f7f7f7fu) | ((next & kFirst) << 7);
}

/// A slab read one step further in y; `next` is the same slab of the block above in y.
inline std::uint64_t stepY(std::uint64_t slab, std::uint64_t next) {
  return (slab >> 8) | (next << 56);
}

/// The bits of a block and of the layer above it in each axis: words[x][dy * 2 + dz] is slab x,
/// 0 to 8, read `dy` and `dz` steps further. The corner (dx, dy, dz) of cell (x, y, z) is bit
/// y * 8 + z of words[x + dx][dy * 2 + dz].
struct CornerWords {
  std::array<std::array<std::uint64_t, 4>, kBlockSize + 1> words;
};

/// Puts them together: slab(dx, dy, dz, x) is slab x of the block that many steps, 0 or 1, above.
template <class Slab>
CornerWords cornerWordsOf(const Slab& slab) {
  CornerWords corners;
  for (int x = 0; x <= kBlockSize; ++x) {
    const int dx = x == kBlockSize ? 1 : 0;
    const int local = x & 7;
    const std::uint64_t here = slab(dx, 0, 0, local);
    const std::uint64_t aboveY = slab(dx, 1, 0, local);
    const std::uint64_t z = stepZ(here, slab(dx, 0, 1, local));
    const std::uint64_t aboveYz = stepZ(aboveY, slab(dx, 1, 1, local));
    corners.words[x] = {here, z, stepY(here, aboveY), stepY(z, aboveYz)};
  }
  return corners;
}

}  // namespace tufa::grid
