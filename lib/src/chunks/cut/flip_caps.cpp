#include "chunks/cut/flip_caps.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include "base/collect.h"
#include "base/sort_unique.h"
#include "chunks/cut/turned.h"

namespace tufa::chunks {
namespace {

// Rows of vertices need one pass for each vertex between two others.
constexpr int kMostPasses = 4;
// The triangle across the edge must be so many times as high.
constexpr double kHigher = 8;
// The square of a height over that of a cap's, above all rounding.
constexpr double kClearlyHigh = 1.001;

using MayFlip = std::function<bool(const std::array<VertexIndex, 4>&)>;

std::uint64_t keyOf(VertexIndex from, VertexIndex to) { return std::uint64_t{from} << 32 | to; }

class CapFlipper {
 public:
  CapFlipper(const std::vector<Vec3>& points, double height, const MayFlip& mayFlip,
             std::vector<Triangle>& triangles, std::vector<MovedVertex>& changed, base::Job& job)
      : points_(points),
        height_(height),
        mayFlip_(mayFlip),
        triangles_(triangles),
        changed_(changed),
        job_(job) {}

  void run(std::span<const std::uint8_t> marks) {
    std::vector<std::uint32_t> caps =
        base::collectIf(job_, triangles_.size(), [&](std::uint32_t t) {
          const auto& v = triangles_[t].vertices;
          return (marks.empty() || (marks[v[0]] | marks[v[1]] | marks[v[2]]) != 0) && isCap(t);
        });
    for (int i = 0; i < kMostPasses && !caps.empty(); ++i) {
      flipped_.clear();
      pass(caps);
      if (flipped_.empty()) break;
      caps.insert(caps.end(), flipped_.begin(), flipped_.end());
      base::sortUnique(caps);
      std::erase_if(caps, [&](std::uint32_t t) { return !isCap(t); });
    }
  }

 private:
  static constexpr std::size_t kNone = 3;

  void pass(const std::vector<std::uint32_t>& caps) {
    std::vector<std::uint8_t> isNear(points_.size(), 0);
    for (const std::uint32_t t : caps) {
      for (const VertexIndex v : triangles_[t].vertices) isNear[v] = 1;
    }
    behind_.clear();
    const std::vector<std::uint32_t> near =
        base::collectIf(job_, triangles_.size(), [&](std::uint32_t t) {
          const auto& v = triangles_[t].vertices;
          return (isNear[v[0]] | isNear[v[1]] | isNear[v[2]]) != 0;
        });
    for (const std::uint32_t t : near) note(t);
    for (const std::uint32_t t : caps) flip(t);
  }

  void note(std::uint32_t t) {
    const auto& v = triangles_[t].vertices;
    for (std::size_t i = 0; i < 3; ++i) behind_[keyOf(v[i], v[(i + 1) % 3])] = t;
  }

  [[nodiscard]] double heightOver(VertexIndex p, VertexIndex q, VertexIndex r) const {
    const Vec3 along = points_[q] - points_[p];
    const double length = along.length();
    return length > 0 ? along.cross(points_[r] - points_[p]).length() / length : 0;
  }

  // Whether the triangle is higher over its longest edge, and so over all, by the square of that.
  [[nodiscard]] bool isHigh(const Triangle& t) const {
    const Vec3 a = points_[t.vertices[0]], x = points_[t.vertices[1]] - a,
               y = points_[t.vertices[2]] - a;
    const double longest =
        std::max({x.squaredLength(), y.squaredLength(), (y - x).squaredLength()});
    return x.cross(y).squaredLength() > kClearlyHigh * height_ * height_ * longest;
  }

  // The corner of a cap opposite its longest edge, or kNone.
  [[nodiscard]] std::size_t apexOf(const Triangle& t) const {
    if (isHigh(t)) return kNone;
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex r = t.vertices[i], p = t.vertices[(i + 1) % 3], q = t.vertices[(i + 2) % 3];
      const Vec3 along = points_[q] - points_[p], to = points_[r] - points_[p];
      const double at = along.dot(to), whole = along.squaredLength();
      if (at > 0 && at < whole && heightOver(p, q, r) < height_) return i;
    }
    return kNone;
  }

  [[nodiscard]] bool isCap(std::uint32_t t) const { return apexOf(triangles_[t]) != kNone; }

  [[nodiscard]] Vec3 normalOf(const Triangle& t) const {
    const Vec3 a = points_[t.vertices[0]];
    return (points_[t.vertices[1]] - a).cross(points_[t.vertices[2]] - a);
  }

  // Whether a triangle that gets this edge, in the direction of the one behind, would lie on that.
  [[nodiscard]] bool folds(VertexIndex from, VertexIndex to, const Triangle& t) const {
    const auto behind = behind_.find(keyOf(from, to));
    return behind != behind_.end() && isFold(normalOf(t), normalOf(triangles_[behind->second]));
  }

  // (r, p, q) and (s, q, p) become (r, p, s) and (r, s, q).
  void flip(std::uint32_t t) {
    const std::size_t i = apexOf(triangles_[t]);
    if (i == kNone) return;
    const VertexIndex r = triangles_[t].vertices[i], p = triangles_[t].vertices[(i + 1) % 3],
                      q = triangles_[t].vertices[(i + 2) % 3];
    const auto across = behind_.find(keyOf(q, p));
    if (across == behind_.end()) return;
    const std::uint32_t other = across->second;
    VertexIndex s = r;
    for (const VertexIndex v : triangles_[other].vertices) {
      if (v != p && v != q) s = v;
    }
    if (s == r || heightOver(p, q, s) < kHigher * height_ || behind_.contains(keyOf(r, s)) ||
        behind_.contains(keyOf(s, r)) || !mayFlip_({p, q, r, s})) {
      return;
    }
    if (folds(p, r, {r, p, s}) || folds(r, q, {r, s, q})) return;
    behind_.erase(keyOf(p, q));
    behind_.erase(keyOf(q, p));
    triangles_[t] = {r, p, s};
    triangles_[other] = {r, s, q};
    note(t);
    note(other);
    const double moved = std::max(moved_[t], moved_[other]) + heightOver(p, q, r);
    moved_[t] = moved_[other] = moved;
    flipped_.insert(flipped_.end(), {t, other});
    for (const VertexIndex v : {p, q, r, s}) changed_.push_back({v, moved});
  }

  const std::vector<Vec3>& points_;
  double height_;
  const MayFlip& mayFlip_;
  std::vector<Triangle>& triangles_;
  std::vector<MovedVertex>& changed_;
  base::Job& job_;
  std::unordered_map<std::uint64_t, std::uint32_t> behind_;  ///< the triangle left of an edge
  std::vector<std::uint32_t> flipped_;                       ///< triangles, in the pass at hand
  std::unordered_map<std::uint32_t, double> moved_;          ///< how far flips have moved triangles
};

}  // namespace

void flipCaps(const std::vector<Vec3>& points, double height, std::span<const std::uint8_t> marks,
              const MayFlip& mayFlip, std::vector<Triangle>& triangles,
              std::vector<MovedVertex>& changed, base::Job& job) {
  CapFlipper(points, height, mayFlip, triangles, changed, job).run(marks);
}

}  // namespace tufa::chunks
