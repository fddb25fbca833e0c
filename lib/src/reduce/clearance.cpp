#include "reduce/clearance.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "reduce/box_group.h"
#include "reduce/star.h"

namespace tufa::reduce {
namespace {

// Cells that a part is divided into at once: at least so large, in voxels, and at most so many.
constexpr float kLeastCell = 2.5f;
constexpr double kMostCells = 65536;
// Where parts have so many times as many triangles of others as there are, all is narrow.
constexpr std::size_t kMostShared = 4;
// Normals that look so far apart have no common direction.
constexpr float kOpposite = -0.93f;

using List = std::vector<Index>;

struct Item {
  Vec3f normal;
  Box3f box;
  Box3f grown;  // by the reach
  Vec3f at;     // a point of the triangle
  Index triangle;
};

// The triangles about one part.
class Neighbourhood {
 public:
  Neighbourhood(Surface& surface, float reach) : surface_(surface), reach_(reach) {}

  void look(const List& triangles, const Box3f& within) {
    Box3f bounds;
    float sizes = 0;
    items_.reserve(triangles.size());
    for (const Index t : triangles) {
      const Vec3f p[3] = {surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2)};
      Box3f box = boxOf(p);
      bounds.add(box);
      sizes += length(box.upper - box.lower);
      Box3f grown = box;
      grown.growBy(reach_);
      items_.push_back({unit(cross(p[1] - p[0], p[2] - p[0])), box, grown, p[0], t});
    }
    List all(items_.size());
    std::iota(all.begin(), all.end(), 0);
    if (all.empty() || isOneSheet(all)) return;
    bounds.lower = maxVec3f(bounds.lower, within.lower);
    bounds.upper = minVec3f(bounds.upper, within.upper);
    const float mean = sizes / static_cast<float>(items_.size());
    lookInCells(bounds, std::max({kLeastCell, 2 * reach_, 1.5f * mean}));
  }

 private:
  struct Cells {
    Vec3f lower;
    float size;
    int count[3];
  };

  // By cells of a few triangles' size.
  void lookInCells(const Box3f& bounds, float size) {
    const Vec3f d = maxVec3f(bounds.upper - bounds.lower, Vec3f());
    const auto countAlong = [&](int axis) { return static_cast<int>(d[axis] / size) + 1; };
    const auto most = [&](int axis) { return static_cast<double>(d[axis] / size + 1); };
    while (most(0) * most(1) * most(2) > kMostCells) size *= 1.3f;
    const Cells cells{bounds.lower, size, {countAlong(0), countAlong(1), countAlong(2)}};
    const int* n = cells.count;
    std::vector<Index> first(static_cast<std::size_t>(n[0] * n[1] * n[2]) + 1, 0);
    for (const Item& item : items_) forCells(cells, item, [&](std::size_t c) { ++first[c + 1]; });
    for (std::size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
    List all(first.back());
    for (Index k = 0; k < items_.size(); ++k) {
      forCells(cells, items_[k], [&](std::size_t c) { all[first[c]++] = k; });
    }
    List list;
    for (std::size_t c = 0; c + 1 < first.size(); ++c) {  // first[c] is the end now
      list.assign(all.begin() + (c == 0 ? 0 : first[c - 1]), all.begin() + first[c]);
      if (list.empty()) continue;
      const int i = static_cast<int>(c);
      const Vec3f at(static_cast<float>(i % n[0]), static_cast<float>(i / n[0] % n[1]),
                     static_cast<float>(i / n[0] / n[1]));
      Box3f box;
      box.lower = bounds.lower + at * size;
      box.upper = box.lower + Vec3f(size, size, size);
      lookAt(list, box);
    }
  }

  // f(cell) for the cells that the plane of a triangle passes within the reach.
  template <class F>
  void forCells(const Cells& cells, const Item& item, F&& f) const {
    int from[3], to[3];
    for (int i = 0; i < 3; ++i) {
      from[i] = std::max(0, static_cast<int>((item.grown.lower[i] - cells.lower[i]) / cells.size));
      to[i] = static_cast<int>(std::min(static_cast<float>(cells.count[i] - 1),
                                        (item.grown.upper[i] - cells.lower[i]) / cells.size));
    }
    const Vec3f n = item.normal;
    const float half = 0.5f * cells.size * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) + reach_;
    const auto middleOf = [](int i) { return static_cast<float>(i) + 0.5f; };
    for (int z = from[2]; z <= to[2]; ++z) {
      for (int y = from[1]; y <= to[1]; ++y) {
        for (int x = from[0]; x <= to[0]; ++x) {
          const Vec3f middle =
              cells.lower + Vec3f(middleOf(x), middleOf(y), middleOf(z)) * cells.size;
          if (std::abs(dot(n, middle - item.at)) > half) continue;
          f(static_cast<std::size_t>((z * cells.count[1] + y) * cells.count[0] + x));
        }
      }
    }
  }

  bool isOneSheet(const List& list) const {
    constexpr int kRounds = 5;
    Vec3f sum;
    for (const Index i : list) {
      if (dot(items_[list[0]].normal, items_[i].normal) < kOpposite) return false;
      sum = sum + items_[i].normal;
    }
    for (int round = 0; round < kRounds; ++round) {
      const Vec3f axis = unit(sum);
      float leastCosine = 2;
      Index worst = 0;
      for (const Index i : list) {
        const float cosine = dot(axis, items_[i].normal);
        if (cosine < leastCosine) leastCosine = cosine, worst = i;
      }
      if (leastCosine > kLeastCosine) return true;
      sum = axis + items_[worst].normal * (0.8f / static_cast<float>(round + 1));
    }
    return false;
  }

  // Marks the triangles that pass a cell and do not make one sheet with those within the reach.
  void lookAt(const List& list, const Box3f& cell) {
    if (list.size() < 2 || isOneSheet(list) || areTwoSheetsApart(list)) return;
    constexpr std::size_t kSize = BoxGroup::kSize;
    grown_.assign((list.size() + kSize - 1) / kSize, {});
    for (std::size_t k = 0; k < list.size(); ++k) {
      grown_[k / kSize].set(k % kSize, items_[list[k]].grown);
    }
    for (const Index i : list) {
      if (cell.meets(items_[i].box) && !isOneSheetAround(i, list)) mark(items_[i].triangle);
    }
  }

  // Whether the triangles make two sheets, one above the other, with more than the reach between
  // them: most cells of thin shells.
  bool areTwoSheetsApart(const List& list) {
    near_.clear(), others_.clear();
    const Vec3f first = items_[list[0]].normal;
    Vec3f up;
    for (const Index i : list) {
      const bool isFirst = dot(first, items_[i].normal) >= 0;
      (isFirst ? near_ : others_).push_back(i);
      up = isFirst ? up + items_[i].normal : up - items_[i].normal;
    }
    if (others_.empty() || !isOneSheet(near_) || !isOneSheet(others_)) return false;
    up = unit(up);
    const auto [low, high] = heightsOf(near_, up);
    const auto [otherLow, otherHigh] = heightsOf(others_, up);
    return low - otherHigh > reach_ || otherLow - high > reach_;
  }

  [[nodiscard]] std::pair<float, float> heightsOf(const List& list, Vec3f up) const {
    float low = Box3f::kMost, high = -Box3f::kMost;
    for (const Index i : list) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const float height = dot(up, surface_.corner(items_[i].triangle, corner));
        low = std::min(low, height), high = std::max(high, height);
      }
    }
    return {low, high};
  }

  // `grown_` has the boxes of the list.
  bool isOneSheetAround(Index i, const List& list) {
    const Item& own = items_[i];
    near_.assign(1, i);
    for (std::size_t g = 0; g < grown_.size(); ++g) {
      const bool isOpposite = grown_[g].any(own.box, [&](std::size_t place) {
        const Index k = list[g * BoxGroup::kSize + place];
        if (k != i) near_.push_back(k);
        return dot(own.normal, items_[k].normal) < kOpposite;
      });
      if (isOpposite) return false;
    }
    return isOneSheet(near_);
  }

  // Triangles that reach into several parts are marked by several threads.
  void mark(Index triangle) {
    for (const Index v : surface_.triangles[triangle].vertices) {
      std::atomic_ref<std::uint8_t>(surface_.flags[v]).fetch_or(kNarrow, std::memory_order_relaxed);
    }
  }

  Surface& surface_;
  float reach_;
  std::vector<Item> items_;
  List near_, others_;
  std::vector<BoxGroup> grown_;
};

}  // namespace

void markNarrow(Surface& surface, const Partition& partition, float reach, base::Job& job) {
  const auto boxAbout = [&](Index t) {
    const Vec3f p[3] = {surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2)};
    Box3f box = boxOf(p);
    box.growBy(reach);
    return box;
  };
  // Those of a part that reach into others, too; most are far inside.
  std::vector<List> reaching(partition.size());
  job.forRanges(partition.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (Index p = static_cast<Index>(begin); p < end; ++p) {
      const Box3f& inside = partition.box(p);
      for (const Index t : partition.triangles(p)) {
        const Box3f box = boxAbout(t);
        if (!inside.hasInside(box.lower) || !inside.hasInside(box.upper)) reaching[p].push_back(t);
      }
    }
  });
  std::vector<List> others(partition.size());
  std::size_t shared = 0;
  const auto share = [&](Index t, Index own) {
    job.pollCancelled(shared);
    partition.forPartsAt(boxAbout(t), [&](Index part) {
      if (part != own) others[part].push_back(t), ++shared;
    });
  };
  const std::size_t most = kMostShared * surface.triangles.size();
  for (Index p = 0; p < reaching.size() && shared <= most; ++p) {
    for (const Index t : reaching[p]) share(t, p);
  }
  for (const Index t : partition.acrossParts()) {
    if (shared <= most) share(t, kNone);
  }
  if (shared > most) {  // most parts are near most others
    for (std::uint8_t& flags : surface.flags) flags |= kNarrow;
    return;
  }
  job.forRanges(others.size(), 1, [&](std::size_t begin, std::size_t end) {
    List all;
    for (std::size_t p = begin; p < end; ++p) {
      const List own = partition.triangles(static_cast<Index>(p));
      std::sort(others[p].begin(), others[p].end());
      all.clear();
      std::merge(own.begin(), own.end(), others[p].begin(), others[p].end(),
                 std::back_inserter(all));
      Neighbourhood(surface, reach).look(all, partition.box(static_cast<Index>(p)));
    }
  });
}

}  // namespace tufa::reduce
