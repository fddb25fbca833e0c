#include "reduce/partition.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.h"
#include "base/shrink.h"

namespace tufa::reduce {
namespace {

// Of pairs of a part and a member, the members of each part.
base::Groups membersOf(const std::vector<std::array<Index, 2>>& pairs, std::size_t parts,
                       base::Job& job) {
  base::Groups groups = base::groupBy(
      pairs.size(), parts, [&](Index i) { return pairs[i][0]; }, [](Index, Index) {}, job);
  for (Index& member : groups.members) member = pairs[member][1];
  return groups;
}

}  // namespace

// The vertices before are gone before there are others: they are much memory.
void Partition::build(const Surface& surface, const PartSize& size, float share, base::Job& job) {
  tree_ = {};
  std::vector<Index> samplesAt;
  if (!surface.isWhole && surface.owner.size() > size.samples) {
    samplesAt = samplesAtVertices(surface, job);
  }
  tree_ = splitIntoParts(surface.position, samplesAt, size, share, job);
  base::release(samplesAt);
  this->share(surface, job);
}

void Partition::build(const Surface& surface, const std::vector<PartTree::Node>& tree,
                      base::Job& job) {
  tree_ = {};
  tree_ = splitAlong(surface.position, tree, job);
  share(surface, job);
}

// How many samples the triangles own, each counted at one vertex of its owner.
std::vector<Index> Partition::samplesAtVertices(const Surface& surface, base::Job& job) {
  std::vector<Index> samples(surface.position.size(), 0);
  for (std::size_t r = 0; r < surface.owner.size(); ++r) {
    job.pollCancelled(r);
    const Index owner = surface.owner[r];
    if (owner != kNone) ++samples[surface.triangles[owner].vertices[0]];
  }
  return samples;
}

void Partition::share(const Surface& surface, base::Job& job) {
  numberVertices(job);
  shareTriangles(surface, job);
  shareForms(surface, job);
  if (!surface.isWhole) shareSamples(surface, job);
}

void Partition::numberVertices(base::Job& job) {
  base::shrinkTo(partOf_, tree_.vertices.size(), job);
  base::shrinkTo(localVertex_, tree_.vertices.size(), job);
  job.forRanges(size(), 1, [&](std::size_t begin, std::size_t end) {
    for (auto p = static_cast<Index>(begin); p < end; ++p) {
      Index next = 0;
      for (const Index v : vertices(p)) partOf_[v] = p, localVertex_[v] = next++;
    }
  });
}

void Partition::shareTriangles(const Surface& surface, base::Job& job) {
  base::shrinkTo(inner_, surface.position.size(), job);
  job.forRanges(inner_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) inner_[v] = (surface.flags[v] & kBorder) == 0;
  });
  findRuns(surface, job);
  for (const Index t : across_) {
    for (const Index v : surface.triangles[t].vertices) inner_[v] = 0;
  }
  base::shrinkTo(localTriangle_, surface.isWhole ? 0 : surface.triangles.size(), job);
  if (!surface.isWhole) {
    job.forRanges(size(), 1, [&](std::size_t begin, std::size_t end) {
      for (auto p = static_cast<Index>(begin); p < end; ++p) {
        Index next = 0;
        forTriangles(p, [&](Index t) { localTriangle_[t] = next++; });
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

float Partition::innerShare() const {
  const auto inner = std::count(inner_.begin(), inner_.end(), 1);
  return inner_.empty() ? 1 : static_cast<float>(inner) / static_cast<float>(inner_.size());
}

void Partition::findRuns(const Surface& surface, base::Job& job) {
  struct RunOf {
    Index part;
    Run run;
  };
  const std::size_t count = surface.triangles.size(),
                    blocks = (count + base::kGrain - 1) / base::kGrain;
  std::vector<std::vector<RunOf>> found(blocks);
  job.forRanges(blocks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) {
      std::vector<RunOf>& own = found[block];
      const auto last = static_cast<Index>(std::min((block + 1) * base::kGrain, count));
      for (auto t = static_cast<Index>(block * base::kGrain); t < last; ++t) {
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
    for (auto p = static_cast<Index>(begin); p < end; ++p) sortSamples(surface, p, next, sorted);
  });
}

// Those of a triangle together, as they are read together. Where triangles have one or two, the
// order of the reference serves as well.
void Partition::sortSamples(const Surface& surface, Index part, std::vector<Index>& next,
                            std::vector<Index>& sorted) {
  const std::span<Index> own{samples_.members.data() + samples_.first[part],
                             samples_.members.data() + samples_.first[part + 1]};
  std::size_t triangles = 0;
  forTriangles(part, [&](Index) { ++triangles; });
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
