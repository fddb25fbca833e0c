#include "reduce/new_folds.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <span>
#include <unordered_set>
#include <vector>

#include "reduce/corners.h"
#include "reduce/triangles.h"

namespace tufa::reduce {
namespace {

// Cosine of 149.9 degrees and area in square voxels: positions are still to be rounded.
constexpr float kFolded = -0.8655f;
constexpr float kLeastFoldArea = 0.048f;
// A face within this cosine (35 degrees) of another one faces the same way.
constexpr float kAlike = 0.819f;
// Voxels around the middle of a fold. At large tolerances the reference is farther away than that:
// so many voxels more than these.
constexpr float kNear = 3;
constexpr float kBeyondTolerance = 1;

struct Fold {
  Index corner;  ///< opposite the edge, in the first triangle
  std::array<Vec3f, 2> normals;
};

// Of length 1, or 0 for a face that is too small.
Vec3f normalOf(Vec3f a, Vec3f b, Vec3f c, float leastArea) {
  const Vec3f normal = cross(b - a, c - a);
  const float size = length(normal);
  return size > 2 * leastArea ? normal * (1 / size) : Vec3f();
}

// In the order of their corners.
std::vector<Fold> foldsOf(const Surface& surface, base::Job& job) {
  const auto normalOfTriangle = [&](Index t) {
    return normalOf(surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2),
                    kLeastFoldArea);
  };
  std::vector<Fold> folds;
  std::mutex mutex;
  forCornerRanges(surface.position.size(), surface.triangles, job, [&](const auto& corners) {
    std::vector<Fold> own;
    const auto look = [&](Index corner, Index across) {
      if (across == kNone || across < corner) return;
      const Vec3f a = normalOfTriangle(corner / 3), b = normalOfTriangle(across / 3);
      if (dot(a, b) < kFolded) own.push_back({corner, {a, b}});
    };
    forOppositeCorners(surface.triangles, corners, corners.begin(), corners.end(), look);
    const std::scoped_lock lock(mutex);
    folds.insert(folds.end(), own.begin(), own.end());
  });
  std::sort(folds.begin(), folds.end(),
            [](const Fold& a, const Fold& b) { return a.corner < b.corner; });
  return folds;
}

// Whether the reference has a fold, seen from the faces below the ends of its edge.
class FoldSearch {
 public:
  FoldSearch(const ReferenceMesh& reference, float reach)
      : reference_(reference), reach2_(reach * reach) {}

  bool has(const Fold& fold, Vec3f a, Vec3f b, std::span<const Index> first) {
    const Vec3f middle = (a + b) * 0.5f;
    for (std::vector<Vec3f>& side : alike_) side.clear();
    seen_.clear(), reached_.clear();
    const auto reach = [&](Index face) {
      if (face != kNone && seen_.insert(face).second) reached_.push_back(face);
      return true;
    };
    for (const Index face : first) reach(face);
    for (std::size_t i = 0; i < reached_.size(); ++i) {
      const Index face = reached_[i];
      if (!isNear(face, a, b)) continue;
      if (squaredDistance(face, middle) < reach2_ && see(face, fold)) return true;
      for (const Index v : reference_.vertices(face)) reference_.allAround(v, reach);
    }
    return false;
  }

 private:
  [[nodiscard]] float squaredDistance(Index face, Vec3f p) const {
    const auto q = reference_.cornersOf(face);
    return squaredDistanceToTriangle(p, q[0], q[1], q[2]);
  }

  // Whether a face is near an edge: one of its own sides is, or an end.
  [[nodiscard]] bool isNear(Index face, Vec3f a, Vec3f b) const {
    const auto q = reference_.cornersOf(face);
    for (std::size_t i = 0; i < 3; ++i) {
      if (squaredDistanceOfSegments(q[i], q[(i + 1) % 3], a, b) < reach2_) return true;
    }
    return squaredDistance(face, a) < reach2_ || squaredDistance(face, b) < reach2_;
  }

  // Whether a face and one before it are as far apart as the fold's.
  bool see(Index face, const Fold& fold) {
    constexpr float kAnyArea = 1e-3f;  // less has no normal to speak of
    const auto corners = reference_.cornersOf(face);
    const Vec3f normal = normalOf(corners[0], corners[1], corners[2], kAnyArea);
    for (const std::size_t side : {0, 1}) {
      if (dot(normal, fold.normals[side]) <= kAlike) continue;
      alike_[side].push_back(normal);
      const std::vector<Vec3f>& others = alike_[1 - side];
      if (std::any_of(others.begin(), others.end(),
                      [&](Vec3f other) { return dot(normal, other) < kFolded; })) {
        return true;
      }
    }
    return false;
  }

  const ReferenceMesh& reference_;
  float reach2_;
  std::array<std::vector<Vec3f>, 2> alike_;  ///< normals of faces that face as the fold's
  std::unordered_set<Index> seen_;           ///< faces
  std::vector<Index> reached_;
};

}  // namespace

std::vector<Index> facesAtNewFolds(const Surface& surface, const ReferenceMesh& reference,
                                   float tolerance, base::Job& job) {
  std::vector<Index> faces;
  FoldSearch search(reference, std::max(kNear, tolerance + kBeyondTolerance));
  for (const Fold& fold : foldsOf(surface, job)) {
    job.checkCancelled(0, 1);
    const Index a = surface.triangles.corner(nextCorner(fold.corner));
    const Index b = surface.triangles.corner(previousCorner(fold.corner));
    const std::array<Index, 2> below = {faceOf(surface, reference, a),
                                        faceOf(surface, reference, b)};
    if (search.has(fold, surface.position[a], surface.position[b], below)) continue;
    for (const Index face : below) {
      if (face != kNone) faces.push_back(face);
    }
  }
  return faces;
}

}  // namespace tufa::reduce
