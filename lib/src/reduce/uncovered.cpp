#include "reduce/uncovered.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "base/atomic_bits.h"
#include "base/collect.h"
#include "base/connected.h"
#include "reduce/box3f.h"
#include "reduce/map_degree.h"

namespace tufa::reduce {
namespace {

constexpr int kTries = 16;  // vertices of a component

// Whether the map reaches every point of a component; unknown if there is no vertex around which
// all faces have ways.
enum class Answer : std::uint8_t { Covered, Uncovered, Unknown };

class Finder {
 public:
  Finder(const Measuring& measuring, const std::vector<Index>& halved, const std::vector<Gap>& gaps,
         base::Job& job)
      : overlay_(measuring.overlay),
        corners_(measuring.corners),
        reference_(measuring.reference),
        owner_(measuring.owner),
        halved_(halved),
        limit2_(measuring.expected * measuring.expected),
        reach_(2 * measuring.expected),
        job_(job) {
    if (gaps.empty()) return;
    isGap_.assign(overlay_.surface.triangles.size(), 0);
    for (const Gap& gap : gaps) isGap_[gap.triangle] = 1;
  }

  Uncovered run() {
    componentOf_ = connected([](Index) { return true; });
    findPieces();
    findComponents();
    const auto isOpen = [](Answer answer) { return answer == Answer::Unknown; };
    for (int attempt = 0; attempt < kTries; ++attempt) {
      if (std::none_of(answers_.begin(), answers_.end(), isOpen)) break;
      chooseSeeds(attempt);
      countDegrees();
    }
    return partsOfUncovered();
  }

 private:
  [[nodiscard]] Index componentOf(Index triangle) const {
    return componentOf_[overlay_.vertex(triangle, 0)];
  }

  [[nodiscard]] bool isGap(Index triangle) const {
    return !isGap_.empty() && isGap_[triangle] != 0;
  }

  // Vertices by what some triangles connect.
  template <class Connects>
  [[nodiscard]] std::vector<Index> connected(const Connects& connects) const {
    const base::TriangleArray& triangles = overlay_.surface.triangles;
    return base::connectedItems(overlay_.surface.position.size(), [&](const auto& connect) {
      for (Index t = 0; t < triangles.size(); ++t) {
        if (!connects(t)) continue;
        connect(triangles.vertex(t, 0), triangles.vertex(t, 1));
        connect(triangles.vertex(t, 0), triangles.vertex(t, 2));
      }
    });
  }

  // Chooses the pieces that are asked of: the largest of each closed component, and those at open
  // borders of others.
  void findPieces() {
    if (isGap_.empty()) return;
    const base::TriangleArray& triangles = overlay_.surface.triangles;
    pieceOf_ = connected([&](Index t) { return !isGap(t); });
    std::vector<Index> sizes(pieceOf_.size(), 0), largest(pieceOf_.size(), kNone);
    std::vector<std::uint8_t> isOpen(pieceOf_.size(), 0);
    isAsked_.assign(pieceOf_.size(), 0);
    for (Index t = 0; t < triangles.size(); ++t) {
      const Index piece = pieceOf_[triangles.vertex(t, 0)];
      sizes[piece] += isGap(t) ? 0 : 1;
      for (Index c = 3 * t; c < 3 * t + 3; ++c) {
        if (overlay_.opposite[c] != kNone) continue;
        isOpen[componentOf(t)] = 1;
        if (!isGap(t)) isAsked_[piece] = 1;
      }
    }
    for (Index piece = 0; piece < sizes.size(); ++piece) {
      if (sizes[piece] == 0 || isOpen[componentOf_[piece]] != 0) continue;
      Index& most = largest[componentOf_[piece]];
      if (most == kNone || sizes[piece] > sizes[most]) most = piece;
    }
    for (const Index piece : largest) {
      if (piece != kNone) isAsked_[piece] = 1;
    }
  }

  // Whether a vertex is in a piece that is asked of.
  [[nodiscard]] bool isAsked(Index vertex) const {
    return pieceOf_.empty() || isAsked_[pieceOf_[vertex]] != 0;
  }

  // Of open ones nothing is counted.
  void findComponents() {
    const base::TriangleArray& triangles = overlay_.surface.triangles;
    const std::size_t count = overlay_.surface.position.size();
    mayBeSeed_.assign(count, 0);
    for (Index v = 0; v < count; ++v) mayBeSeed_[v] = !corners_.of(v).empty() && isAsked(v);
    for (Index t = 0; t < isGap_.size(); ++t) {
      if (!isGap(t)) continue;
      for (const Index v : triangles[t].vertices) mayBeSeed_[v] = 0;
    }
    seedsOf_.assign(count, 0);
    answers_.assign(count, Answer::Covered);
    for (Index v = 0; v < count; ++v) {
      if (corners_.of(v).empty()) continue;
      seedsOf_[componentOf_[v]] += mayBeSeed_[v];
      answers_[componentOf_[v]] = Answer::Unknown;
    }
    for (std::size_t c = 0; c < overlay_.opposite.size(); ++c) {
      if (overlay_.opposite[c] != kNone) continue;
      answers_[componentOf(static_cast<Index>(c / 3))] = Answer::Covered;
    }
  }

  // Of each component that there is no answer for yet another vertex.
  void chooseSeeds(int attempt) {
    seedOf_.assign(componentOf_.size(), kNone);
    std::vector<Index> seen(componentOf_.size());
    for (Index v = 0; v < componentOf_.size(); ++v) {
      const Index component = componentOf_[v];
      if (answers_[component] != Answer::Unknown || mayBeSeed_[v] == 0) continue;
      const std::uint64_t at = std::uint64_t{seedsOf_[component]} * static_cast<unsigned>(attempt);
      if (seen[component]++ == at / kTries) seedOf_[component] = v;
    }
  }

  void countDegrees() {
    const std::vector<std::pair<Index, Index>> faces = facesNearSeeds();
    std::vector<std::size_t> first;  // of each component, and the end
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (i == 0 || faces[i].first != faces[i - 1].first) first.push_back(i);
    }
    const std::size_t count = first.size();
    first.push_back(faces.size());
    job_.forRanges(count, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        answers_[faces[first[i]].first] =
            answerOf({faces.data() + first[i], faces.data() + first[i + 1]});
      }
    });
  }

  // From the faces near a component's seed.
  [[nodiscard]] Answer answerOf(std::span<const std::pair<Index, Index>> faces) const {
    const Index seed = seedOf_[faces.front().first];
    MapDegree degree(overlay_, seed, corners_.of(seed).front() / 3);
    for (const auto& [component, face] : faces) {
      if (std::binary_search(halved_.begin(), halved_.end(), face)) continue;
      const OwnedFace owned = ownedFace(reference_, owner_, face);
      if (owned.hasOneOwner()) continue;
      const float found =
          overlayBound2(overlay_, owned, limit2_, [&](const OverlayTurn& turn) { degree(turn); });
      if (!(found <= limit2_)) return Answer::Unknown;
    }
    return degree.degree() == 1 ? Answer::Covered : Answer::Uncovered;
  }

  // With their components, in order.
  [[nodiscard]] std::vector<std::pair<Index, Index>> facesNearSeeds() const {
    const std::size_t count = reference_.faceCount();
    std::vector<std::vector<std::pair<Index, Index>>> lists((count + base::kGrain - 1) /
                                                            base::kGrain);
    job_.forRanges(lists.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t list = begin; list < end; ++list) {
        const std::size_t last = std::min((list + 1) * base::kGrain, count);
        for (std::size_t face = list * base::kGrain; face < last; ++face) {
          const Index seed = seedOf(static_cast<Index>(face));
          if (seed == kNone || !isNear(static_cast<Index>(face), seed)) continue;
          lists[list].emplace_back(componentOf_[seed], face);
        }
      }
    });
    std::vector<std::pair<Index, Index>> faces;
    for (const auto& list : lists) faces.insert(faces.end(), list.begin(), list.end());
    std::sort(faces.begin(), faces.end());
    return faces;
  }

  // Of the component that a face goes to.
  [[nodiscard]] Index seedOf(Index face) const {
    const Index t = owner_[reference_.vertices(face)[0]];
    return t == kNone ? kNone : seedOf_[componentOf(t)];
  }

  [[nodiscard]] bool isNear(Index face, Index seed) const {
    const Vec3f p = overlay_.surface.position[seed];
    const std::array<Vec3f, 3> corners = reference_.cornersOf(face);
    Box3f box = boxOf(corners.data());
    box.growBy(reach_);
    return box.meets({p, p}) &&
           squaredDistanceToTriangle(p, corners[0], corners[1], corners[2]) <= limit2_;
  }

  // A gap outside its sphere is covered if its corners are, see WayBack::fromGaps().
  [[nodiscard]] bool isCovered(Index t) const {
    if (answers_[componentOf(t)] != Answer::Covered) return false;
    const auto v = overlay_.surface.triangles[t].vertices;
    return isAsked(v[0]) && isAsked(v[1]) && isAsked(v[2]);
  }

  [[nodiscard]] Uncovered partsOfUncovered() const {
    Uncovered uncovered;
    std::vector<std::uint8_t> isUncovered(componentOf_.size(), 0);
    for (Index t = 0; t < overlay_.surface.triangles.size(); ++t) {
      if (isCovered(t)) continue;
      uncovered.triangles.push_back(t);
      isUncovered[componentOf(t)] = 1;
    }
    if (uncovered.triangles.empty()) return uncovered;
    uncovered.faces = facesWithin(reach_, uncovered.triangles, [&](Index face) {
      const Index t = owner_[reference_.vertices(face)[0]];
      return t != kNone && isUncovered[componentOf(t)] != 0;
    });
    if (uncovered.faces.empty()) {  // some triangle is farther: all of the reference must do
      uncovered.faces.resize(reference_.faceCount());
      std::iota(uncovered.faces.begin(), uncovered.faces.end(), Index{0});
    }
    return uncovered;
  }

  // The faces, of those wanted, whose boxes are within `reach` of the boxes of some triangles; none
  // if one of these has none.
  template <class IsWanted>
  [[nodiscard]] std::vector<Index> facesWithin(float reach, const std::vector<Index>& triangles,
                                               const IsWanted& isWanted) const {
    std::vector<base::Box> boxes;
    for (const Index t : triangles) {
      base::Box& box = boxes.emplace_back(base::Box::empty());
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 p(overlay_.surface.corner(t, i));
        box.add(p - Vec3(reach, reach, reach)), box.add(p + Vec3(reach, reach, reach));
      }
    }
    const base::Bvh tree(std::move(boxes), job_);
    base::AtomicBits isMet(triangles.size());
    std::vector<Index> faces = base::collectIf(job_, reference_.faceCount(), [&](Index face) {
      if (!isWanted(face)) return false;
      base::Box box = base::Box::empty();
      for (const Vec3f& p : reference_.cornersOf(face)) box.add(Vec3(p));
      bool isNear = false;
      tree.itemsMeeting(box,
                        [&](std::uint32_t i, const base::Box&) { isMet.add(i), isNear = true; });
      return isNear;
    });
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (!isMet.has(i)) return {};
    }
    return faces;
  }

  const OverlaySurface& overlay_;
  const CornersOfVertices& corners_;
  const ReferenceMesh& reference_;
  std::span<const Index> owner_;
  const std::vector<Index>& halved_;
  float limit2_, reach_;
  base::Job& job_;
  std::vector<Index> componentOf_;  // of each vertex, by its lowest vertex
  // Of triangles, of vertices and of pieces by their lowest vertex; empty without gaps.
  std::vector<std::uint8_t> isGap_;
  std::vector<Index> pieceOf_;
  std::vector<std::uint8_t> isAsked_;
  std::vector<std::uint8_t> mayBeSeed_;
  std::vector<Index> seedsOf_;  // of each component: how many may be
  std::vector<Answer> answers_;
  std::vector<Index> seedOf_;
};

std::vector<base::Box> boxesOf(const ReferenceMesh& reference, const std::vector<Index>& faces) {
  std::vector<base::Box> boxes;
  boxes.reserve(faces.size());
  for (const Index face : faces) {
    base::Box box = base::Box::empty();
    for (const Vec3f& p : reference.cornersOf(face)) box.add(Vec3(p));
    boxes.push_back(box);
  }
  return boxes;
}

}  // namespace

Uncovered findUncovered(const Measuring& measuring, const std::vector<Index>& halved,
                        const std::vector<Gap>& gaps, base::Job& job) {
  return Finder(measuring, halved, gaps, job).run();
}

FacesNear::FacesNear(const ReferenceMesh& reference, std::vector<Index> faces, base::Job& job)
    : reference_(reference), faces_(std::move(faces)), tree_(boxesOf(reference, faces_), job) {}

std::vector<Index> FacesNear::of(const std::array<Vec3f, 3>& triangle) const {
  const Vec3f middle = (triangle[0] + triangle[1] + triangle[2]) * (1.0f / 3);
  float size = 0;
  for (const Vec3f& p : triangle) size = std::max(size, length(p - middle));
  double least = std::numeric_limits<double>::max();
  const std::uint32_t nearest = tree_.nearest(Vec3(middle), least, [&](std::uint32_t i) {
    const double d = reference_.distance(faces_[i], middle);
    return d * d;
  });
  // What is nearest at another point is no farther than this.
  const double reach = 1.0001 * (std::sqrt(least) + 2 * static_cast<double>(size)) + 1e-4;
  base::Box box = base::Box::empty();
  box.add(Vec3(middle) - Vec3(reach, reach, reach));
  box.add(Vec3(middle) + Vec3(reach, reach, reach));
  std::vector<Index> near{faces_[nearest]};
  tree_.itemsMeeting(box, [&](std::uint32_t i, const base::Box&) {
    if (i != nearest) near.push_back(faces_[i]);
  });
  return near;
}

}  // namespace tufa::reduce
