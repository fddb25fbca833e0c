#include "uniform/case_table.h"

namespace tufa::uniform {
namespace {

constexpr auto kAmbiguousFaces = [] {
  std::array<FaceBits, 256> table{};
  for (int mask = 0; mask < 256; ++mask) {
    for (int face = 0; face < kFaces; ++face) {
      if (isAmbiguous(static_cast<CornerMask>(mask), face)) {
        table[mask] = static_cast<FaceBits>(table[mask] | 1 << face);
      }
    }
  }
  return table;
}();

// One constant for each group of masks, so that each stays below the default limits of compilers on
// constant evaluation.
constexpr int kGroup = 32;
using Group = std::array<std::array<Components, 64>, kGroup>;

template <int kFirst>
constexpr Group kComponents = [] {
  Group group{};
  for (int i = 0; i < kGroup; ++i) {
    const auto mask = static_cast<CornerMask>(kFirst + i);
    for (int joined = 0; joined < 64; ++joined) {
      // Bits of faces that are not ambiguous mean nothing: take the entry without them.
      const int meant = joined & kAmbiguousFaces[mask];
      group[i][joined] =
          meant == joined ? joinCrossings(mask, static_cast<FaceBits>(joined), 0) : group[i][meant];
    }
  }
  return group;
}();

constexpr std::array<const Group*, 8> kGroups = {
    &kComponents<0>,   &kComponents<32>,  &kComponents<64>,  &kComponents<96>,
    &kComponents<128>, &kComponents<160>, &kComponents<192>, &kComponents<224>};

}  // namespace

Components componentsOf(CornerMask mask, FaceBits joined) {
  return (*kGroups[mask / kGroup])[mask % kGroup][joined];
}

FaceBits ambiguousFaces(CornerMask mask) { return kAmbiguousFaces[mask]; }

}  // namespace tufa::uniform
