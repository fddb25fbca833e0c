#include "extract/triangle_edges.h"

#include <algorithm>

#include "base/huge_pages.h"
#include "base/parallel_sort.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {
namespace {

// A side of a triangle.
struct Use {
  std::uint64_t ends;  // the lower vertex in the upper half
  std::uint64_t side;  // four times the triangle, plus its side
};

}  // namespace

TriangleEdges::TriangleEdges(const std::vector<Triangle>& triangles, base::Job& job) {
  std::vector<Use> uses;
  base::resizeLarge(uses, 3 * triangles.size(), job);
  job.forRanges(triangles.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t side = 0; side < 3; ++side) {
        const VertexIndex a = triangles[i].vertices[side];
        const VertexIndex b = triangles[i].vertices[(side + 1) % 3];
        uses[3 * i + side].ends = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
        uses[3 * i + side].side = 4 * i + side;
      }
    }
  });
  base::parallelSort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return a.ends != b.ends ? a.ends < b.ends : a.side < b.side;
  });
  base::resizeLarge(sides_, triangles.size(), job);
  base::resizeLarge(around_, uses.size(), job);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    job.pollCancelled(i);
    const Use& use = uses[i];
    if (i == 0 || use.ends != uses[i - 1].ends) {
      ends_.push_back({static_cast<VertexIndex>(use.ends >> 32),
                       static_cast<VertexIndex>(use.ends & 0xFFFFFFFFU)});
      first_.push_back(i);
    }
    around_[i] = static_cast<std::uint32_t>(use.side / 4);
    sides_[use.side / 4][use.side % 4] = static_cast<EdgeIndex>(ends_.size() - 1);
  }
  uniform::requireIndexable(ends_.size());
  first_.push_back(uses.size());
}

}  // namespace tufa::extraction
