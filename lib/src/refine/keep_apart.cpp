#include "refine/keep_apart.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include "base/atomic_bits.h"
#include "base/collect.h"
#include "base/parallel_sort.h"
#include "base/single_precision.h"

namespace tufa::refine {
namespace {

using RoundedPlace = std::array<double, 3>;

double nextAbove(double x, bool singlePrecision) {
  if (!singlePrecision) return std::nextafter(x, std::numeric_limits<double>::infinity());
  return double{std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity())};
}

// Places by their hashes. A free place whose hash is that of a taken one, one in eight at most,
// counts as taken.
class TakenPlaces {
 public:
  using Entry = std::pair<RoundedPlace, VertexIndex>;

  // `placeOf` tells the place of a vertex; those without triangles do not count: collapses have
  // left them.
  template <class PlaceOf>
  TakenPlaces(const std::vector<Triangle>& triangles, std::size_t vertices, const PlaceOf& placeOf,
              base::Job& job)
      : size_(std::bit_ceil(8 * vertices + 1)), taken_(size_) {
    base::AtomicBits used(vertices), several(size_);
    job.forRanges(triangles.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        for (const VertexIndex v : triangles[t].vertices) used.add(v);
      }
    });
    job.forRanges(vertices, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        if (!used.has(v)) continue;
        if (const std::size_t at = slotOf(placeOf(v)); taken_.add(at)) several.add(at);
      }
    });
    const std::vector<VertexIndex> some = base::collectIf(job, vertices, [&](VertexIndex v) {
      return used.has(v) && several.has(slotOf(placeOf(v)));
    });
    std::vector<std::pair<std::uint64_t, VertexIndex>> hashes;
    hashes.reserve(some.size());
    for (const VertexIndex v : some) {
      hashes.emplace_back(hashOf(placeOf(v)), v);
    }
    base::parallelSort(hashes.begin(), hashes.end(), std::less<>());
    for (std::size_t i = 0; i < hashes.size(); ++i) {
      const auto isAsAt = [&](std::size_t j) {
        return j < hashes.size() && hashes[j].first == hashes[i].first;
      };
      const VertexIndex v = hashes[i].second;
      if (isAsAt(i - 1) || isAsAt(i + 1)) shared_.emplace_back(placeOf(v), v);
    }
    std::sort(shared_.begin(), shared_.end());
  }

  // The vertices whose places may be those of others, by place; these are few.
  [[nodiscard]] const std::vector<Entry>& shared() const { return shared_; }
  [[nodiscard]] bool has(const RoundedPlace& place) const { return taken_.has(slotOf(place)); }
  void add(const RoundedPlace& place) { taken_.add(slotOf(place)); }

 private:
  [[nodiscard]] static std::uint64_t hashOf(const RoundedPlace& place) {
    // The low bits of numbers in single precision are 0, so that multiplying alone mixes too few.
    std::uint64_t hash = 0;
    for (const double x : place) {
      hash ^= std::bit_cast<std::uint64_t>(x + 0.0);  // -0 as 0
      hash = (hash ^ hash >> 30) * 0xBF58476D1CE4E5B9U;
      hash = (hash ^ hash >> 27) * 0x94D049BB133111EBU;
      hash ^= hash >> 31;
    }
    return hash;
  }
  [[nodiscard]] std::size_t slotOf(const RoundedPlace& place) const {
    return static_cast<std::size_t>(hashOf(place)) & (size_ - 1);
  }

  std::size_t size_;  // a power of two
  base::AtomicBits taken_;
  std::vector<Entry> shared_;
};

}  // namespace

double keepApart(std::vector<Position>& positions, const std::vector<Triangle>& triangles,
                 const grid::Affine& affine, bool singlePrecision, base::Job& job) {
  const auto placeOf = [&](const Position& position) {
    const Position world = affine.toWorld(position);
    const Position p = singlePrecision ? base::toSingle(world) : world;
    return RoundedPlace{p.x, p.y, p.z};
  };
  const auto placeAt = [&](std::size_t v) { return placeOf(positions[v]); };
  TakenPlaces taken(triangles, positions.size(), placeAt, job);
  double moved = 0;
  for (std::size_t i = 1; i < taken.shared().size(); ++i) {
    const auto& [place, vertex] = taken.shared()[i];
    if (place != taken.shared()[i - 1].first) continue;
    Position& position = positions[vertex];
    const Position before = position;
    const auto moveBy = [&, at = place](double distance) {
      position = affine.fromWorld({at[0] + distance, at[1], at[2]});
    };
    // Numbers near 0 lie far closer together than the places that vertices can have.
    double step = nextAbove(place[0], singlePrecision) - place[0];
    for (moveBy(step); placeOf(position) == place; moveBy(step)) step *= 2;
    for (int n = 2; taken.has(placeOf(position)); ++n) moveBy(n * step);
    taken.add(placeOf(position));
    moved = std::max(moved, (Vec3(position) - Vec3(before)).length());
  }
  return moved / affine.voxelSize();
}

}  // namespace tufa::refine
