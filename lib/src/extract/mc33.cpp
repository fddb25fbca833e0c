#include "extract/mc33.h"

#include "base/bits.h"
#include "extract/marching_cubes.h"

namespace tufa::extraction {
namespace {

// The corners of a slice across axis 0 in cyclic order, as corners of the cell at its lower end,
// and the faces that the sides from each to the next lie on.
constexpr std::array<int, 4> kCorners4 = {0, 2, 3, 1};
constexpr int kUp = 4;  // to the corner at the upper end

constexpr int faceWith(int a, int b, int c) {
  for (int face = 0; face < kFaces; ++face) {
    int found = 0;
    for (const int corner : uniform::kFaceCorners[face]) {
      found += corner == a || corner == b || corner == c ? 1 : 0;
    }
    if (found == 3) return face;
  }
  return -1;
}

struct Side {
  int face, lowerEdge, upperEdge, firstEdge, secondEdge;
};

constexpr auto kSides = [] {
  std::array<Side, 4> sides{};
  for (int k = 0; k < 4; ++k) {
    const int a = kCorners4[k], b = kCorners4[(k + 1) % 4];
    sides[k] = {faceWith(a, b, a + kUp), uniform::edgeBetween(a, b),
                uniform::edgeBetween(a + kUp, b + kUp), uniform::edgeBetween(a, a + kUp),
                uniform::edgeBetween(b, b + kUp)};
  }
  return sides;
}();

class Sweep {
 public:
  Sweep(CornerMask mask, FaceBits joined, const CornerValues& values)
      : mask_(mask), joined_(joined), loopOf_(caseOf(codeOf(mask, joined)).loopOf) {
    for (int k = 0; k < 4; ++k) {
      lower_[k] = static_cast<double>(values[kCorners4[k]]);
      upper_[k] = static_cast<double>(values[kCorners4[k] + kUp]);
      inside_[k] = uniform::isInside(mask, kCorners4[k]);
      if (uniform::isInside(mask, kCorners4[k] + kUp) == inside_[k]) continue;
      insert({lower_[k] / (lower_[k] - upper_[k]), k});
    }
  }

  int findTunnel() {
    for (int run = 0; run <= flipCount_ && tunnel_ == 0; ++run) {
      if (run > 0) inside_[flips_[run - 1].corner] = !inside_[flips_[run - 1].corner];
      visitRun(run);
    }
    return tunnel_;
  }

 private:
  struct Flip {
    double height = 0;
    int corner = 0;
  };

  // Keeps the flips in the order of their heights.
  void insert(const Flip& flip) {
    int at = flipCount_++;
    for (; at > 0 && flips_[at - 1].height > flip.height; --at) flips_[at] = flips_[at - 1];
    flips_[at] = flip;
  }

  // The slices between two changes of corners.
  void visitRun(int run) {
    std::array<int, 4> crossed{};
    int count = 0;
    for (int k = 0; k < 4; ++k) {
      if (inside_[k] != inside_[(k + 1) % 4]) crossed[count++] = k;
    }
    if (count == 2) join(crossed[0], crossed[1], run);
    if (count != 4) return;
    for (const bool joins : {false, true}) {
      if (!attains(run, joins)) continue;
      // Around the inside corners if they are apart, else around the outside ones: from side k - 1
      // to side k around corner k.
      const int first = inside_[0] != joins ? 0 : 1;
      join((first + 3) % 4, first, run);
      join(first + 1, first + 2, run);
    }
  }

  // Whether some slice of the run joins its inside corners (or keeps them apart).
  [[nodiscard]] bool attains(int run, bool joins) const {
    if (endJoins(run, 0) == joins || endJoins(run, 1) == joins) return true;
    // Corners a + t da and so on: a c - b d = u t^2 + v t + w.
    std::array<double, 4> d;
    for (int k = 0; k < 4; ++k) d[k] = upper_[k] - lower_[k];
    const double u = d[0] * d[2] - d[1] * d[3];
    const double v = lower_[0] * d[2] + lower_[2] * d[0] - lower_[1] * d[3] - lower_[3] * d[1];
    if (u == 0) return false;
    const double height = -v / (2 * u);
    const double from = run == 0 ? 0 : flips_[run - 1].height;
    const double to = run == flipCount_ ? 1 : flips_[run].height;
    if (!(height > from && height < to)) return false;
    std::array<double, 4> c;
    for (int k = 0; k < 4; ++k) c[k] = lower_[k] + height * d[k];
    return joinsByProducts(c[0] * c[2] - c[1] * c[3]) == joins;
  }

  // The inside corners are joined if their product is the larger one.
  [[nodiscard]] bool joinsByProducts(double difference) const {
    return inside_[0] ? difference > 0 : difference < 0;
  }

  // At an end of a run: by the bit of the face there; or else by the corner that changes sign,
  // whose product is 0.
  [[nodiscard]] bool endJoins(int run, int end) const {
    if (end == 0 && run == 0) return (joined_ & 1) != 0;
    if (end == 1 && run == flipCount_) return (joined_ & 2) != 0;
    return !inside_[flips_[end == 0 ? run - 1 : run].corner];
  }

  // The loop of the crossing of a side of the slices of a run. An ambiguous face has two arcs, one
  // with the crossing of its lower edge, one with that of its upper, and nothing between them.
  [[nodiscard]] int loopAt(int k, int run) const {
    const Side& side = kSides[k];
    if (uniform::isAmbiguous(mask_, side.face)) {
      bool flipped = false;
      for (int i = 0; i < run; ++i) {
        flipped |= flips_[i].corner == k || flips_[i].corner == (k + 1) % 4;
      }
      return loopOf_[flipped ? side.upperEdge : side.lowerEdge];
    }
    for (const int edge : {side.lowerEdge, side.upperEdge, side.firstEdge, side.secondEdge}) {
      if (uniform::isCrossed(mask_, edge)) return loopOf_[edge];
    }
    return 0;
  }

  void join(int sideA, int sideB, int run) {
    const int a = loopAt(sideA, run), b = loopAt(sideB, run);
    for (int tunnel = 0; tunnel < kTunnels; ++tunnel) {
      const auto [one, other] = kTunnelEnds[tunnel];
      if ((a == one && b == other) || (a == other && b == one)) tunnel_ = tunnel + 1;
    }
  }

  CornerMask mask_;
  FaceBits joined_;
  const std::array<std::uint8_t, kEdges>& loopOf_;
  std::array<double, 4> lower_{}, upper_{};
  std::array<bool, 4> inside_{};  ///< in the run at hand
  std::array<Flip, 4> flips_{};
  int flipCount_ = 0;
  int tunnel_ = 0;
};

CaseCode decide(CornerMask mask, const CornerValues& values) {
  const FaceBits joined = facesJoinedBySaddles(mask, values);
  return codeOf(mask, joined, tunnelOf(mask, joined, values));
}

}  // namespace

int tunnelOf(CornerMask mask, FaceBits joined, const CornerValues& values) {
  const int loops = caseOf(codeOf(mask, joined)).loopCount;
  if (loops < 2 || loops > kTunnels) return 0;
  return Sweep(mask, joined, values).findTunnel();
}

CubeRule mc33Rule() {
  CubeRule cubes;
  for (int number = 0; number < 256; ++number) {
    const auto mask = static_cast<CornerMask>(number);
    cubes.codes[number] = codeOf(mask, 0);
    cubes.asks[number] =
        uniform::ambiguousFaces(mask) != 0 || caseOf(cubes.codes[number]).loopCount > 1;
  }
  cubes.decide = decide;
  return cubes;
}

}  // namespace tufa::extraction
