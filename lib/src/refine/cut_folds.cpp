#include "refine/cut_folds.h"

#include <algorithm>
#include <cstdint>

#include "base/collect.h"
#include "base/huge_pages.h"

namespace tufa::refine {
namespace {

using base::Vec3f;
using reduce::Index;

// Cosine of 149 degrees and area in square voxels: positions are still to be rounded.
constexpr float kFoldCosine = -0.857f;
constexpr float kLeastArea = 0.048f;
// Two sheets of a smaller cosine (148 degrees) may have faces as sharp.
constexpr double kSharpSheets = -0.848;
// But faces that turn by more than 149.9 degrees only those that do so by more than 150.5.
constexpr double kOver = -0.8652, kOverSheets = -0.87;
// A face within this cosine (25 degrees) of a sheet lies on it.
constexpr double kSameSideCosine = 0.906;

struct Fold {
  std::array<Index, 2> triangles;
  std::array<Vec3, 2> normals;
  std::array<VertexIndex, 2> ends;  // of their edge
  double cosine;
  std::array<bool, 2> isSharp{};  // whether the surface is, at the ends
};

// Of triangles below the least area, none.
std::vector<Vec3f> normalsOf(const CutTriangles& triangles, base::Job& job) {
  std::vector<Vec3f> normals;
  base::resizeLarge(normals, triangles.corners.size(), job);
  job.forRanges(normals.size(), [&](std::size_t begin, std::size_t end) {
    for (Index t = static_cast<Index>(begin); t < end; ++t) {
      const Vec3f a = triangles(t, 0);
      const Vec3f normal = cross(triangles(t, 1) - a, triangles(t, 2) - a);
      const float size = length(normal);
      normals[t] = size > 2 * kLeastArea ? normal * (1 / size) : Vec3f();
    }
  });
  return normals;
}

std::vector<Fold> foldsOf(const CutTriangles& triangles, base::Job& job) {
  const std::vector<Vec3f> normals = normalsOf(triangles, job);
  const auto cosineAt = [&](Index corner, Index across) {
    return dot(normals[corner / 3], normals[across / 3]);
  };
  std::vector<Fold> folds;
  for (const Index corner : base::collectIf(job, triangles.opposite.size(), [&](Index corner) {
         const Index across = triangles.opposite[corner];
         return across != reduce::kNone && across / 3 >= corner / 3 &&
                cosineAt(corner, across) < kFoldCosine;
       })) {
    const Index across = triangles.opposite[corner], t = corner / 3, other = across / 3;
    const auto i = static_cast<int>(corner % 3);
    folds.push_back({{t, other},
                     {Vec3(normals[t]), Vec3(normals[other])},
                     {triangles.vertex(t, (i + 1) % 3), triangles.vertex(t, (i + 2) % 3)},
                     static_cast<double>(cosineAt(corner, across))});
  }
  return folds;
}

// Whether the two faces of a fold lie on two sheets as sharp.
bool haveSheets(const Fold& fold, const uniform::MeetingSheets& sheets) {
  const double least = fold.cosine < kOver ? kOverSheets : kSharpSheets;
  for (int i = 0; i < sheets.count; ++i) {
    for (int j = 0; j < sheets.count; ++j) {
      const Vec3 a(sheets.normals[i]), b(sheets.normals[j]);
      if (a.dot(b) < least && a.dot(fold.normals[0]) > kSameSideCosine &&
          b.dot(fold.normals[1]) > kSameSideCosine) {
        return true;
      }
    }
  }
  return false;
}

// Looks at the uniform vertices that the ends of the edges stand for.
void findSharp(const octree::Cut& cut, const uniform::SurfaceView& base, std::vector<Fold>& folds) {
  struct End {
    VertexIndex vertex;
    std::size_t fold, end;
  };
  std::vector<End> ends;
  std::vector<std::uint8_t> isEnd(cut.clusters.size());
  for (std::size_t i = 0; i < folds.size(); ++i) {
    for (const std::size_t end : {0, 1}) {
      ends.push_back({folds[i].ends[end], i, end});
      isEnd[folds[i].ends[end]] = 1;
    }
  }
  std::sort(ends.begin(), ends.end(),
            [](const End& a, const End& b) { return a.vertex < b.vertex; });
  for (VertexIndex r = 0; r < cut.vertexOf.size(); ++r) {
    const VertexIndex vertex = cut.vertexOf[r];
    if (isEnd[vertex] == 0 || !base.sheets.isSharp(r)) continue;
    const uniform::MeetingSheets sheets = base.sheets.sheets(base.mesh, r);
    auto at = std::lower_bound(ends.begin(), ends.end(), vertex,
                               [](const End& a, VertexIndex v) { return a.vertex < v; });
    for (; at != ends.end() && at->vertex == vertex; ++at) {
      folds[at->fold].isSharp[at->end] |= haveSheets(folds[at->fold], sheets);
    }
  }
}

}  // namespace

std::vector<std::array<Index, 2>> findFolds(const CutTriangles& triangles, const octree::Cut& cut,
                                            const uniform::SurfaceView& base, base::Job& job) {
  std::vector<Fold> folds = foldsOf(triangles, job);
  if (!folds.empty()) findSharp(cut, base, folds);
  std::vector<std::array<Index, 2>> pairs;
  for (const Fold& fold : folds) {
    if (!fold.isSharp[0] || !fold.isSharp[1]) pairs.push_back(fold.triangles);
  }
  return pairs;
}

}  // namespace tufa::refine
