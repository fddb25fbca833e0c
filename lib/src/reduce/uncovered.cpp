#include "reduce/uncovered.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

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
  Finder(const OverlaySurface& overlay, const CornersOfVertices& corners,
         const ReferenceMesh& reference, std::span<const Index> owner, std::span<const Index> gaps,
         float expected, base::Job& job)
      : overlay_(overlay),
        corners_(corners),
        reference_(reference),
        owner_(owner),
        gaps_(gaps),
        limit2_(expected * expected),
        reach_(2 * expected),
        job_(job) {}

  Uncovered run() {
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

  // Nothing is asked of open ones.
  void findComponents() {
    const base::TriangleArray& triangles = overlay_.surface.triangles;
    const std::size_t count = overlay_.surface.position.size();
    componentOf_ = base::connectedItems(count, [&](const auto& connect) {
      for (const Triangle& t : triangles) {
        connect(t.vertices[0], t.vertices[1]);
        connect(t.vertices[0], t.vertices[2]);
      }
    });
    mayBeSeed_.assign(count, 0);
    for (Index v = 0; v < count; ++v) mayBeSeed_[v] = corners_.of(v).empty() ? 0 : 1;
    for (const Index t : gaps_) {
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

  [[nodiscard]] Uncovered partsOfUncovered() const {
    Uncovered uncovered;
    for (Index t = 0; t < overlay_.surface.triangles.size(); ++t) {
      if (answers_[componentOf(t)] != Answer::Covered) uncovered.triangles.push_back(t);
    }
    if (uncovered.triangles.empty()) return uncovered;
    std::vector<std::uint8_t> hasFaces(componentOf_.size(), 0);
    for (Index face = 0; face < reference_.faceCount(); ++face) {
      const Index t = owner_[reference_.vertices(face)[0]];
      if (t == kNone || answers_[componentOf(t)] == Answer::Covered) continue;
      uncovered.faces.push_back(face);
      hasFaces[componentOf(t)] = 1;
    }
    const bool isLost = std::any_of(uncovered.triangles.begin(), uncovered.triangles.end(),
                                    [&](Index t) { return hasFaces[componentOf(t)] == 0; });
    if (isLost) {  // no face goes to some component: all of the reference must do
      uncovered.faces.resize(reference_.faceCount());
      std::iota(uncovered.faces.begin(), uncovered.faces.end(), Index{0});
    }
    return uncovered;
  }

  const OverlaySurface& overlay_;
  const CornersOfVertices& corners_;
  const ReferenceMesh& reference_;
  std::span<const Index> owner_;
  std::span<const Index> gaps_;
  float limit2_, reach_;
  base::Job& job_;
  std::vector<Index> componentOf_;  // of each vertex, by its lowest vertex
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

Uncovered findUncovered(const OverlaySurface& overlay, const CornersOfVertices& corners,
                        const ReferenceMesh& reference, std::span<const Index> owner,
                        std::span<const Index> gaps, float expected, base::Job& job) {
  return Finder(overlay, corners, reference, owner, gaps, expected, job).run();
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
