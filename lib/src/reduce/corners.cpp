#include "reduce/corners.h"

#include <algorithm>

#include "base/huge_pages.h"
#include "base/sort_unique.h"

namespace tufa::reduce {

namespace {

// A range has so many vertices, or more where there would be too many ranges for a word.
constexpr int kLeastShift = 15;
constexpr std::size_t kMostRanges = 64;

}  // namespace

std::vector<Index> oppositeCorners(const base::TriangleView& triangles,
                                   const CornersOfVertices& corners, base::Job& job) {
  std::vector<Index> opposite;
  base::resizeLarge(opposite, 3 * triangles.size(), job);
  job.forRanges(corners.end(), [&](std::size_t begin, std::size_t end) {
    forOppositeCorners(triangles, corners, static_cast<Index>(begin), static_cast<Index>(end),
                       [&](Index corner, Index other) { opposite[corner] = other; });
  });
  return opposite;
}

std::vector<Index> trianglesAround(const base::TriangleView& triangles,
                                   const CornersOfVertices& corners, std::span<const Index> some) {
  std::vector<Index> around;
  for (const Index t : some) {
    for (const Index v : triangles[t].vertices) {
      for (const Index c : corners.of(v)) around.push_back(c / 3);
    }
  }
  base::sortUnique(around);
  return around;
}

template <class ForTriangles>
CornersOfVertices::CornersOfVertices(Index begin, Index end, const base::TriangleView& triangles,
                                     const ForTriangles& forTriangles)
    : begin_(begin) {
  const Index count = end - begin;
  const auto forCorners = [&](const auto& body) {
    forTriangles([&](std::size_t t) {
      for (Index i = 0; i < 3; ++i) {
        const Index v = triangles[t].vertices[i] - begin;  // large for those before
        if (v < count) body(v, 3 * static_cast<Index>(t) + i);
      }
    });
  };
  base::reserveLarge(first_, count + 2);
  first_.resize(count + 2);
  forCorners([&](Index v, Index) { ++first_[v + 2]; });
  for (std::size_t i = 0; i < count; ++i) first_[i + 2] += first_[i + 1];
  base::reserveLarge(corners_, first_.back());
  corners_.resize(first_.back());
  forCorners([&](Index v, Index c) { corners_[first_[v + 1]++] = c; });
}

CornersOfVertices::CornersOfVertices(std::size_t vertexCount, const base::TriangleView& triangles,
                                     base::Job& job)
    : CornersOfVertices(0, static_cast<Index>(vertexCount), triangles, [&](const auto& body) {
        for (std::size_t t = 0; t < triangles.size(); ++t) {
          job.pollCancelled(t);
          body(t);
        }
      }) {}

CornerRanges::CornerRanges(std::size_t vertexCount, const base::TriangleView& triangles,
                           base::Job& job)
    : vertexCount_(vertexCount), triangles_(triangles), shift_(kLeastShift) {
  while (vertexCount > kMostRanges << shift_) ++shift_;
  size_ = (vertexCount + (std::size_t{1} << shift_) - 1) >> shift_;
  reached_.resize((triangles.size() + base::kGrain - 1) / base::kGrain);
  job.forRanges(reached_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) {
      const std::size_t last = std::min((block + 1) * base::kGrain, triangles.size());
      std::uint64_t reached = 0;
      for (std::size_t t = block * base::kGrain; t < last; ++t) {
        for (const Index v : triangles[t].vertices) reached |= std::uint64_t{1} << (v >> shift_);
      }
      reached_[block] = reached;
    }
  });
}

CornersOfVertices CornerRanges::operator[](std::size_t range) const {
  const auto begin = static_cast<Index>(range << shift_);
  const auto end = static_cast<Index>(std::min((range + 1) << shift_, vertexCount_));
  return {begin, end, triangles_, [&](const auto& body) {
            for (std::size_t block = 0; block < reached_.size(); ++block) {
              if (((reached_[block] >> range) & 1) == 0) continue;
              const std::size_t last = std::min((block + 1) * base::kGrain, triangles_.size());
              for (std::size_t t = block * base::kGrain; t < last; ++t) body(t);
            }
          }};
}

}  // namespace tufa::reduce
