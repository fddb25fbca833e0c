#include "extract/marching_cubes.h"

#include "base/bits.h"
#include "uniform/ambiguity.h"

namespace tufa::extraction {
namespace {

constexpr FaceBits kAll = 0x3f;

/// The ambiguous faces of a cell that are joined by their values.
template <Ambiguity kRule>
FaceBits joinedByValues(CornerMask mask, const CornerValues& values) {
  unsigned joined = 0;
  base::forEachBit(uniform::ambiguousFaces(mask), [&](int face) {
    std::array<double, 4> around;
    for (int i = 0; i < 4; ++i) {
      around[i] = static_cast<double>(values[uniform::kFaceCorners[face][i]]);
    }
    if (uniform::joinsInside(kRule, around)) joined |= 1u << face;
  });
  return static_cast<FaceBits>(joined);
}

template <Ambiguity kRule>
CaseCode decideByValues(CornerMask mask, const CornerValues& values) {
  return codeOf(mask, joinedByValues<kRule>(mask, values));
}

FaceBits joinedWithoutValues(CornerMask mask, Ambiguity rule) {
  constexpr int kHalf = kCorners / 2;
  if (rule == Ambiguity::Original) return base::countBits(mask) > kHalf ? kAll : FaceBits{0};
  return rule == Ambiguity::Join ? kAll : FaceBits{0};
}

}  // namespace

FaceBits facesJoinedBySaddles(CornerMask mask, const CornerValues& values) {
  return joinedByValues<Ambiguity::Asymptotic>(mask, values);
}

CubeRule marchingCubesRule(Ambiguity rule) {
  CubeRule cubes;
  const bool byValues = rule == Ambiguity::Asymptotic || rule == Ambiguity::Chord;
  for (int number = 0; number < 256; ++number) {
    const auto mask = static_cast<CornerMask>(number);
    cubes.codes[number] = codeOf(mask, joinedWithoutValues(mask, rule));
    cubes.asks[number] = byValues && uniform::ambiguousFaces(mask) != 0;
  }
  cubes.decide = rule == Ambiguity::Chord ? decideByValues<Ambiguity::Chord>
                                          : decideByValues<Ambiguity::Asymptotic>;
  return cubes;
}

}  // namespace tufa::extraction
