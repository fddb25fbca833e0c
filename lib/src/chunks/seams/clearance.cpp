#include "chunks/seams/clearance.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "uniform/case_table.h"

namespace tufa::chunks {
namespace {

// Arcs are searched in the same square of so many cells (log2) and in those around it.
constexpr int kSquareLevel = 3;

// The arcs of one face by squares of cells.
class FaceArcs {
 public:
  FaceArcs(const Seams& seams, std::span<const SeamCurve> curves, const grid::Affine& affine)
      : seams_(seams), affine_(affine), axes_(uniform::otherAxes(curves.front().axis)) {
    for (const SeamCurve& curve : curves) {
      for (const SeamIndex arc : curve.arcs) places_.push_back({squareOf(arc), arc});
    }
    std::sort(places_.begin(), places_.end());
  }

  // The distance from an arc to the nearest one that faces the other way.
  [[nodiscard]] float clearanceOf(SeamIndex arc) const {
    const Square square = squareOf(arc);
    const Vec3 own = normalOf(arc);
    double least = std::numeric_limits<double>::infinity();
    for (int u = -1; u <= 1; ++u) {
      const Square first{square[0] + u, square[1] - 1};
      auto place = std::lower_bound(places_.begin(), places_.end(), Place{first, 0});
      for (; place != places_.end() && place->first <= Square{first[0], square[1] + 1}; ++place) {
        if (normalOf(place->second).dot(own) < 0) {
          least = std::min(least, squaredDistance(arc, place->second));
        }
      }
    }
    return static_cast<float>(std::sqrt(least));
  }

 private:
  using Square = std::array<int, 2>;
  using Place = std::pair<Square, SeamIndex>;

  [[nodiscard]] Square squareOf(SeamIndex arc) const {
    const Coord& cell = seams_.vertices[arc].cell;
    return {cell[axes_[0]] >> kSquareLevel, cell[axes_[1]] >> kSquareLevel};
  }
  [[nodiscard]] Vec3 normalOf(SeamIndex arc) const {
    const Normal& n = seams_.vertices[arc].normal;
    return {n.x, n.y, n.z};
  }
  [[nodiscard]] double squaredDistance(SeamIndex a, SeamIndex b) const {
    const SeamVertex &v = seams_.vertices[a], &w = seams_.vertices[b];
    const Vec3 way = Vec3(w.cell - v.cell) + (w.offset - v.offset);
    return (affine_.axis(0) * way[0] + affine_.axis(1) * way[1] + affine_.axis(2) * way[2])
        .squaredLength();
  }

  const Seams& seams_;
  const grid::Affine& affine_;
  std::array<int, 2> axes_;
  std::vector<Place> places_;
};

}  // namespace

void measureClearance(const grid::Affine& affine, Seams& seams) {
  forFaces(seams.curves, [&](std::size_t begin, std::size_t end) {
    const std::span curves(seams.curves.data() + begin, end - begin);
    const FaceArcs arcs(seams, curves, affine);
    for (const SeamCurve& curve : curves) {
      for (const SeamIndex arc : curve.arcs) seams.arcs[arc].clearance = arcs.clearanceOf(arc);
    }
  });
}

}  // namespace tufa::chunks
