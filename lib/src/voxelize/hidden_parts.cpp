#include "voxelize/hidden_parts.h"

#include <algorithm>
#include <cmath>

namespace tufa::voxelize_field {
namespace {

using implicit::Box;
using implicit::Field;
using implicit::Interval;

constexpr int kSide = SampledBlock::kSide;

/// The samples of a mask and their neighbours in the block.
BlockMask dilated(const BlockMask& mask) {
  constexpr std::uint64_t kFirstOfRows = 0x0101010101010101u;
  BlockMask flat{};
  for (int x = 0; x < kSide; ++x) {
    std::uint64_t m = mask[x];
    m |= ((m << 1) & ~kFirstOfRows) | ((m >> 1) & ~(kFirstOfRows << 7));
    flat[x] = m | (m << 8) | (m >> 8);
  }
  BlockMask all{};
  for (int x = 0; x < kSide; ++x) {
    all[x] = flat[x] | (x > 0 ? flat[x - 1] : 0) | (x + 1 < kSide ? flat[x + 1] : 0);
  }
  return all;
}

Box cubeAround(const Vec3& centre, double half) {
  return {centre - Vec3(half), centre + Vec3(half)};
}

bool isInside(double value) { return value < 0; }

/// Whether the field may leave the side of a cube's centre, by its bounds.
bool mayChange(const Field& field, const Box& box, bool inside) {
  const Interval bound = field.bound(box);
  return inside ? !(bound.greatest < 0) : !(bound.least >= 0);
}

enum class Answer { None, Undecided, Found };

/// Each part looked at takes one of `looks`; without any left, nothing is decided.
Answer search(const Field& field, const Vec3& centre, double half, bool inside, int depth,
              int& looks) {
  if (looks == 0) return Answer::Undecided;
  --looks;
  if (!mayChange(field, cubeAround(centre, half), inside)) return Answer::None;
  if (isInside(field.value(centre)) != inside) return Answer::Found;
  if (depth == 0) return Answer::Undecided;
  Answer all = Answer::None;
  const double quarter = half / 2;
  for (int child = 0; child < 8; ++child) {
    const Vec3 step((child & 4) ? quarter : -quarter, (child & 2) ? quarter : -quarter,
                    (child & 1) ? quarter : -quarter);
    const Answer part = search(field, centre + step, quarter, inside, depth - 1, looks);
    if (part == Answer::Found) return part;
    all = std::max(all, part);
  }
  return all;
}

/// Whether a neighbour beyond the block lies on the other side. Those in it do not.
bool changesBeyond(const SampledBlock& block, int x, int y, int z, bool inside) {
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dz = -1; dz <= 1; ++dz) {
        if (SampledBlock::holds(x + dx, y + dy, z + dz)) continue;
        if (block.isInside(x + dx, y + dy, z + dz) != inside) return true;
      }
    }
  }
  return false;
}

}  // namespace

HiddenParts findHiddenParts(const SampledBlock& block) {
  constexpr int kHalvings = 4;  // parts of a sixteenth of a voxel
  BlockMask outside{};
  for (int x = 0; x < kSide; ++x) outside[x] = ~block.inside[x];
  const BlockMask nearInside = dilated(block.inside);
  const BlockMask nearOutside = dilated(outside);
  const double half = block.voxelSize / 2;
  const Box whole{block.point(0, 0, 0) - Vec3(half), block.point(7, 7, 7) + Vec3(half)};
  const double most = block.field.lipschitz(whole) * std::sqrt(3.0) * half * (1 + 1e-9);
  HiddenParts parts;
  // A field without bounds, such as 1/0, would take two million for each block.
  int looks = 100000;
  for (int x = 0; x < kSide; ++x) {
    std::uint64_t candidates = block.sampled[x] & ~(nearInside[x] & nearOutside[x]);
    for (; candidates != 0; candidates &= candidates - 1) {
      const int bit = std::countr_zero(candidates);
      const int y = bit / kSide;
      const int z = bit % kSide;
      const Vec3 point = block.point(x, y, z);
      // What lies in the cube is at most half its diagonal away.
      if (std::abs(block.field.value(point)) > most) continue;
      const bool inside = block.isInside(x, y, z);
      if (!mayChange(block.field, cubeAround(point, half), inside)) continue;
      if (changesBeyond(block, x, y, z, inside)) continue;
      const Answer answer = search(block.field, point, half, inside, kHalvings, looks);
      if (answer == Answer::None) continue;
      if (parts.found + parts.undecided == 0) parts.first = point;
      ++(answer == Answer::Found ? parts.found : parts.undecided);
    }
  }
  return parts;
}

}  // namespace tufa::voxelize_field
