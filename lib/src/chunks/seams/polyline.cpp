#include "chunks/seams/polyline.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "chunks/seams/face_segments.h"
#include "uniform/case_table.h"

namespace tufa::chunks {
namespace {

constexpr std::size_t kLeastOfLoop = 3;
// A segment may be this many times longer than the limit, in arcs; where strips would be folded it
// is split down to the limit.
constexpr double kLongest = 4;
// How much the limit grows from arc to arc.
constexpr double kGrowth = 1;
// Share of the clearance that a polyline may use.
constexpr double kClearShare = 1.0 / 3;

// One curve while it becomes a polyline. Nodes are its points in order: the one on the chunk edge
// at its beginning, if any, the arcs, the one at its end. Chosen nodes are the vertices of the
// polyline; they are only ever added.
class Line {
 public:
  Line(const Seams& seams, const SeamCurve& curve, const grid::Affine& affine,
       const std::function<double(const Vec3&)>& budget)
      : seams_(seams), curve_(curve) {
    const auto add = [&](SeamIndex index) {
      const SeamVertex& vertex = seams.vertices[index];
      // Counted from the first arc's cell: the same bits in every region.
      const Vec3 at = Vec3(vertex.cell - seams.vertices[curve.arcs[0]].cell) + vertex.offset;
      points_.push_back(affine.axis(0) * at[0] + affine.axis(1) * at[1] + affine.axis(2) * at[2]);
      budget_.push_back(budget(Vec3(vertex.cell) + vertex.offset));
      indices_.push_back(index);
    };
    if (curve.begin != kNoSeam) add(curve.begin);
    firstArc_ = points_.size();
    for (const SeamIndex arc : curve.arcs) add(arc);
    if (curve.end != kNoSeam) add(curve.end);
    chosen_.assign(points_.size(), 0);
    keepClear();
    limitRuns();
    chooseFirst();
    refineAll();
    if (!curve.closed && chosenArcs() == 0) choose(firstArc_ + curve.arcs.size() / 2);
  }

  [[nodiscard]] const SeamCurve& curve() const { return curve_; }
  [[nodiscard]] std::size_t nodeCount() const { return points_.size(); }

  // Calls body(from, to) for each segment, by nodes. On a closed curve `to` may lie behind the last
  // node, once around.
  template <class Body>
  void forSegments(const Body& body) const {
    std::size_t first = points_.size(), last = points_.size();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (chosen_[i] == 0) continue;
      if (last < points_.size()) body(last, i);
      if (first == points_.size()) first = i;
      last = i;
    }
    if (curve_.closed) body(last, first + points_.size());
  }
  [[nodiscard]] SeamIndex seamAt(std::size_t node) const { return indices_[node % points_.size()]; }

  // Splits a segment at its farthest node. Returns whether there is one between its ends.
  bool split(std::size_t from, std::size_t to) {
    if (to - from < 2) return false;
    choose(farthest(from, to).first);
    return true;
  }

  // Splits a segment that is longer than its limit.
  bool splitLong(std::size_t from, std::size_t to) {
    return isLonger(from, to, 1) && split(from, to);
  }

  // Sets the vertex that stands for each arc: an arc between two vertices belongs to the nearer one
  // by number of arcs, or to the one in its quadrant.
  void assign(SeamPolylines& lines) const {
    const std::size_t count = points_.size();
    std::vector<std::size_t> nodes;
    for (std::size_t i = firstArc_; i < firstArc_ + curve_.arcs.size(); ++i) {
      if (chosen_[i] != 0) nodes.push_back(i);
    }
    for (std::size_t i = firstArc_; i < nodes.front(); ++i) {
      if (!curve_.closed) lines[indices_[i]] = indices_[nodes.front()];
    }
    const auto assignBetween = [&](std::size_t from, std::size_t to) {
      lines[indices_[from]] = indices_[from];
      const std::size_t end = runEnd(from, to);
      for (std::size_t i = from + 1; i < to; ++i) {
        lines[indices_[i % count]] = indices_[(i < end ? from : to) % count];
      }
    };
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) assignBetween(nodes[i], nodes[i + 1]);
    lines[indices_[nodes.back()]] = indices_[nodes.back()];
    if (curve_.closed) {
      assignBetween(nodes.back(), nodes.front() + count);
    } else {
      for (std::size_t i = nodes.back(); i < firstArc_ + curve_.arcs.size(); ++i) {
        lines[indices_[i]] = indices_[nodes.back()];
      }
    }
  }

 private:
  // Keeps the two surfaces of a thin wall or gap apart.
  void keepClear() {
    for (std::size_t i = 0; i < curve_.arcs.size(); ++i) {
      const double clearance = static_cast<double>(seams_.arcs[curve_.arcs[i]].clearance);
      double& budget = budget_[firstArc_ + i];
      budget = std::min(budget, kClearShare * clearance);
    }
  }

  // Limits the length of segments, in arcs. Clusters are small where the surface is not flat, on
  // the face or beside it; strips between small clusters and long segments fold. Away from such
  // places the limit grows with the distance.
  void limitRuns() {
    const std::size_t count = points_.size();
    limits_.assign(count, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < curve_.arcs.size(); ++i) {
      const std::size_t node = firstArc_ + i;
      const auto& flatness = seams_.arcs[curve_.arcs[i]].flatness;
      for (std::size_t k = flatness.size(); k-- > 0;) {
        if (static_cast<double>(flatness[k]) > budget_[node]) {
          limits_[node] = static_cast<double>(std::size_t{1} << k);
        }
      }
    }
    const std::size_t steps = curve_.closed ? 2 * count : count;
    for (std::size_t i = 1; i < steps; ++i) {
      double& limit = limits_[i % count];
      limit = std::min(limit, limits_[(i - 1) % count] + kGrowth);
    }
    for (std::size_t i = steps; i-- > 1;) {
      double& limit = limits_[(i - 1) % count];
      limit = std::min(limit, limits_[i % count] + kGrowth);
    }
  }

  // Chooses the nodes that are needed at any tolerance.
  void chooseFirst() {
    if (curve_.begin != kNoSeam) choose(0);
    if (curve_.end != kNoSeam) choose(points_.size() - 1);
    for (std::size_t i = 0; i < curve_.arcs.size(); ++i) {
      if (!seams_.arcs[curve_.arcs[i]].single) choose(firstArc_ + i);
    }
    if (curve_.closed) {
      chooseInQuadrants();
      while (chosenArcs() < std::min(kLeastOfLoop, curve_.arcs.size())) choose(mostRemote());
      return;
    }
    // The curve ends where the data ends.
    if (curve_.begin == kNoSeam) choose(firstArc_);
    if (curve_.end == kNoSeam) choose(firstArc_ + curve_.arcs.size() - 1);
  }

  // Chooses a node in each stretch of a closed curve in one quadrant. Then runs lie in one
  // quadrant, as clusters do, and a run and a cluster have at most one stretch in common.
  void chooseInQuadrants() {
    const std::size_t count = points_.size();
    quadrants_ = quadrantsOf(seams_, curve_);
    if (quadrants_.empty()) return;
    std::size_t start = 0;
    while (start < count && quadrants_[start] == quadrants_[(start + count - 1) % count]) ++start;
    for (std::size_t i = start; i < start + count;) {
      std::size_t end = i + 1;
      bool any = chosen_[i % count] != 0;
      while (end < start + count && quadrants_[end % count] == quadrants_[i % count]) {
        any |= chosen_[end++ % count] != 0;
      }
      if (!any) choose((i + (end - i) / 2) % count);
      i = end;
    }
  }

  // The node farthest from all chosen ones; the first of several.
  [[nodiscard]] std::size_t mostRemote() const {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (chosen_[i] != 0) continue;
      double nearest = std::numeric_limits<double>::max();
      for (std::size_t j = 0; j < points_.size(); ++j) {
        if (chosen_[j] != 0) nearest = std::min(nearest, (points_[i] - points_[j]).squaredLength());
      }
      if (nearest <= most) continue;
      most = nearest;
      best = i;
    }
    return best;
  }

  // Splits segments at their farthest node (Douglas and Peucker 1973) while that is beyond its
  // budget, and too long ones in the middle.
  void refineAll() {
    std::vector<std::pair<std::size_t, std::size_t>> open;
    forSegments([&](std::size_t from, std::size_t to) { open.emplace_back(from, to); });
    while (!open.empty()) {
      const auto [from, to] = open.back();
      open.pop_back();
      if (to - from < 2) continue;
      auto [node, ratio] = farthest(from, to);
      if (!(ratio > 1)) {
        if (!isLonger(from, to, kLongest)) continue;
        node = from + (to - from) / 2;
      }
      choose(node);
      open.emplace_back(from, node);
      open.emplace_back(node, to);
    }
  }

  // Whether a segment is more than `times` as long as the least limit on it.
  [[nodiscard]] bool isLonger(std::size_t from, std::size_t to, double times) const {
    double limit = limits_[from % points_.size()];
    for (std::size_t i = from; i <= to; ++i) limit = std::min(limit, limits_[i % points_.size()]);
    return static_cast<double>(to - from) > times * limit;
  }

  // The node between two that exceeds its budget most, by its distance to the segment, and the
  // ratio of both.
  [[nodiscard]] std::pair<std::size_t, double> farthest(std::size_t from, std::size_t to) const {
    const std::size_t count = points_.size();
    const Vec3& a = points_[from % count];
    const Vec3 way = points_[to % count] - a;
    const double squared = way.squaredLength();
    std::pair<std::size_t, double> best{from + (to - from) / 2, -1};
    for (std::size_t i = from + 1; i < to; ++i) {
      const Vec3 off = points_[i % count] - a;
      const double along = squared > 0 ? std::clamp(off.dot(way) / squared, 0.0, 1.0) : 0;
      const double distance = (off - way * along).length();
      const double budget = budget_[i % count];
      const double ratio =
          budget > 0 ? distance / budget : (distance > 0 ? std::numeric_limits<double>::max() : 0);
      if (ratio > best.second) best = {i, ratio};
    }
    return best;
  }

  // The first node between two chosen ones that the second stands for.
  [[nodiscard]] std::size_t runEnd(std::size_t from, std::size_t to) const {
    const std::size_t count = points_.size();
    if (!quadrants_.empty()) {
      for (std::size_t i = from + 1; i <= to; ++i) {
        if (quadrants_[i % count] != quadrants_[(i - 1) % count]) return i;
      }
    }
    return from + (to - from) / 2 + 1;
  }

  void choose(std::size_t node) { chosen_[node % points_.size()] = 1; }
  [[nodiscard]] std::size_t chosenArcs() const {
    const auto first = chosen_.begin() + static_cast<std::ptrdiff_t>(firstArc_);
    return static_cast<std::size_t>(
        std::count(first, first + static_cast<std::ptrdiff_t>(curve_.arcs.size()), 1));
  }

  const Seams& seams_;
  const SeamCurve& curve_;
  std::vector<Vec3> points_;        // world lengths, from the curve's first arc
  std::vector<double> budget_;      // world units
  std::vector<double> limits_;      // of the length of segments, in arcs
  std::vector<SeamIndex> indices_;  // of the nodes
  std::size_t firstArc_ = 0;        // node of the first arc
  std::vector<std::uint8_t> chosen_;
  std::vector<std::uint8_t> quadrants_;  // of the nodes of a loop
};

// The polylines of one face. They are refined until none cross and validation finds no fault.
class Face {
 public:
  explicit Face(const Seams& seams, std::vector<Line>& lines, std::size_t begin, std::size_t end)
      : seams_(seams), lines_(lines), begin_(begin), end_(end) {}

  // Ends, as each round chooses nodes, and there are finitely many.
  void makeSound(const PolylineValidation& validation, SeamPolylines& result) {
    const FaceValidation onFace = validation ? validation(begin_, end_) : nullptr;
    for (bool any = true; any;) {
      uncross();
      for (std::size_t line = begin_; line < end_; ++line) lines_[line].assign(result);
      any = onFace && splitAt(onFace(result));
    }
  }

 private:
  // Splits the segments at faults. Intersections cannot be repaired by splitting cells; folds are
  // better left to that than to very short segments.
  bool splitAt(const LineFaults& faults) {
    if (faults.meeting.empty() && faults.folded.empty()) return false;
    collect();
    bool any = false;
    for (const FaceSegment& segment : segments_) {
      Line& line = lines_[segment.line];
      const auto isIn = [&](const std::vector<SeamIndex>& vertices) {
        const auto has = [&](std::size_t node) {
          return std::binary_search(vertices.begin(), vertices.end(), line.seamAt(node));
        };
        return has(segment.from) || has(segment.to);
      };
      if (isIn(faults.meeting)) {
        any |= line.split(segment.from, segment.to);
      } else if (isIn(faults.folded)) {
        any |= line.splitLong(segment.from, segment.to);
      }
    }
    return any;
  }

  void uncross() {
    while (true) {
      collect();
      std::vector<std::size_t> crossed;
      forCrossings(segments_, [&](std::size_t i, std::size_t j) {
        crossed.push_back(i);
        crossed.push_back(j);
      });
      std::sort(crossed.begin(), crossed.end());
      crossed.erase(std::unique(crossed.begin(), crossed.end()), crossed.end());
      bool any = false;
      for (const std::size_t i : crossed) {
        const FaceSegment& segment = segments_[i];
        any |= lines_[segment.line].split(segment.from, segment.to);
      }
      if (!any) return;
    }
  }

  void collect() {
    segments_.clear();
    const auto axes = uniform::otherAxes(lines_[begin_].curve().axis);
    const Coord corner = seams_.vertices[lines_[begin_].seamAt(0)].cell;
    const auto place = [&](SeamIndex index) -> std::array<double, 2> {
      const SeamVertex& vertex = seams_.vertices[index];
      const Vec3 at = Vec3(vertex.cell - corner) + vertex.offset;
      return {at[axes[0]], at[axes[1]]};
    };
    for (std::size_t line = begin_; line < end_; ++line) {
      lines_[line].forSegments([&](std::size_t from, std::size_t to) {
        segments_.push_back(
            {line, from, to, place(lines_[line].seamAt(from)), place(lines_[line].seamAt(to))});
      });
    }
  }

  const Seams& seams_;
  std::vector<Line>& lines_;
  std::size_t begin_, end_;
  std::vector<FaceSegment> segments_;
};

}  // namespace

std::vector<std::uint8_t> quadrantsOf(const Seams& seams, const SeamCurve& curve) {
  const auto [u, v] = uniform::otherAxes(curve.axis);
  const auto cell = [&](std::size_t i) -> const Coord& {
    return seams.vertices[curve.arcs[i]].cell;
  };
  unsigned differs = 0;
  for (std::size_t i = 1; i < curve.arcs.size(); ++i) {
    differs |= static_cast<unsigned>(cell(i)[u] ^ cell(0)[u]) |
               static_cast<unsigned>(cell(i)[v] ^ cell(0)[v]);
  }
  std::vector<std::uint8_t> quadrants;
  if (differs == 0) return quadrants;
  const int bit = std::bit_width(differs) - 1;
  for (std::size_t i = 0; i < curve.arcs.size(); ++i) {
    quadrants.push_back(
        static_cast<std::uint8_t>(((cell(i)[u] >> bit) & 1) * 2 + ((cell(i)[v] >> bit) & 1)));
  }
  return quadrants;
}

SeamPolylines simplifySeams(const Seams& seams, const grid::Affine& affine,
                            const std::function<double(const Vec3&)>& budget,
                            const PolylineValidation& validation) {
  SeamPolylines result(seams.vertices.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = static_cast<SeamIndex>(i);
  std::vector<Line> lines;
  lines.reserve(seams.curves.size());
  for (const SeamCurve& curve : seams.curves) lines.emplace_back(seams, curve, affine, budget);
  forFaces(seams.curves, [&](std::size_t begin, std::size_t end) {
    Face(seams, lines, begin, end).makeSound(validation, result);
  });
  return result;
}

}  // namespace tufa::chunks
