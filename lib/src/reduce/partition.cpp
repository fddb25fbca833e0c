#include "reduce/partition.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.h"
#include "base/shrink.h"

namespace tufa::reduce {
namespace {

Box3f everywhere() {
  Box3f all;
  std::swap(all.lower, all.upper);
  return all;
}

const Box3f kEverywhere = everywhere();
constexpr std::size_t kGrain = 16384;

// Runs both, at the same time where there is enough to do.
template <class First, class Second>
void both(Index items, const First& first, const Second& second) {
  constexpr Index kEnough = 1 << 16;
  if (items >= kEnough) return base::runBoth(first, second);
  first();
  second();
}

// Of pairs of a part and a member, the members of each part.
base::Groups membersOf(const std::vector<std::array<Index, 2>>& pairs, std::size_t parts,
                       base::Job& job) {
  base::Groups groups = base::groupBy(
      pairs.size(), parts, [&](Index i) { return pairs[i][0]; }, [](Index, Index) {}, job);
  for (Index& member : groups.members) member = pairs[member][1];
  return groups;
}

}  // namespace

void Partition::build(const Surface& surface, const PartSize& size, float share, base::Job& job) {
  begin(surface, job);
  if (!surface.isWhole && surface.owner.size() > size.samples) countSamples(surface, job);
  Tree tree = split(0, static_cast<Index>(items_.size()), kEverywhere, size, share, job);
  nodes_ = std::move(tree.nodes);
  boxes_ = std::move(tree.boxes);
  ranges_.insert(ranges_.end(), tree.ends.begin(), tree.ends.end());
  base::release(samplesAt_);
  finish(surface, job);
}

void Partition::build(const Surface& surface, const std::vector<Node>& tree, base::Job& job) {
  begin(surface, job);
  nodes_ = tree;
  const std::size_t parts = nodes_.size() / 2 + 1;
  boxes_.resize(parts), ranges_.resize(parts + 1);
  splitAlong(0, 0, static_cast<Index>(items_.size()), kEverywhere);
  finish(surface, job);
}

void Partition::begin(const Surface& surface, base::Job& job) {
  base::resizeLarge(items_, surface.position.size(), job);
  job.forRanges(items_.size(), kGrain, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      items_[i] = {surface.position[i], static_cast<Index>(i)};
    }
  });
  ranges_.assign(1, 0);
}

void Partition::countSamples(const Surface& surface, base::Job& job) {
  samplesAt_.assign(surface.position.size(), 0);
  for (std::size_t r = 0; r < surface.owner.size(); ++r) {
    job.pollCancelled(r);
    const Index owner = surface.owner[r];
    if (owner != kNone) ++samplesAt_[surface.triangles[owner].vertices[0]];
  }
}

// Whether some items may be a part. Samples of a surface that is whole are at its vertices: as many
// in all parts.
bool Partition::isSmall(Index begin, Index end, const PartSize& size) const {
  if (end - begin > size.vertices) return false;
  if (samplesAt_.empty() || end - begin <= size.leastVertices) return true;
  std::size_t samples = 0;
  for (Index i = begin; i < end; ++i) samples += samplesAt_[items_[i].vertex];
  return samples <= size.samples;
}

void Partition::finish(const Surface& surface, base::Job& job) {
  numberVertices(job);
  shareTriangles(surface, job);
  shareForms(surface, job);
  if (!surface.isWhole) shareSamples(surface, job);
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

Partition::Tree Partition::split(Index begin, Index end, const Box3f& box, const PartSize& size,
                                 float share, base::Job& job) {
  const Tree part{{{-1, 0, 0, 0}}, {box}, {end}};
  if (isSmall(begin, end, size)) return part;
  job.checkCancelled(0, 1);
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
  if (cut == begin) return part;
  const float plane = planeBelow(least, axis, begin, cut);
  Box3f lower = box, upper = box;
  lower.upper[axis] = plane, upper.lower[axis] = plane;
  Tree low, high;
  both(
      end - begin, [&] { low = split(begin, cut, lower, size, share, job); },
      [&] { high = split(cut, end, upper, size, share, job); });
  Tree all{{{axis, plane, 0, 0}}, {}, {}};
  all.nodes[0].low = all.add(low);
  all.nodes[0].high = all.add(high);
  return all;
}

// Returns where its root is now.
Index Partition::Tree::add(const Tree& other) {
  const auto root = static_cast<Index>(nodes.size()), parts = static_cast<Index>(boxes.size());
  for (Node node : other.nodes) {
    node.low += node.axis < 0 ? parts : root;
    node.high += node.axis < 0 ? 0 : root;
    nodes.push_back(node);
  }
  boxes.insert(boxes.end(), other.boxes.begin(), other.boxes.end());
  ends.insert(ends.end(), other.ends.begin(), other.ends.end());
  return root;
}

void Partition::splitAlong(Index node, Index begin, Index end, const Box3f& box) {
  const Node n = nodes_[node];
  if (n.axis < 0) {
    boxes_[n.low] = box, ranges_[n.low + 1] = end;
    return;
  }
  const Index cut = moveBelow(begin, end, n.axis, n.at);
  Box3f low = box, high = box;
  low.upper[n.axis] = n.at, high.lower[n.axis] = n.at;
  both(
      end - begin, [&] { splitAlong(n.low, begin, cut, low); },
      [&] { splitAlong(n.high, cut, end, high); });
}

// Items, the largest array here, are gone before the others are made.
void Partition::numberVertices(base::Job& job) {
  const std::size_t count = items_.size();
  const auto forParts = [&](const auto& body) {
    job.forRanges(size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p)
        body(static_cast<Index>(p), ranges_[p], ranges_[p + 1]);
    });
  };
  base::shrinkTo(vertices_, count, job);
  forParts([&](Index, Index begin, Index end) {
    for (Index i = begin; i < end; ++i) vertices_[i] = items_[i].vertex;
    std::sort(vertices_.begin() + begin, vertices_.begin() + end);
  });
  base::release(items_);
  base::shrinkTo(partOf_, count, job);
  base::shrinkTo(localVertex_, count, job);
  forParts([&](Index part, Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      partOf_[vertices_[i]] = part;
      localVertex_[vertices_[i]] = i - begin;
    }
  });
}

void Partition::shareTriangles(const Surface& surface, base::Job& job) {
  base::shrinkTo(inner_, surface.position.size(), job);
  job.forRanges(inner_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) inner_[v] = (surface.flags[v] & kBorder) == 0;
  });
  findRuns(surface, job);
  for (const Index t : across_) {
    for (const Index v : surface.triangles[t].vertices) inner_[v] = 0;
  }
  base::shrinkTo(localTriangle_, surface.isWhole ? 0 : surface.triangles.size(), job);
  if (!surface.isWhole) {
    job.forRanges(size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) {
        Index next = 0;
        for (const Run& run : of(runs_, firstRun_, static_cast<Index>(p))) {
          for (Index t = run.begin; t < run.end; ++t) localTriangle_[t] = next++;
        }
      }
    });
  }
  std::vector<std::array<Index, 2>> reached;
  for (const Index t : across_) {
    Box3f box;
    for (const Index i : surface.triangles[t].vertices) box.add(surface.position[i]);
    forPartsAt(box, [&](Index part) { reached.push_back({part, t}); });
  }
  foreign_ = membersOf(reached, size(), job);
}

void Partition::findRuns(const Surface& surface, base::Job& job) {
  struct RunOf {
    Index part;
    Run run;
  };
  const std::size_t count = surface.triangles.size(), blocks = (count + kGrain - 1) / kGrain;
  std::vector<std::vector<RunOf>> found(blocks);
  job.forRanges(blocks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) {
      std::vector<RunOf>& own = found[block];
      const auto last = static_cast<Index>(std::min((block + 1) * kGrain, count));
      for (auto t = static_cast<Index>(block * kGrain); t < last; ++t) {
        const Index part = partOfTriangle(surface.triangles[t]);
        if (own.empty() || own.back().part != part) own.push_back({part, {t, t}});
        own.back().run.end = t + 1;
      }
    }
  });
  across_.clear();
  firstRun_.assign(size() + 2, 0);
  for (const std::vector<RunOf>& some : found) {
    for (const auto& [part, run] : some) {
      if (part != kNone) ++firstRun_[part + 2];
      for (Index t = run.begin; part == kNone && t < run.end; ++t) across_.push_back(t);
    }
  }
  for (std::size_t p = 1; p < firstRun_.size(); ++p) firstRun_[p] += firstRun_[p - 1];
  runs_.resize(firstRun_.back());
  for (const std::vector<RunOf>& some : found) {
    for (const auto& [part, run] : some) {
      if (part != kNone) runs_[firstRun_[part + 1]++] = run;
    }
  }
}

void Partition::shareForms(const Surface& surface, base::Job& job) {
  std::vector<std::array<Index, 2>> reached;
  for (Index i = 0; i < surface.oldForms.size(); ++i) {
    forPartsAt(boxOf(surface.oldForms[i].corners.data()), [&](Index part) {
      reached.push_back({part, i});
    });
  }
  forms_ = membersOf(reached, size(), job);
}

void Partition::shareSamples(const Surface& surface, base::Job& job) {
  base::resizeLarge(localSample_, surface.owner.size(), job);
  samples_ = base::groupBy(
      surface.owner.size(), size(),
      [&](Index r) {
        const Index owner = surface.owner[r];
        return owner == kNone ? kNone : partOfTriangle(surface.triangles[owner]);
      },
      [&](Index r, Index at) { localSample_[r] = at; }, job);
  job.forRanges(size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<Index> next, sorted;
    for (std::size_t p = begin; p < end; ++p) sortSamples(surface, p, next, sorted);
  });
}

// Those of a triangle together, as they are read together. Where triangles have one or two, the
// order of the reference serves as well.
void Partition::sortSamples(const Surface& surface, std::size_t part, std::vector<Index>& next,
                            std::vector<Index>& sorted) {
  const std::span<Index> own{samples_.members.data() + samples_.first[part],
                             samples_.members.data() + samples_.first[part + 1]};
  std::size_t triangles = 0;
  for (const Run& run : of(runs_, firstRun_, static_cast<Index>(part))) {
    triangles += run.end - run.begin;
  }
  if (own.size() < 2 * triangles) return;
  next.assign(triangles + 1, 0);
  for (const Index r : own) ++next[localTriangle_[surface.owner[r]] + 1];
  for (std::size_t t = 0; t < triangles; ++t) next[t + 1] += next[t];
  if (sorted.capacity() < own.size()) base::reserveLarge(sorted, own.size());
  sorted.resize(own.size());
  for (const Index r : own) sorted[next[localTriangle_[surface.owner[r]]]++] = r;
  for (Index s = 0; s < own.size(); ++s) own[s] = sorted[s], localSample_[sorted[s]] = s;
}

}  // namespace tufa::reduce
