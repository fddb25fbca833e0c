#include "reduce/partition.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tufa::reduce {
namespace {

Box3f everywhere() {
  Box3f all;
  std::swap(all.lower, all.upper);
  return all;
}

const Box3f kEverywhere = everywhere();

}  // namespace

void Partition::build(const Surface& surface, Index most, float share, base::Job& job) {
  begin(surface);
  nodes_.clear();
  split(0, static_cast<Index>(items_.size()), kEverywhere, most, share);
  finish(surface, job);
}

void Partition::build(const Surface& surface, const std::vector<Node>& tree, base::Job& job) {
  begin(surface);
  nodes_ = tree;
  splitAlong(0, 0, static_cast<Index>(items_.size()), kEverywhere);
  finish(surface, job);
}

void Partition::begin(const Surface& surface) {
  items_.resize(surface.position.size());
  for (Index i = 0; i < items_.size(); ++i) items_[i] = {surface.position[i], i};
  boxes_.clear(), ranges_.assign(1, 0);
}

void Partition::finish(const Surface& surface, base::Job& job) {
  numberVertices(job);
  shareTriangles(surface);
  shareSamples(surface);
}

Index Partition::addPart(Index end, const Box3f& box) {
  boxes_.push_back(box);
  ranges_.push_back(end);
  return static_cast<Index>(boxes_.size() - 1);
}

// Items below a plane go first; the end of them. Those on it are the upper side's, but may not
// move.
Index Partition::moveBelow(Index begin, Index end, int axis, float plane) {
  const auto middle = std::partition(items_.begin() + begin, items_.begin() + end,
                                     [&](const Item& i) { return i.p[axis] < plane; });
  return static_cast<Index>(middle - items_.begin());
}

// A plane between the items before `end` and others from `least` on: on it, the vertices of a face
// across the axis could not move.
float Partition::planeBelow(float least, int axis, Index begin, Index end) const {
  float most = items_[begin].p[axis];
  for (Index i = begin; i < end; ++i) most = std::max(most, items_[i].p[axis]);
  const float middle = most + (least - most) / 2;
  return middle > most ? middle : least;
}

Index Partition::split(Index begin, Index end, const Box3f& box, Index most, float share) {
  const Index me = static_cast<Index>(nodes_.size());
  nodes_.push_back({-1, 0, 0, 0});
  if (end - begin <= most) return nodes_[me].low = addPart(end, box), me;
  Box3f bounds;
  for (Index i = begin; i < end; ++i) bounds.add(items_[i].p);
  const Vec3f d = bounds.upper - bounds.lower;
  const int axis = d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
  const auto first = items_.begin() + begin, last = items_.begin() + end;
  const auto middle = first + static_cast<std::ptrdiff_t>(static_cast<float>(end - begin) * share);
  std::nth_element(first, middle, last, [&](const Item& a, const Item& b) {
    return a.p[axis] < b.p[axis] || (a.p[axis] == b.p[axis] && a.vertex < b.vertex);
  });
  const float least = middle->p[axis];  // of the upper side
  const Index cut = moveBelow(begin, end, axis, least);
  if (cut == begin) return nodes_[me].low = addPart(end, box), me;
  const float plane = planeBelow(least, axis, begin, cut);
  Box3f low = box, high = box;
  low.upper[axis] = plane, high.lower[axis] = plane;
  const Index l = split(begin, cut, low, most, share), h = split(cut, end, high, most, share);
  nodes_[me] = {axis, plane, l, h};
  return me;
}

void Partition::splitAlong(Index node, Index begin, Index end, const Box3f& box) {
  const Node n = nodes_[node];
  if (n.axis < 0) {
    nodes_[node].low = addPart(end, box);
    return;
  }
  const Index cut = moveBelow(begin, end, n.axis, n.at);
  Box3f low = box, high = box;
  low.upper[n.axis] = n.at, high.lower[n.axis] = n.at;
  splitAlong(n.low, begin, cut, low);
  splitAlong(n.high, cut, end, high);
}

void Partition::numberVertices(base::Job& job) {
  const std::size_t count = items_.size();
  vertices_.resize(count), partOf_.resize(count), localVertex_.resize(count);
  job.forRanges(size(), 1, [&](std::size_t firstPart, std::size_t endPart) {
    for (std::size_t p = firstPart; p < endPart; ++p) {
      const Index begin = ranges_[p], end = ranges_[p + 1];
      for (Index i = begin; i < end; ++i) vertices_[i] = items_[i].vertex;
      std::sort(vertices_.begin() + begin, vertices_.begin() + end);
      for (Index i = begin; i < end; ++i) {
        partOf_[vertices_[i]] = static_cast<Index>(p);
        localVertex_[vertices_[i]] = i - begin;
      }
    }
  });
}

void Partition::shareTriangles(const Surface& surface) {
  const std::size_t parts = size(), count = surface.triangles.size();
  inner_.assign(surface.position.size(), 1);
  for (Index v = 0; v < inner_.size(); ++v) inner_[v] = (surface.flags[v] & kBorder) == 0;
  triangleFirst_.assign(parts + 1, 0), foreignFirst_.assign(parts + 1, 0);
  partOfTriangle_.resize(count), localTriangle_.resize(count);
  std::vector<std::array<Index, 2>> across;
  for (Index t = 0; t < count; ++t) {
    const auto& v = surface.triangles[t].vertices;
    const Index b = partOf_[v[0]];
    const bool owned = b == partOf_[v[1]] && b == partOf_[v[2]];
    partOfTriangle_[t] = owned ? b : kNone;
    if (owned) {
      localTriangle_[t] = triangleFirst_[b + 1]++;
      continue;
    }
    Box3f box;
    for (const Index i : v) inner_[i] = 0, box.add(surface.position[i]);
    forPartsAt(box, [&](Index k) { across.push_back({k, t}), ++foreignFirst_[k + 1]; });
  }
  for (std::size_t b = 0; b < parts; ++b) {
    triangleFirst_[b + 1] += triangleFirst_[b], foreignFirst_[b + 1] += foreignFirst_[b];
  }
  triangles_.resize(triangleFirst_[parts]), foreign_.resize(across.size());
  for (Index t = 0; t < count; ++t) {
    if (const Index b = partOfTriangle_[t]; b != kNone) {
      triangles_[triangleFirst_[b] + localTriangle_[t]] = t;
    }
  }
  std::vector<Index> at(foreignFirst_.begin(), foreignFirst_.end());
  for (const auto& [b, t] : across) foreign_[at[b]++] = t;
}

void Partition::shareSamples(const Surface& surface) {
  sampleFirst_.assign(size() + 1, 0);
  const auto partOfSample = [&](Index r) {
    return surface.owner[r] == kNone ? kNone : partOfTriangle_[surface.owner[r]];
  };
  for (Index r = 0; r < surface.owner.size(); ++r) {
    if (const Index b = partOfSample(r); b != kNone) ++sampleFirst_[b + 1];
  }
  for (std::size_t b = 0; b < size(); ++b) sampleFirst_[b + 1] += sampleFirst_[b];
  samples_.resize(sampleFirst_.back());
  std::vector<Index> at(sampleFirst_.begin(), sampleFirst_.end());
  localSample_.assign(surface.owner.size(), kNone);
  for (Index r = 0; r < surface.owner.size(); ++r) {
    const Index b = partOfSample(r);
    if (b == kNone) continue;
    localSample_[r] = at[b] - sampleFirst_[b];
    samples_[at[b]++] = r;
  }
}

}  // namespace tufa::reduce
