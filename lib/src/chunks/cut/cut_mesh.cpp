#include "chunks/cut/cut_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "base/collect.h"
#include "base/huge_pages.h"
#include "base/shrink.h"
#include "base/single_precision.h"
#include "base/triangulate.h"
#include "base/vec3.h"
#include "chunks/cut/chunk_planes.h"
#include "chunks/cut/flip_caps.h"
#include "chunks/cut/join_vertices.h"
#include "chunks/cut/move_to_planes.h"
#include "chunks/cut/name_planes.h"
#include "chunks/cut/pairs_at.h"
#include "intersect/surface.h"
#include "uniform/uniform_surface.h"

namespace tufa::chunks {
namespace {

// Voxels; shorter edges are collapsed once they are cut. Slivers are cut in places that single
// precision does not tell apart.
constexpr double kLeastEdge = 1e-3;
// Where triangles intersect once they are rounded, edges shorter than these, one after the other.
constexpr double kRoundedEdges[] = {2e-3, 4e-3, 8e-3};
// Voxels; lower caps are flipped.
constexpr double kLeastHeight = 1e-4;

class Cutter {
 public:
  Cutter(Mesh uniform, const grid::Affine& affine, int size, bool singlePrecision,
         double flatDistance, base::Job& job)
      : size_(static_cast<std::size_t>(size)),
        uniform_(std::move(uniform.positions)),
        hasNormals_(!uniform.normals.empty()),
        affine_(affine),
        planes_(affine.origin(), size),
        singlePrecision_(singlePrecision),
        flatDistance_(flatDistance),
        job_(job) {
    out_.mesh.triangles = base::triangulate(uniform, job);
    out_.mesh.normals = std::move(uniform.normals);
    base::release(uniform.quads);  // which may live as long as what is made of it here
  }

  CutMesh run() {
    load();
    flip({});
    for (int axis = 0; axis < 3; ++axis) {
      // Before the cut: once the base of a cap is on a plane, its apex may be beside it.
      if (moveAll(axis)) flip(out_.isNew);
      setPlaces(axis);
      cut(axis);
      axesCut_ = static_cast<std::size_t>(axis) + 1;
      // Short edges of the uniform mesh the first time, from then on those of what is new.
      join(kLeastEdge, axis == 0 ? Marks() : out_.isNew, [](VertexIndex) { return true; });
      flip(out_.isNew);
    }
    out_.isSeparated = joinWhereRounded();
    setFar();
    out_.moved += reshaped_ * voxelsOfStep();
    finish();
    return std::move(out_);
  }

 private:
  using Marks = std::span<const std::uint8_t>;  // of vertices
  using Stays = std::function<bool(VertexIndex)>;

  // Whether all triangles at a vertex stay on their sides of the planes that were cut at if it goes
  // into another.
  [[nodiscard]] bool mayGoInto(VertexIndex v, VertexIndex into) const {
    for (std::size_t axis = 0; axis < axesCut_; ++axis) {
      const Place from = place_[v][axis], to = place_[into][axis];
      if (from != to && ((to & 1) != 0 || std::abs(from - to) > 1)) return false;
    }
    return true;
  }

  // Whether triangles of these vertices pass none of the planes that were cut at.
  [[nodiscard]] bool isOnOneSide(const std::array<VertexIndex, 4>& vertices) const {
    for (std::size_t axis = 0; axis < axesCut_; ++axis) {
      const auto [low, high] = std::minmax({place_[vertices[0]][axis], place_[vertices[1]][axis],
                                            place_[vertices[2]][axis], place_[vertices[3]][axis]});
      if (high > (low | 1) + 1) return false;
    }
    return true;
  }

  [[nodiscard]] Position positionOf(VertexIndex v) const {
    if (v < uniform_.size() && moved_[v] == 0) return uniform_[v];
    return affine_.position(affine_.origin(), at_[v][0], at_[v][1], at_[v][2]);
  }

  // Of a step of length 1 in the lattice, at most.
  [[nodiscard]] double voxelsOfStep() const {
    double most = 0;
    for (int axis = 0; axis < 3; ++axis) most = std::max(most, affine_.axis(axis).length());
    return std::sqrt(3.0) * most / affine_.voxelSize();
  }

  void load() {
    // For the vertices that cuts make, or all would be moved when the first one is made: three cuts
    // across some three edges a vertex, which are half a voxel long along an axis.
    const std::size_t room = uniform_.size() + 5 * uniform_.size() / size_;
    const auto make = [&](auto& vector) {
      base::reservePopulated(vector, room, job_);
      base::resizeLarge(vector, uniform_.size(), job_);
    };
    make(at_), make(place_), make(moved_), make(out_.isNew);
    if (hasNormals_) base::growLarge(out_.mesh.normals, room);
    job_.forRanges(at_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        at_[v] = affine_.latticePoint(uniform_[v], affine_.origin());
      }
    });
  }

  // Of all vertices: those that were made on planes of other axes too.
  void setPlaces(int axis) {
    const auto a = static_cast<std::size_t>(axis);
    job_.forRanges(at_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) place_[v][a] = planes_.placeOf(axis, at_[v][axis]);
    });
  }

  // Whether there are any to move.
  bool moveAll(int axis) {
    const double perVoxel = affine_.axis(axis).length() / affine_.voxelSize();
    const std::vector<MovedVertex> moved =
        moveToPlanes(planes_, axis, flatDistance_, out_.mesh.triangles, at_, job_);
    for (const auto& [v, by] : moved) {
      moved_[v] += by * perVoxel;
      out_.isNew[v] = 1;
      if (by >= kNearPlane) far_.insert(v);
      if (!far_.contains(v)) out_.moved = std::max(out_.moved, moved_[v]);
    }
    return !moved.empty();
  }

  // Flips caps with a marked vertex, or all without marks.
  void flip(Marks marks) {
    unlessIntersecting([&](const Stays& stays, std::vector<VertexIndex>& changed) {
      const auto mayFlip = [&](const std::array<VertexIndex, 4>& v) {
        return std::none_of(v.begin(), v.end(), stays) && isOnOneSide(v);
      };
      return flipCaps(at_, kLeastHeight, marks, mayFlip, out_.mesh.triangles, changed, job_);
    });
  }

  // Collapses short edges of triangles with a marked vertex, or of all without marks, both ends of
  // which `isWanted`.
  template <class IsWanted>
  void join(double least, Marks marks, const IsWanted& isWanted) {
    unlessIntersecting([&](const Stays& stays, std::vector<VertexIndex>& changed) {
      const auto mayJoin = [&](VertexIndex v, VertexIndex into) {
        return isWanted(v) && isWanted(into) && !stays(v) && !stays(into) && mayGoInto(v, into);
      };
      return joinNearVertices(at_, least, marks, mayJoin, out_.mesh.triangles, changed, job_);
    });
  }

  // Makes a change to the triangles, except around vertices where it would make some of them
  // intersect. `change` is told which vertices these are, lists those whose triangles it has
  // changed, and returns how far that moves the surface at most.
  template <class Change>
  void unlessIntersecting(const Change& change) {
    std::vector<Triangle> before;
    base::copyLarge(out_.mesh.triangles, before, job_);
    std::vector<std::uint8_t> stays(at_.size(), 0);
    std::vector<VertexIndex> changed;
    double moved = 0;
    for (bool isAny = true; isAny;) {
      changed.clear();
      moved = change([&](VertexIndex v) { return stays[v] != 0; }, changed);
      if (changed.empty()) return;
      std::vector<std::uint8_t> isChanged(at_.size(), 0);
      for (const VertexIndex v : changed) isChanged[v] = 1;
      isAny = false;
      const auto placeOf = [&](VertexIndex v) { return at_[v]; };
      for (const intersect::PolygonPair& pair : pairsAt(placeOf, isChanged)) {
        for (const std::uint32_t t : {pair.a, pair.b}) {
          for (const VertexIndex v : out_.mesh.triangles[t].vertices) {
            if (isChanged[v] != 0 && stays[v] == 0) stays[v] = 1, isAny = true;
          }
        }
      }
      if (isAny) out_.mesh.triangles = before;
    }
    for (const VertexIndex v : changed) out_.isNew[v] = 1;
    reshaped_ += moved;
    if (!far_.empty()) spreadMoves(before, changed);
  }

  // The surface around a vertex whose triangles have changed was part of the triangles that it had
  // `before`, so it may have been moved as far as their vertices. In rings, as changes may meet.
  void spreadMoves(const std::vector<Triangle>& before, const std::vector<VertexIndex>& changed) {
    constexpr int kRings = 3;
    std::vector<std::uint8_t> isChanged(at_.size(), 0);
    for (const VertexIndex v : changed) isChanged[v] = 1;
    for (int ring = 0; ring < kRings; ++ring) {
      for (const Triangle& t : before) {
        const auto& v = t.vertices;
        if ((isChanged[v[0]] | isChanged[v[1]] | isChanged[v[2]]) == 0) continue;
        const double most = std::max({moved_[v[0]], moved_[v[1]], moved_[v[2]]});
        if (most <= out_.moved) continue;
        for (const VertexIndex w : v) {
          if (isChanged[w] != 0 && moved_[w] < most) moved_[w] = most, far_.insert(w);
        }
      }
    }
  }

  // The vertices of all triangles of which one was moved far.
  void setFar() {
    if (far_.empty()) return;
    std::vector<double> most(at_.size(), 0);
    for (const Triangle& t : out_.mesh.triangles) {
      const auto& v = t.vertices;
      const double m = std::max({moved_[v[0]], moved_[v[1]], moved_[v[2]]});
      if (m <= out_.moved) continue;
      for (const VertexIndex w : v) most[w] = std::max(most[w], m);
    }
    for (VertexIndex v = 0; v < most.size(); ++v) {
      if (most[v] > out_.moved) out_.far.push_back({v, most[v] - out_.moved});
    }
  }

  // Where triangles that were cut intersect once they are rounded, collapses their short edges.
  // Those of the uniform mesh are known not to. Whether none is known to intersect at the end.
  bool joinWhereRounded() {
    const auto rounded = [&](VertexIndex v) {
      const Position world = affine_.toWorld(positionOf(v));
      return Vec3(singlePrecision_ ? base::toSingle(world) : world);
    };
    std::vector<std::uint8_t> marks = out_.isNew;
    for (const double least : kRoundedEdges) {
      const std::vector<intersect::PolygonPair> pairs = pairsAt(rounded, marks);
      if (pairs.empty()) return true;
      // Only their edges are collapsed, so only they can still intersect, or newly.
      marks.assign(at_.size(), 0);
      for (const intersect::PolygonPair& pair : pairs) {
        for (const std::uint32_t t : {pair.a, pair.b}) {
          for (const VertexIndex v : out_.mesh.triangles[t].vertices) marks[v] = 1;
        }
      }
      join(least, marks, [&](VertexIndex v) { return marks[v] != 0; });
    }
    return false;
  }

  // Pairs of which one triangle has a marked vertex.
  [[nodiscard]] std::vector<intersect::PolygonPair> pairsAt(
      const PlaceOfVertex& placeOf, const std::vector<std::uint8_t>& marks) const {
    return findPairsAt(out_.mesh.triangles, at_, placeOf, marks, job_);
  }

  [[nodiscard]] Place placeAt(VertexIndex v, int axis) const {
    return place_[v][static_cast<std::size_t>(axis)];
  }

  // All triangles at the lowest plane that they pass, and what is made of them again.
  void cut(int axis) {
    std::vector<Triangle> rest = std::move(out_.mesh.triangles), done;
    const std::vector<std::uint32_t> passing =
        base::collectIf(job_, rest.size(), [&](std::uint32_t t) {
          const auto [low, high] = rangeOf(rest[t], axis);
          return low + 2 - (low & 1) < high;
        });
    base::reservePopulated(done, rest.size() + 3 * passing.size(), job_);
    cuts_.clear();
    std::vector<Triangle> open;
    auto next = rest.begin();
    for (std::size_t i = 0; i < passing.size(); ++i) {
      job_.pollCancelled(i);
      const auto at = rest.begin() + passing[i];
      done.insert(done.end(), next, at);
      next = at + 1;
      open.assign(1, *at);
      while (!open.empty()) {
        const Triangle t = open.back();
        open.pop_back();
        const auto [low, high] = rangeOf(t, axis);
        const Place plane = low + 2 - (low & 1);  // the first one above
        if (plane >= high) {
          done.push_back(t);
        } else {
          divide(t, axis, plane, open);
        }
      }
    }
    done.insert(done.end(), next, rest.end());
    out_.mesh.triangles = std::move(done);
    uniform::requireFaces(out_.mesh.triangles.size(), 3);
  }

  [[nodiscard]] std::pair<Place, Place> rangeOf(const Triangle& t, int axis) const {
    return std::minmax(
        {placeAt(t.vertices[0], axis), placeAt(t.vertices[1], axis), placeAt(t.vertices[2], axis)});
  }

  void divide(const Triangle& t, int axis, Place plane, std::vector<Triangle>& out) {
    const auto side = [&](VertexIndex v) {
      const Place p = placeAt(v, axis);
      return p < plane ? -1 : p > plane ? 1 : 0;
    };
    // From a corner on the plane, or else the one that is alone on its side.
    std::size_t first = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const int s[3] = {side(t.vertices[i]), side(t.vertices[(i + 1) % 3]),
                        side(t.vertices[(i + 2) % 3])};
      if (s[0] == 0 || (s[1] == s[2] && s[0] == -s[1])) first = i;
    }
    const VertexIndex a = t.vertices[first], b = t.vertices[(first + 1) % 3],
                      c = t.vertices[(first + 2) % 3];
    if (side(a) == 0) {
      const VertexIndex m = crossing(b, c, axis, plane);
      out.emplace_back(a, b, m);
      out.emplace_back(a, m, c);
      return;
    }
    const VertexIndex m = crossing(a, b, axis, plane), k = crossing(a, c, axis, plane);
    out.emplace_back(a, m, k);
    if ((at_[m] - at_[c]).squaredLength() <= (at_[b] - at_[k]).squaredLength()) {
      out.emplace_back(m, b, c);
      out.emplace_back(m, c, k);
    } else {
      out.emplace_back(m, b, k);
      out.emplace_back(b, c, k);
    }
  }

  // The vertex where an edge passes a plane.
  VertexIndex crossing(VertexIndex a, VertexIndex b, int axis, Place plane) {
    if (placeAt(a, axis) > placeAt(b, axis)) std::swap(a, b);
    const std::uint64_t key = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    uniform::requireIndexable(at_.size() + 1);
    const auto [found, isNew] = cuts_.emplace(key, static_cast<VertexIndex>(at_.size()));
    if (!isNew) return found->second;
    const double x = planes_.at(axis, plane / 2);
    const double share = (x - at_[a][axis]) / (at_[b][axis] - at_[a][axis]);
    Vec3 p = at_[a] + (at_[b] - at_[a]) * share;
    PlacesAmongPlanes place{};
    for (int i = 0; i < 3; ++i) {
      p[i] = std::clamp(p[i], std::min(at_[a][i], at_[b][i]), std::max(at_[a][i], at_[b][i]));
      if (i == axis) p[i] = x;
      place[static_cast<std::size_t>(i)] = planes_.placeOf(i, p[i]);
    }
    at_.push_back(p);
    place_.push_back(place);
    moved_.push_back(std::max(moved_[a], moved_[b]));  // of a point between: no more
    if (far_.contains(a) || far_.contains(b)) far_.insert(found->second);
    out_.isNew.push_back(1);
    if (hasNormals_) {
      const Vec3 m = Vec3(out_.mesh.normals[a]) * (1 - share) + Vec3(out_.mesh.normals[b]) * share;
      const Vec3 n = m.unitOrX();
      out_.mesh.normals.emplace_back(static_cast<float>(n[0]), static_cast<float>(n[1]),
                                     static_cast<float>(n[2]));
    }
    return found->second;
  }

  void finish() {
    Mesh& mesh = out_.mesh;
    base::resizeLarge(mesh.positions, at_.size(), job_);
    job_.forRanges(at_.size(), [&](std::size_t begin, std::size_t end) {
      for (auto v = static_cast<VertexIndex>(begin); v < end; ++v) {
        mesh.positions[v] = positionOf(v);
      }
    });
    base::release(uniform_);
    std::vector<Coord> chunkOf;
    base::resizeLarge(chunkOf, mesh.triangles.size(), job_);
    job_.forRanges(chunkOf.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) chunkOf[t] = chunkAt(mesh.triangles[t]);
    });
    // Neighbours are mostly of one chunk.
    std::unique_copy(chunkOf.begin(), chunkOf.end(), std::back_inserter(out_.chunks));
    std::sort(out_.chunks.begin(), out_.chunks.end());
    out_.chunks.erase(std::unique(out_.chunks.begin(), out_.chunks.end()), out_.chunks.end());
    std::vector<std::uint32_t> placeOf;
    base::resizeLarge(placeOf, chunkOf.size(), job_);
    job_.forRanges(chunkOf.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        const auto found = std::lower_bound(out_.chunks.begin(), out_.chunks.end(), chunkOf[t]);
        placeOf[t] = static_cast<std::uint32_t>(found - out_.chunks.begin());
      }
    });
    out_.chunkOf = std::move(placeOf);
    base::release(chunkOf), base::release(at_);
    base::shrinkTo(mesh.normals, mesh.normals.size());
    base::shrinkTo(out_.isNew, out_.isNew.size());
    namePlanes(place_, out_, job_);
  }

  [[nodiscard]] Coord chunkAt(const Triangle& t) const {
    Coord chunk;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = rangeOf(t, axis);
      Place n = low >> 1;
      if (low == high && (low & 1) == 0) {
        const Vec3 normal = (at_[t.vertices[1]] - at_[t.vertices[0]])
                                .cross(at_[t.vertices[2]] - at_[t.vertices[0]]);
        if ((normal[axis] > 0) != affine_.mirrored()) --n;
      }
      chunk[axis] = static_cast<std::int32_t>(n);
    }
    return chunk;
  }

  std::size_t size_;  ///< of chunks, voxels
  std::vector<Position> uniform_;
  bool hasNormals_;
  const grid::Affine& affine_;
  ChunkPlanes planes_;
  bool singlePrecision_;
  double flatDistance_;
  base::Job& job_;
  CutMesh out_;
  std::vector<Vec3> at_;  ///< lattice points, counted from the origin of positions
  std::vector<PlacesAmongPlanes> place_;
  std::size_t axesCut_ = 0;              ///< across the first so many axes the mesh is cut
  double reshaped_ = 0;                  ///< how far collapses and flips have moved it, steps
  std::vector<double> moved_;            ///< how far each vertex was moved to planes, voxels
  std::unordered_set<VertexIndex> far_;  ///< those that were moved by more than all others
  std::unordered_map<std::uint64_t, VertexIndex> cuts_;
};

}  // namespace

CutMesh cutAtChunks(Mesh uniform, const grid::Affine& affine, int size, bool singlePrecision,
                    double flatDistance, base::Job& job) {
  return Cutter(std::move(uniform), affine, size, singlePrecision, flatDistance, job).run();
}

}  // namespace tufa::chunks
