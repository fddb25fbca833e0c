#include "chunks/cut/join_vertices.h"

#include <algorithm>
#include <iterator>
#include <unordered_map>
#include <utility>

#include "base/collect.h"
#include "chunks/cut/turned.h"

namespace tufa::chunks {
namespace {

using Edge = std::pair<VertexIndex, VertexIndex>;

// Triangles may turn by the angle of this cosine, and shrink to this share.
constexpr double kTurnCosine = 0.5;
constexpr double kLeastShare = 0.1;

class Joiner {
 public:
  Joiner(const std::vector<Vec3>& points, double least, bool mayFold,
         const std::function<bool(VertexIndex, VertexIndex)>& mayGoInto,
         std::vector<Triangle>& triangles, std::vector<MovedVertex>& changed, base::Job& job)
      : points_(points),
        least_(least),
        mayFold_(mayFold),
        mayGoInto_(mayGoInto),
        triangles_(triangles),
        changed_(changed),
        job_(job) {}

  void run(std::span<const std::uint8_t> marks) {
    const std::vector<Edge> edges = findEdges(marks);
    if (edges.empty()) return;
    std::unordered_map<VertexIndex, VertexIndex> into;
    findTriangles(edges);
    for (auto [a, b] : edges) {
      while (into.contains(a)) a = into.at(a);
      while (into.contains(b)) b = into.at(b);
      if (!mayGoInto_(b, a)) std::swap(a, b);
      if (a == b || !isShort(a, b) || !mayGoInto_(b, a) || !mayJoin(a, b) || spoils(a, b) ||
          (!mayFold_ && folds(a, b))) {
        continue;
      }
      join(a, b);
      into.emplace(b, a);
    }
    std::erase_if(triangles_, [](const Triangle& t) { return has(t, kGone); });
    for (const auto& [gone, next] : into) {
      VertexIndex last = next;
      while (into.contains(last)) last = into.at(last);
      const double by = (points_[gone] - points_[last]).length();
      changed_.insert(changed_.end(), {{gone, by}, {last, by}});
    }
  }

 private:
  static constexpr VertexIndex kGone = ~VertexIndex{0};

  [[nodiscard]] bool isShort(VertexIndex a, VertexIndex b) const {
    return (points_[a] - points_[b]).squaredLength() < least_ * least_;
  }

  // Those that are short, of triangles with a marked vertex, of both ends the lower one first.
  [[nodiscard]] std::vector<Edge> findEdges(std::span<const std::uint8_t> marks) const {
    const auto forShort = [&](std::uint32_t t, const auto& visit) {
      const auto& v = triangles_[t].vertices;
      for (std::size_t i = 0; i < 3; ++i) {
        const VertexIndex a = v[i], b = v[(i + 1) % 3];
        if (a < b && isShort(a, b)) visit(a, b);
      }
    };
    const std::vector<std::uint32_t> some =
        base::collectIf(job_, triangles_.size(), [&](std::uint32_t t) {
          const auto& v = triangles_[t].vertices;
          bool isAny = false;
          if (!marks.empty() && (marks[v[0]] | marks[v[1]] | marks[v[2]]) == 0) return false;
          forShort(t, [&](VertexIndex, VertexIndex) { isAny = true; });
          return isAny;
        });
    std::vector<Edge> edges;
    for (const std::uint32_t t : some) {
      forShort(t, [&](VertexIndex a, VertexIndex b) { edges.emplace_back(a, b); });
    }
    return edges;
  }

  // Around the ends of short edges.
  void findTriangles(const std::vector<Edge>& edges) {
    std::vector<std::uint8_t> isEnd(points_.size(), 0);
    for (const auto& [a, b] : edges) {
      around_[a], around_[b];
      isEnd[a] = isEnd[b] = 1;
    }
    const std::vector<std::uint32_t> near =
        base::collectIf(job_, triangles_.size(), [&](std::uint32_t t) {
          const auto& v = triangles_[t].vertices;
          return (isEnd[v[0]] | isEnd[v[1]] | isEnd[v[2]]) != 0;
        });
    for (const std::uint32_t t : near) {
      for (const VertexIndex v : triangles_[t].vertices) {
        if (isEnd[v] != 0) around_.at(v).push_back(t);
      }
    }
  }

  [[nodiscard]] std::vector<VertexIndex> neighbours(VertexIndex v) const {
    std::vector<VertexIndex> all;
    for (const std::uint32_t t : around_.at(v)) {
      for (const VertexIndex w : triangles_[t].vertices) {
        if (w != v && w != kGone) all.push_back(w);
      }
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  // The link condition: the ends have no neighbours in common but those in the edge's two
  // triangles.
  [[nodiscard]] bool mayJoin(VertexIndex a, VertexIndex b) const {
    std::vector<VertexIndex> p = neighbours(a), q = neighbours(b), common;
    // On an open border a neighbour is met once.
    const auto isOpen = [](const std::vector<VertexIndex>& all) {
      for (std::size_t i = 0; i < all.size(); i += 2) {
        if (i + 1 == all.size() || all[i] != all[i + 1]) return true;
      }
      return false;
    };
    if (isOpen(p) || isOpen(q) || p.size() <= 6 || q.size() <= 6) return false;
    std::set_intersection(p.begin(), p.end(), q.begin(), q.end(), std::back_inserter(common));
    return common.size() == 4;  // each twice
  }

  // Whether a triangle would turn or shrink too much if b went into a.
  [[nodiscard]] bool spoils(VertexIndex a, VertexIndex b) const {
    return std::any_of(around_.at(b).begin(), around_.at(b).end(), [&](std::uint32_t t) {
      if (has(triangles_[t], kGone) || has(triangles_[t], a)) return false;
      Vec3 before[3], after[3];
      for (std::size_t i = 0; i < 3; ++i) {
        const VertexIndex v = triangles_[t].vertices[i];
        before[i] = points_[v], after[i] = points_[v == b ? a : v];
      }
      return isTurned(before, after, kTurnCosine, kLeastShare);
    });
  }

  // Whether triangles that lie on each other would become neighbours if b went into a: along the
  // edge of a thin sheet, the strip between both sides may be as narrow as the edges that go.
  [[nodiscard]] bool folds(VertexIndex a, VertexIndex b) const {
    // Of the triangle at `end` with an edge to x and without `other`.
    const auto normalAt = [&](VertexIndex end, VertexIndex other, VertexIndex x) {
      for (const std::uint32_t t : around_.at(end)) {
        if (!has(triangles_[t], x) || has(triangles_[t], other)) continue;
        const auto& v = triangles_[t].vertices;
        const Vec3 p[3] = {points_[v[0] == b ? a : v[0]], points_[v[1] == b ? a : v[1]],
                           points_[v[2] == b ? a : v[2]]};
        return (p[1] - p[0]).cross(p[2] - p[0]);
      }
      return Vec3(0);
    };
    return std::any_of(around_.at(b).begin(), around_.at(b).end(), [&](std::uint32_t t) {
      if (!has(triangles_[t], a)) return false;
      return std::any_of(triangles_[t].vertices.begin(), triangles_[t].vertices.end(),
                         [&](VertexIndex x) {
                           return x != a && x != b && isFold(normalAt(a, b, x), normalAt(b, a, x));
                         });
    });
  }

  void join(VertexIndex a, VertexIndex b) {
    for (const std::uint32_t t : around_.at(b)) {
      Triangle& triangle = triangles_[t];
      if (has(triangle, kGone)) continue;
      if (has(triangle, a)) {
        triangle = {kGone, kGone, kGone};
        continue;
      }
      for (VertexIndex& v : triangle.vertices) v = v == b ? a : v;
      around_.at(a).push_back(t);
    }
    around_.at(b).clear();
  }

  const std::vector<Vec3>& points_;
  double least_;
  bool mayFold_;
  const std::function<bool(VertexIndex, VertexIndex)>& mayGoInto_;
  std::vector<Triangle>& triangles_;
  std::vector<MovedVertex>& changed_;
  base::Job& job_;
  std::unordered_map<VertexIndex, std::vector<std::uint32_t>> around_;
};

}  // namespace

void joinNearVertices(const std::vector<Vec3>& points, double least, bool mayFold,
                      std::span<const std::uint8_t> marks,
                      const std::function<bool(VertexIndex, VertexIndex)>& mayGoInto,
                      std::vector<Triangle>& triangles, std::vector<MovedVertex>& changed,
                      base::Job& job) {
  Joiner(points, least, mayFold, mayGoInto, triangles, changed, job).run(marks);
}

}  // namespace tufa::chunks
