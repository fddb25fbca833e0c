#pragma once

#include <array>
#include <cstdint>

#include "reduce/corners.h"
#include "reduce/lines.h"

namespace tufa::reduce {

/// What comes of an operation that is tried: it is made, or the guard that refused it.
enum class Outcome : std::uint8_t {
  Done,
  Place,         ///< the place or a vertex is not inside the part
  Link,          ///< the topology would change (link condition), or the valence grow too high
  Flat,          ///< a new triangle has no area, or the new star is neither a graph nor simple
  Turn,          ///< a triangle would turn too far
  Round,         ///< a triangle would become a sliver
  Fold,          ///< an edge would be a fold
  Star,          ///< a star of the ring would cross itself
  Sample,        ///< a reference vertex would be too far from the star
  Apex,          ///< the new vertex would be too far from the reference
  Crossing,      ///< an edge would be too far from an edge of the reference that it crosses
  Face,          ///< a face of the reference at a rough vertex would be too far
  Intersection,  ///< a new triangle would come too close to one with which it shares no vertex
  Side,          ///< a small component would be turned inside out, or passed over
  Worthless      ///< a flip would not make the smaller angle larger
};
inline constexpr std::size_t kOutcomes = static_cast<std::size_t>(Outcome::Worthless) + 1;

/// How many operations came to each outcome.
struct OperationCounts {
  std::array<std::uint64_t, kOutcomes> collapses{};
  std::array<std::uint64_t, kOutcomes> flips{};
  std::array<std::uint64_t, kOutcomes> contractions{};  ///< of clusters
  std::array<std::uint64_t, kOutcomes> knots{};
  std::uint64_t overQuota = 0;  ///< collapses that were left when a part's quota was spent

  [[nodiscard]] std::uint64_t collapsed() const { return collapses[0]; }
  [[nodiscard]] std::uint64_t flipped() const { return flips[0]; }
  OperationCounts& operator+=(const OperationCounts& other) {
    for (std::size_t i = 0; i < kOutcomes; ++i) {
      collapses[i] += other.collapses[i];
      flips[i] += other.flips[i];
      contractions[i] += other.contractions[i];
      knots[i] += other.knots[i];
    }
    overQuota += other.overQuota;
    return *this;
  }
};

/// What a phase may do.
struct PhaseLimits {
  float distance = 0.1f;      ///< largest distance from the reference, voxels
  float errorShare = 1;       ///< edges whose rms plane distance is over this share are not tried
  float leastSine2 = 0.03f;   ///< squared sine of an angle under which a triangle is a sliver
  float sliverShare = 0;      ///< of a part's triangles that may become slivers nevertheless
  float bentSliverShare = 0;  ///< the same where the surface bends both ways, see VertexFlag
  [[nodiscard]] bool keepsAngle() const { return sliverShare == 0; }
  float turnCosine = 0.5f;  ///< least cosine between a triangle's normal before and after
  bool clusters = false;    ///< contracts clusters first
  bool flips = true;
  int mostValence = 12;  ///< of a new star, unless it was higher: no fans of more needles
  LineMode lines = LineMode::Free;
  bool asksFaces = false;  ///< measures faces where sections lead elsewhere, see distanceGuard()
  bool isLoose = false;    ///< edges need not end where their vertices are, see Part::edgeNear()
  bool allPlaces = false;  ///< tries the ends of an edge also where the best place is too far
  Index quota = kNone;     ///< most collapses of a part
  /// For tests: a guard that is not asked.
  Outcome switchedOff = Outcome::Done;
};

}  // namespace tufa::reduce
