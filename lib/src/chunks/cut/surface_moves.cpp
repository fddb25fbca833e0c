#include "chunks/cut/surface_moves.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "base/collect.h"
#include "base/huge_pages.h"

namespace tufa::chunks {
namespace {

float roundedUp(double value) {
  const auto nearest = static_cast<float>(value);
  return double{nearest} < value ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
                                 : nearest;
}

}  // namespace

void SurfaceMoves::reserve(std::size_t count, std::size_t room, base::Job& job) {
  base::reservePopulated(by_, room, job);
  base::resizeLarge(by_, count, job);
}

// A point of a triangle at a vertex was, before, in a triangle at that vertex, or at one of those
// whose triangles changed with its own: these form clusters of neighbours. So it is as far as these
// triangles were at most, and by what the change adds.
void SurfaceMoves::add(Kind kind, const std::vector<Triangle>& before,
                       const std::vector<MovedVertex>& changes, base::Job& job) {
  if (changes.empty()) return;
  struct Change {
    float by = 0, most = 0;
  };
  std::vector<std::uint32_t> numberOf(by_.size(), 0);  // of a change, plus one
  std::vector<Change> all;
  for (const auto& [v, by] : changes) {
    if (numberOf[v] == 0) {
      all.push_back({0, by_[v]});
      numberOf[v] = static_cast<std::uint32_t>(all.size());
    }
    float& most = all[numberOf[v] - 1].by;
    most = std::max(most, roundedUp(by));
  }
  const std::vector<std::uint32_t> touched =
      base::collectIf(job, before.size(), [&](std::uint32_t t) {
        const auto& v = before[t].vertices;
        return (numberOf[v[0]] | numberOf[v[1]] | numberOf[v[2]]) != 0;
      });
  const auto forChanges = [&](std::uint32_t t, const auto& visit) {
    for (const VertexIndex v : before[t].vertices) {
      if (numberOf[v] != 0) visit(all[numberOf[v] - 1]);
    }
  };
  for (const std::uint32_t t : touched) {
    const auto& v = before[t].vertices;
    const float most = std::max({by_[v[0]], by_[v[1]], by_[v[2]]});
    forChanges(t, [&](Change& change) { change.most = std::max(change.most, most); });
  }
  for (bool isAny = kind == Kind::Triangles; isAny;) {
    isAny = false;
    for (const std::uint32_t t : touched) {
      Change largest;
      forChanges(t, [&](const Change& change) {
        largest.by = std::max(largest.by, change.by);
        largest.most = std::max(largest.most, change.most);
      });
      forChanges(t, [&](Change& change) {
        isAny |= change.by < largest.by || change.most < largest.most;
        change.by = largest.by, change.most = largest.most;
      });
    }
  }
  for (const auto& [v, by] : changes) {
    const Change& change = all[numberOf[v] - 1];
    by_[v] = roundedUp(double{change.most} + double{change.by});
  }
}

std::vector<MovedVertex> SurfaceMoves::take(const std::vector<Triangle>& triangles,
                                            base::Job& job) {
  const auto mostOf = [&](const Triangle& t) {
    return std::max({by_[t.vertices[0]], by_[t.vertices[1]], by_[t.vertices[2]]});
  };
  std::vector<float> most(by_.size(), 0);
  for (const std::uint32_t t : base::collectIf(
           job, triangles.size(), [&](std::uint32_t i) { return mostOf(triangles[i]) > 0; })) {
    const float by = mostOf(triangles[t]);
    for (const VertexIndex v : triangles[t].vertices) most[v] = std::max(most[v], by);
  }
  by_ = {};
  std::vector<MovedVertex> moved;
  for (VertexIndex v = 0; v < most.size(); ++v) {
    if (most[v] > 0) moved.push_back({v, double{most[v]}});
  }
  return moved;
}

}  // namespace tufa::chunks
