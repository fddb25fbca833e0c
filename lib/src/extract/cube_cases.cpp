#include "extract/cube_cases.h"

#include <utility>

namespace tufa::extraction {
namespace {

constexpr int countFaces(FaceBits bits) {
  int count = 0;
  for (int face = 0; face < kFaces; ++face) count += (bits >> face) & 1;
  return count;
}

constexpr FaceBits facesOf(CornerMask mask) {
  int faces = 0;
  for (int face = 0; face < kFaces; ++face) {
    faces |= uniform::isAmbiguous(mask, face) ? 1 << face : 0;
  }
  return static_cast<FaceBits>(faces);
}

// The bits of `joined` at the places of `faces`, moved together.
constexpr int packed(FaceBits faces, FaceBits joined) {
  int bits = 0, next = 0;
  for (int face = 0; face < kFaces; ++face) {
    if (((faces >> face) & 1) == 0) continue;
    bits |= ((joined >> face) & 1) << next++;
  }
  return bits;
}

// Inverse of packed().
constexpr FaceBits spread(FaceBits faces, int bits) {
  int joined = 0, next = 0;
  for (int face = 0; face < kFaces; ++face) {
    if (((faces >> face) & 1) != 0) joined |= ((bits >> next++) & 1) << face;
  }
  return static_cast<FaceBits>(joined);
}

constexpr auto kPacked = [] {
  std::array<std::array<std::uint8_t, 64>, 64> table{};
  for (int faces = 0; faces < 64; ++faces) {
    for (int joined = 0; joined < 64; ++joined) {
      table[faces][joined] = static_cast<std::uint8_t>(
          packed(static_cast<FaceBits>(faces), static_cast<FaceBits>(joined)));
    }
  }
  return table;
}();

// A constant for each mask and tunnel, so that each stays below the default limits of compilers on
// constant evaluation.
template <int kMask, int kTunnel>
constexpr auto kCasesOf = [] {
  constexpr auto mask = static_cast<CornerMask>(kMask);
  constexpr FaceBits faces = facesOf(mask);
  std::array<CubeCase, 1 << countFaces(faces)> cases{};
  for (int bits = 0; bits < 1 << countFaces(faces); ++bits) {
    const Loops loops = loopsOf(mask, spread(faces, bits));
    if (kTunnel == 0 || mayHave(loops, kTunnel)) cases[bits] = caseFor(loops, kTunnel);
  }
  return cases;
}();

template <int kTunnel>
constexpr auto kCases = []<int... kMasks>(std::integer_sequence<int, kMasks...>) {
  return std::array<const CubeCase*, 256>{kCasesOf<kMasks, kTunnel>.data()...};
}
(std::make_integer_sequence<int, 256>());

constexpr auto kCasesByTunnel = []<int... kTunnel>(std::integer_sequence<int, kTunnel...>) {
  return std::array<const std::array<const CubeCase*, 256>*, 1 + kTunnels>{&kCases<kTunnel>...};
}
(std::make_integer_sequence<int, 1 + kTunnels>());

}  // namespace

CaseCode codeOf(CornerMask mask, FaceBits joined, int tunnel) {
  const int bits = kPacked[uniform::ambiguousFaces(mask)][joined & 63];
  return static_cast<CaseCode>(mask | bits << 8 | tunnel << 14);
}

FaceBits joinedFacesOf(CaseCode code) {
  return spread(uniform::ambiguousFaces(static_cast<CornerMask>(code & 0xff)), (code >> 8) & 0x3f);
}

const CubeCase& caseOf(CaseCode code) {
  return (*kCasesByTunnel[code >> 14])[code & 0xff][(code >> 8) & 0x3f];
}

}  // namespace tufa::extraction
