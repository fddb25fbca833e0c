#include "chunks/seams/seams.h"

#include <tufa/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/single_precision.h"
#include "chunks/seams/clearance.h"
#include "chunks/seams/flatness.h"
#include "chunks/seams/seam_crossings.h"
#include "chunks/seams/untangle.h"

namespace tufa::chunks {
namespace {

// Seams' vertices keep this far from the ends of their lattice edge or the border of their cell
// face, in voxels.
constexpr double kMargin = 1e-3;
// A corner of a curve gets a vertex if it is farther off than this, in voxels.
constexpr double kCorner = 0.02;
// Vertices nearer to each other than this, in voxels, may become one by rounding.
constexpr double kClose = 4e-3;
constexpr std::size_t kGrain = 4096;

// The axis along which two neighbouring chunks differ.
int axisBetween(const Coord& a, const Coord& b) { return a[0] != b[0] ? 0 : a[1] != b[1] ? 1 : 2; }

class SeamFinder {
 public:
  SeamFinder(const Mesh& base, const Mesh& before, const std::vector<Coord>& cells,
             const ChunkCells& chunks, const grid::Affine& affine)
      : base_(base), before_(before), cells_(cells), chunks_(chunks), affine_(affine) {}

  // Uniform quads with vertices in several chunks, at least one of them to be made.
  std::vector<std::uint32_t> findParted(base::Job& job) {
    std::vector<std::uint8_t> parted(base_.quads.size());
    job.forRanges(parted.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) parted[i] = isParted(base_.quads[i]) ? 1 : 0;
    });
    for (std::size_t i = 0; i < parted.size(); ++i) {
      if (parted[i] != 0) quads_.push_back(static_cast<std::uint32_t>(i));
    }
    return quads_;
  }

  Seams find(const std::vector<SeamCrossing>& crossings, base::Job& job) {
    collectArcs();
    placeArcs(crossings);
    placeEdgePoints(crossings);
    linkArcs(crossings);
    insertCorners();
    traceCurves();
    untangle(fallbacksOf(crossings), seams_);
    measureFlatness(base_, before_, affine_, seams_);
    measureClearance(affine_, seams_);
    makeMesh(job);
    return std::move(seams_);
  }

 private:
  // An arc as an edge of a quad, between two of its corners.
  struct Use {
    VertexIndex below, above;
    std::uint32_t quad;  // in quads_
    int corner;          // the first of the two
    auto key() const { return std::tie(below, above); }
  };
  // The neighbours of an arc on its curve, as the lower chunk orders them.
  struct Links {
    SeamIndex previous = kNoSeam, next = kNoSeam;  // arcs
    SeamIndex begin = kNoSeam, end = kNoSeam;      // points on chunk edges
  };

  [[nodiscard]] Coord chunkOf(VertexIndex vertex) const { return chunks_.chunkOf(cells_[vertex]); }
  [[nodiscard]] bool isOwn(VertexIndex vertex) const {
    return chunks_.own.contains(chunkOf(vertex));
  }

  [[nodiscard]] bool isParted(const Quad& quad) const {
    const Coord first = chunkOf(quad.vertices[0]);
    bool same = true, own = false;
    for (const VertexIndex vertex : quad.vertices) {
      same &= chunkOf(vertex) == first;
      own |= isOwn(vertex);
    }
    return !same && own;
  }

  void collectArcs() {
    std::vector<Use> uses;
    for (std::uint32_t i = 0; i < quads_.size(); ++i) {
      const auto& v = base_.quads[quads_[i]].vertices;
      for (int c = 0; c < 4; ++c) {
        const VertexIndex a = v[c], b = v[(c + 1) % 4];
        const Coord chunkA = chunkOf(a), chunkB = chunkOf(b);
        if (chunkA == chunkB || !(isOwn(a) || isOwn(b))) continue;
        const bool rises = chunkA < chunkB;
        uses.push_back({rises ? a : b, rises ? b : a, i, c});
      }
    }
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
      return std::tuple(a.below, a.above, a.quad) < std::tuple(b.below, b.above, b.quad);
    });
    arcAt_.assign(quads_.size(), {kNoSeam, kNoSeam, kNoSeam, kNoSeam});
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const bool fresh = i == 0 || uses[i].key() != uses[i - 1].key();
      if (fresh) {
        seams_.arcs.push_back({uses[i].below, uses[i].above, quads_[uses[i].quad], true});
        quadsOf_.push_back({uses[i].quad, uses[i].quad});
      }
      quadsOf_.back()[1] = uses[i].quad;
      arcAt_[uses[i].quad][uses[i].corner] = static_cast<SeamIndex>(seams_.arcs.size() - 1);
    }
  }

  // A uniform vertex as it was before the repair, in lattice steps from a lattice point.
  [[nodiscard]] Vec3 latticePoint(VertexIndex vertex, const Coord& from) const {
    return affine_.latticePoint(before_.positions[vertex], from);
  }

  // Places the vertex of each arc where the line between its two uniform vertices passes the face.
  void placeArcs(const std::vector<SeamCrossing>& crossings) {
    seams_.vertices.resize(seams_.arcs.size());
    std::vector<std::tuple<Coord, int, SeamIndex>> faces;
    for (SeamIndex i = 0; i < seams_.arcs.size(); ++i) {
      const Arc& arc = seams_.arcs[i];
      const Coord& cell = cells_[arc.above];
      const int axis = axisOf(i);
      // In the order of the lattice, which is the same for every chunk.
      const SeamCrossing& first = crossings[quadsOf_[i][0]];
      const SeamCrossing& second = crossings[quadsOf_[i][1]];
      SeamVertex& vertex = seams_.vertices[i];
      vertex.cell = cell;
      vertex.offset = passFace(arc, axis);
      const bool swapped =
          std::tuple(second.start, second.axis) < std::tuple(first.start, first.axis);
      vertex.normal = swapped ? meanNormal(second, first) : meanNormal(first, second);
      faces.emplace_back(cell, axis, i);
    }
    partClose(crossings);
    std::sort(faces.begin(), faces.end());
    for (std::size_t i = 1; i < faces.size(); ++i) {
      const auto& [cell, axis, arc] = faces[i];
      const auto& [cellBefore, axisBefore, arcBefore] = faces[i - 1];
      if (cell != cellBefore || axis != axisBefore) continue;
      seams_.arcs[arc].single = seams_.arcs[arcBefore].single = false;
    }
  }

  // Moves vertices at the same place to the middles of their own stretches of curve.
  void partClose(const std::vector<SeamCrossing>& crossings) {
    const auto place = [&](SeamIndex i) {
      return Vec3(seams_.vertices[i].cell) + seams_.vertices[i].offset;
    };
    std::vector<SeamIndex> order(seams_.arcs.size());
    std::iota(order.begin(), order.end(), SeamIndex{0});
    std::sort(order.begin(), order.end(), [&](SeamIndex a, SeamIndex b) {
      return std::pair(place(a)[0], a) < std::pair(place(b)[0], b);
    });
    std::vector<SeamIndex> close;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Vec3 at = place(order[i]);
      for (std::size_t k = i + 1; k < order.size(); ++k) {
        const Vec3 way = place(order[k]) - at;
        if (way[0] > kClose) break;
        if (way.squaredLength() < kClose * kClose) close.insert(close.end(), {order[i], order[k]});
      }
    }
    for (const SeamIndex arc : close) seams_.vertices[arc].offset = middleOf(arc, crossings);
  }

  // The middle of an arc's own stretch of curve, between two crossings, counted from its cell.
  [[nodiscard]] Vec3 middleOf(SeamIndex arc, const std::vector<SeamCrossing>& crossings) const {
    const Coord& cell = seams_.vertices[arc].cell;
    const auto [a, b] = quadsOf_[arc];
    return (placeFrom(cell, crossings[a]) + placeFrom(cell, crossings[b])) * 0.5;
  }
  static Vec3 placeFrom(const Coord& cell, const SeamCrossing& crossing) {
    Vec3 at = Vec3(crossing.start - cell);
    at[crossing.axis] += crossing.along;
    return at;
  }

  // The fallback position of the vertex of each arc, if curves cross: the middle of its stretch;
  // for a corner, the crossing between two stretches.
  [[nodiscard]] std::vector<Vec3> fallbacksOf(const std::vector<SeamCrossing>& crossings) const {
    std::vector<Vec3> fallbacks(seams_.arcs.size());
    for (SeamIndex i = 0; i < fallbacks.size(); ++i) {
      if (i < quadsOf_.size()) {
        fallbacks[i] = middleOf(i, crossings);
        continue;
      }
      const auto quad = std::lower_bound(quads_.begin(), quads_.end(), seams_.arcs[i].quad);
      fallbacks[i] = placeFrom(seams_.vertices[i].cell, crossings[quad - quads_.begin()]);
    }
    return fallbacks;
  }

  [[nodiscard]] Normal meanNormal(const SeamCrossing& a, const SeamCrossing& b) const {
    const auto add = [](float s, float t) { return s + t; };
    const uniform::Vector sum = {add(a.normal[0], b.normal[0]), add(a.normal[1], b.normal[1]),
                                 add(a.normal[2], b.normal[2])};
    const uniform::Vector& n = uniform::dot(sum, sum) > 1e-6F ? sum : a.normal;
    return affine_.normal(n[0], n[1], n[2]);
  }

  // Whether the four corners of a quad lie in four chunks.
  [[nodiscard]] bool isAtEdge(std::uint32_t i) const {
    const auto& v = base_.quads[quads_[i]].vertices;
    return chunkOf(v[0]) != chunkOf(v[1]) && chunkOf(v[1]) != chunkOf(v[2]);
  }

  // Where a lattice edge passes the quad around it, or the crossing of the field if it does not
  // pass it.
  [[nodiscard]] double alongEdge(std::uint32_t quad, const SeamCrossing& crossing) const {
    const auto& v = before_.quads[quad].vertices;
    const auto [s, t] = uniform::otherAxes(crossing.axis);
    std::array<Vec3, 4> p;
    for (int i = 0; i < 4; ++i) p[i] = latticePoint(v[i], crossing.start);
    for (int i = 1; i <= 2; ++i) {
      const Vec3 &a = p[0], &b = p[i], &c = p[i + 1];
      const auto cross = [s = s, t = t](const Vec3& x, const Vec3& y) {
        return x[s] * y[t] - x[t] * y[s];
      };
      // Seen along the edge, which is the point 0: its barycentric coordinates.
      const double wa = cross(b, c), wb = cross(c, a), wc = cross(a, b);
      const double sum = wa + wb + wc;
      if (sum == 0 || wa * sum < 0 || wb * sum < 0 || wc * sum < 0) continue;
      const double along =
          (wa * a[crossing.axis] + wb * b[crossing.axis] + wc * c[crossing.axis]) / sum;
      if (along >= kMargin && along <= 1 - kMargin) return along;
    }
    return crossing.along;
  }

  void placeEdgePoints(const std::vector<SeamCrossing>& crossings) {
    edgePointOf_.assign(quads_.size(), kNoSeam);
    for (std::uint32_t i = 0; i < quads_.size(); ++i) {
      if (!isAtEdge(i)) continue;
      edgePointOf_[i] = static_cast<SeamIndex>(seams_.vertices.size());
      const SeamCrossing& crossing = crossings[i];
      Vec3 offset(0);
      offset[crossing.axis] = alongEdge(quads_[i], crossing);
      const auto& n = crossing.normal;
      seams_.vertices.push_back({crossing.start, offset, affine_.normal(n[0], n[1], n[2])});
    }
  }

  // Links the arcs: a quad in two chunks leads from one arc to the next, one in four chunks begins
  // and ends four of them.
  void linkArcs(const std::vector<SeamCrossing>& crossings) {
    links_.resize(seams_.arcs.size());
    for (std::uint32_t i = 0; i < quads_.size(); ++i) {
      const auto& v = base_.quads[quads_[i]].vertices;
      const bool atEdge = edgePointOf_[i] != kNoSeam;
      for (int c = 0; c < 4; ++c) {
        const SeamIndex arc = arcAt_[i][c];
        if (arc == kNoSeam) continue;
        // Seen from the chunk of corner c the arc is behind its vertices, seen from the other it is
        // before them.
        const bool behind = seams_.arcs[arc].below == v[c];
        if (atEdge) {
          (behind ? links_[arc].begin : links_[arc].end) = edgePointOf_[i];
        } else if (!behind) {
          const SeamIndex next = arcAt_[i][(c + 2) % 4];
          const SeamIndex corner = addCorner(i, arc, next, crossings[i]);
          link(arc, corner);
          link(corner == kNoSeam ? arc : corner, next);
        }
      }
    }
  }

  void link(SeamIndex from, SeamIndex to) {
    if (from == kNoSeam || to == kNoSeam) return;
    links_[from].next = to;
    links_[to].previous = from;
  }

  // Adds a corner where the diagonal of a quad passes the face, unless that is on the way from arc
  // to arc.
  SeamIndex addCorner(std::uint32_t i, SeamIndex from, SeamIndex to, const SeamCrossing& crossing) {
    if (from == kNoSeam || to == kNoSeam) return kNoSeam;
    const int axis = axisOf(from);
    const auto& v = before_.quads[quads_[i]].vertices;
    const bool rises = chunkOf(v[0])[axis] < chunkOf(v[2])[axis];
    const Arc arc{rises ? v[0] : v[2], rises ? v[2] : v[0], quads_[i], true};
    const SeamVertex vertex{
        cells_[arc.above], passFace(arc, axis),
        affine_.normal(crossing.normal[0], crossing.normal[1], crossing.normal[2])};
    const auto place = [&](const SeamVertex& other) {
      return Vec3(other.cell - vertex.cell) + other.offset;
    };
    const Vec3 a = place(seams_.vertices[from]), b = place(seams_.vertices[to]);
    const Vec3 way = b - a, off = vertex.offset - a;
    const double squared = way.squaredLength();
    const double along = squared > 0 ? std::clamp(off.dot(way) / squared, 0.0, 1.0) : 0;
    if ((off - way * along).squaredLength() < kCorner * kCorner) return kNoSeam;
    corners_.push_back({arc, vertex});
    links_.emplace_back();
    return static_cast<SeamIndex>(links_.size() - 1);
  }

  // Inserts the corners behind the arcs and before the points on chunk edges.
  void insertCorners() {
    const auto count = static_cast<SeamIndex>(corners_.size());
    const auto first = static_cast<SeamIndex>(seams_.arcs.size());
    std::vector<SeamVertex> vertices;
    for (const auto& [arc, vertex] : corners_) {
      seams_.arcs.push_back(arc);
      vertices.push_back(vertex);
    }
    seams_.vertices.insert(seams_.vertices.begin() + first, vertices.begin(), vertices.end());
    for (Links& links : links_) {
      for (SeamIndex* point : {&links.begin, &links.end}) {
        if (*point != kNoSeam) *point += count;
      }
    }
    for (SeamIndex& point : edgePointOf_) {
      if (point != kNoSeam) point += count;
    }
  }

  // The axis across the face of an arc, along which its two chunks differ.
  [[nodiscard]] int axisOf(SeamIndex arc) const {
    return axisBetween(chunkOf(seams_.arcs[arc].below), chunkOf(seams_.arcs[arc].above));
  }

  // Where the line between the vertices of an arc passes the face, counted from the upper one's
  // cell.
  [[nodiscard]] Vec3 passFace(const Arc& arc, int axis) const {
    const Coord& cell = cells_[arc.above];
    const Vec3 below = latticePoint(arc.below, cell), above = latticePoint(arc.above, cell);
    Vec3 at = below - (above - below) * (below[axis] / (above[axis] - below[axis]));
    at[axis] = 0;
    return at;
  }

  // Open curves first, from their beginnings, then closed ones, from their least arc; sorted by
  // place.
  void traceCurves() {
    std::vector<std::uint8_t> seen(seams_.arcs.size(), 0);
    const auto trace = [&](SeamIndex first) {
      SeamCurve curve;
      const Arc& arc = seams_.arcs[first];
      curve.axis = axisOf(first);
      curve.chunk = chunkOf(arc.above);
      SeamIndex at = first;
      do {
        curve.arcs.push_back(at);
        seen[at] = 1;
        at = links_[at].next;
      } while (at != kNoSeam && seen[at] == 0);
      curve.closed = at == first && curve.arcs.size() > 1;
      curve.begin = links_[first].begin;
      curve.end = links_[curve.arcs.back()].end;
      if (curve.closed) {
        const auto least =
            std::min_element(curve.arcs.begin(), curve.arcs.end(),
                             [&](SeamIndex a, SeamIndex b) { return placeOf(a) < placeOf(b); });
        std::rotate(curve.arcs.begin(), least, curve.arcs.end());
      }
      seams_.curves.push_back(std::move(curve));
    };
    for (SeamIndex arc = 0; arc < seams_.arcs.size(); ++arc) {
      if (links_[arc].previous == kNoSeam) trace(arc);
    }
    for (SeamIndex arc = 0; arc < seams_.arcs.size(); ++arc) {
      if (seen[arc] == 0) trace(arc);
    }
    std::sort(seams_.curves.begin(), seams_.curves.end(),
              [&](const SeamCurve& a, const SeamCurve& b) {
                return std::tuple(a.axis, a.chunk, placeOf(a.arcs.front())) <
                       std::tuple(b.axis, b.chunk, placeOf(b.arcs.front()));
              });
  }

  [[nodiscard]] std::tuple<Coord, double, double, double> placeOf(SeamIndex arc) const {
    const SeamVertex& vertex = seams_.vertices[arc];
    return {vertex.cell, vertex.offset[0], vertex.offset[1], vertex.offset[2]};
  }

  void makeMesh(base::Job& job) {
    Mesh& mesh = seams_.mesh;
    mesh = base_;
    for (const SeamVertex& vertex : seams_.vertices) {
      mesh.positions.push_back(
          affine_.position(vertex.cell, vertex.offset[0], vertex.offset[1], vertex.offset[2]));
      mesh.normals.push_back(vertex.normal);
    }
    seams_.quads = base_.quads;
    for (const std::uint32_t i : quads_) {
      for (const VertexIndex vertex : seams_.quads[i].vertices) {
        if (isOwn(vertex)) seams_.beside.push_back(vertex);
      }
    }
    job.forRanges(seams_.quads.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        auto& v = seams_.quads[i].vertices;
        const Coord chunk = chunkOf(v[0]);
        const bool whole =
            chunks_.own.contains(chunk) && std::all_of(v.begin(), v.end(), [&](VertexIndex vertex) {
              return chunkOf(vertex) == chunk;
            });
        if (!whole) v.fill(v[0]);
      }
    });
    std::sort(seams_.beside.begin(), seams_.beside.end());
    seams_.beside.erase(std::unique(seams_.beside.begin(), seams_.beside.end()),
                        seams_.beside.end());
  }

  const Mesh& base_;
  const Mesh& before_;
  const std::vector<Coord>& cells_;
  const ChunkCells& chunks_;
  const grid::Affine& affine_;
  std::vector<std::uint32_t> quads_;  // uniform quads in several chunks, sorted
  Seams seams_;
  std::vector<std::array<SeamIndex, 4>> arcAt_;  // of each of quads_: between corners c, c + 1
  std::vector<std::array<std::uint32_t, 2>> quadsOf_;  // of each arc: its quads, in quads_
  std::vector<SeamIndex> edgePointOf_;                 // of each of quads_
  std::vector<Links> links_;
  std::vector<std::pair<Arc, SeamVertex>> corners_;
};

}  // namespace

Seams findSeams(const uniform::SurfaceView& context, const Mesh& base, const Mesh& before,
                const std::vector<Coord>& vertexCells, const ChunkCells& chunks, base::Job& job) {
  SeamFinder finder(base, before, vertexCells, chunks, context.affine);
  const std::vector<std::uint32_t> parted = finder.findParted(job);
  return finder.find(seamCrossings(context, parted, job), job);
}

std::vector<Position> worldPositions(const Seams& seams, const grid::Transform& transform,
                                     bool singlePrecision) {
  std::vector<Position> positions;
  positions.reserve(seams.vertices.size());
  for (const SeamVertex& vertex : seams.vertices) {
    const Vec3 world = transform.indexToWorld(Vec3(vertex.cell) + vertex.offset);
    const Position place(world[0], world[1], world[2]);
    positions.push_back(singlePrecision ? base::toSingle(place) : place);
  }
  return positions;
}

}  // namespace tufa::chunks
