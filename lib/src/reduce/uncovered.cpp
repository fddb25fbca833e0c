#include "reduce/uncovered.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/connected.h"
#include "reduce/box3f.h"
#include "reduce/map_degree.h"

namespace tufa::reduce {
namespace {

constexpr std::size_t kGrain = 8192;
constexpr int kTries = 4;  // vertices of a component

class Finder {
 public:
  Finder(const OverlaySurface& overlay, const CornersOfVertices& corners,
         const ReferenceMesh& reference, std::span<const Index> owner, float expected,
         base::Job& job)
      : overlay_(overlay),
        corners_(corners),
        reference_(reference),
        owner_(owner),
        limit2_(expected * expected),
        reach_(2 * expected),
        job_(job) {}

  Uncovered run() {
    findComponents();
    for (int attempt = 0; attempt < kTries; ++attempt) {
      if (std::none_of(isUnsettled_.begin(), isUnsettled_.end(),
                       [](std::uint8_t is) { return is != 0; }))
        return {};
      chooseSeeds(attempt);
      countDegrees();
    }
    return partsOfUnsettled();
  }

 private:
  [[nodiscard]] Index componentOf(Index triangle) const {
    return componentOf_[overlay_.vertex(triangle, 0)];
  }

  // Closed ones are to be settled.
  void findComponents() {
    const std::vector<Triangle>& triangles = overlay_.surface.triangles;
    const std::size_t count = overlay_.surface.position.size();
    componentOf_ = base::connectedItems(count, [&](const auto& connect) {
      for (const Triangle& t : triangles) {
        connect(t.vertices[0], t.vertices[1]);
        connect(t.vertices[0], t.vertices[2]);
      }
    });
    sizeOf_.assign(count, 0);
    isUnsettled_.assign(count, 0);
    for (Index v = 0; v < count; ++v) {
      if (corners_.of(v).empty()) continue;
      ++sizeOf_[componentOf_[v]];
      isUnsettled_[componentOf_[v]] = 1;
    }
    for (std::size_t c = 0; c < overlay_.opposite.size(); ++c) {
      if (overlay_.opposite[c] == kNone) isUnsettled_[componentOf(static_cast<Index>(c / 3))] = 0;
    }
  }

  // Of each unsettled component another vertex.
  void chooseSeeds(int attempt) {
    seedOf_.assign(componentOf_.size(), kNone);
    std::vector<Index> seen(componentOf_.size());
    for (Index v = 0; v < componentOf_.size(); ++v) {
      const Index component = componentOf_[v];
      if (isUnsettled_[component] == 0 || corners_.of(v).empty()) continue;
      const std::uint64_t at = std::uint64_t{sizeOf_[component]} * static_cast<unsigned>(attempt);
      if (seen[component]++ == at / kTries) seedOf_[component] = v;
    }
  }

  // Settles those of degree one.
  void countDegrees() {
    const std::vector<std::pair<Index, Index>> faces = facesNearSeeds();
    for (auto first = faces.begin(); first != faces.end();) {
      const Index component = first->first, seed = seedOf_[component];
      MapDegree degree(overlay_, seed, corners_.of(seed).front() / 3);
      bool areAllBounded = true;
      for (; first != faces.end() && first->first == component; ++first) {
        const OwnedFace face = owned(first->second);
        areAllBounded &= face.hasOneOwner() ||
                         overlayBound2(overlay_, face, limit2_,
                                       [&](const OverlayTurn& turn) { degree(turn); }) <= limit2_;
      }
      if (areAllBounded && degree.degree() == 1) isUnsettled_[component] = 0;
    }
  }

  // With their components, in order.
  [[nodiscard]] std::vector<std::pair<Index, Index>> facesNearSeeds() const {
    const std::size_t count = reference_.faces().size();
    std::vector<std::vector<std::pair<Index, Index>>> lists((count + kGrain - 1) / kGrain);
    job_.forRanges(lists.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t list = begin; list < end; ++list) {
        const std::size_t last = std::min((list + 1) * kGrain, count);
        for (std::size_t face = list * kGrain; face < last; ++face) {
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
    const Index t = owner_[reference_.faces()[face].vertex[0]];
    return t == kNone ? kNone : seedOf_[componentOf(t)];
  }

  [[nodiscard]] bool isNear(Index face, Index seed) const {
    const Vec3f p = overlay_.surface.position[seed];
    const std::array<Vec3f, 3> corners = reference_.cornersOf(face);
    Box3f box = boxOf(corners.data());
    box.growBy(reach_);
    return box.hasInside(p) &&
           squaredDistanceToTriangle(p, corners[0], corners[1], corners[2]) <= limit2_;
  }

  [[nodiscard]] OwnedFace owned(Index f) const {
    const auto& v = reference_.faces()[f].vertex;
    return {reference_.cornersOf(f), v, {owner_[v[0]], owner_[v[1]], owner_[v[2]]}};
  }

  [[nodiscard]] Uncovered partsOfUnsettled() const {
    Uncovered uncovered;
    for (Index t = 0; t < overlay_.surface.triangles.size(); ++t) {
      if (isUnsettled_[componentOf(t)] != 0) uncovered.triangles.push_back(t);
    }
    for (Index face = 0; face < reference_.faces().size(); ++face) {
      const Index t = owner_[reference_.faces()[face].vertex[0]];
      if (t != kNone && isUnsettled_[componentOf(t)] != 0) uncovered.faces.push_back(face);
    }
    if (uncovered.faces.empty()) {  // none goes there: all of the reference must do
      uncovered.faces.resize(reference_.faces().size());
      std::iota(uncovered.faces.begin(), uncovered.faces.end(), Index{0});
    }
    return uncovered;
  }

  const OverlaySurface& overlay_;
  const CornersOfVertices& corners_;
  const ReferenceMesh& reference_;
  std::span<const Index> owner_;
  float limit2_, reach_;
  base::Job& job_;
  // Of each component, by its lowest vertex.
  std::vector<Index> componentOf_;  // of each vertex
  std::vector<Index> sizeOf_;       // vertices
  std::vector<std::uint8_t> isUnsettled_;
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
                        float expected, base::Job& job) {
  return Finder(overlay, corners, reference, owner, expected, job).run();
}

FacesNear::FacesNear(const ReferenceMesh& reference, std::vector<Index> faces, base::Job& job)
    : reference_(reference), faces_(std::move(faces)), tree_(boxesOf(reference, faces_), job) {}

std::vector<Index> FacesNear::of(const std::array<Vec3f, 3>& triangle) const {
  const Vec3f middle = (triangle[0] + triangle[1] + triangle[2]) * (1.0f / 3);
  float size = 0;
  for (const Vec3f& p : triangle) size = std::max(size, length(p - middle));
  double least = std::numeric_limits<double>::max();
  (void)tree_.nearest(Vec3(middle), least, [&](std::uint32_t i) {
    const double d = reference_.distance(faces_[i], middle);
    return d * d;
  });
  // What is nearest at another point is no farther than this.
  const double reach = 1.0001 * (std::sqrt(least) + 2 * static_cast<double>(size)) + 1e-4;
  base::Box box = base::Box::empty();
  box.add(Vec3(middle) - Vec3(reach, reach, reach));
  box.add(Vec3(middle) + Vec3(reach, reach, reach));
  std::vector<Index> near;
  tree_.itemsMeeting(box, [&](std::uint32_t i, const base::Box&) { near.push_back(faces_[i]); });
  return near;
}

}  // namespace tufa::reduce
