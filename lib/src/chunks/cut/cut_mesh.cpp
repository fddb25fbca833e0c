#include "chunks/cut/cut_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>
#include <unordered_map>
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
#include "chunks/cut/push_apart.h"
#include "chunks/cut/surface_moves.h"
#include "intersect/surface.h"
#include "uniform/uniform_surface.h"

namespace tufa::chunks {
namespace {

// Voxels; shorter edges are collapsed once they are cut. Slivers are cut in places that single
// precision does not tell apart.
constexpr double kLeastEdge = 1e-3;
// Where triangles intersect once they are rounded, edges shorter than these, one after the other;
// then vertices are moved so many steps off the triangles that they are in; and where both sides of
// a thin fold lie in one line on a plane, longer edges.
constexpr double kRoundedEdges[] = {2e-3, 4e-3, 8e-3}, kMargins[] = {1e-4, 1e-3, 4e-3},
                 kEdgesAtFolds[] = {1.6e-2, 3.2e-2};
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
      join(kLeastEdge, axis == 0 ? Marks() : out_.isNew, false, [](VertexIndex) { return true; });
      flip(out_.isNew);
    }
    out_.isSeparated = separateWhereRounded();
    out_.movedAt = moves_.take(out_.mesh.triangles, job_);
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
    if (v < uniform_.size() && isMoved_[v] == 0) return uniform_[v];
    return affine_.position(affine_.origin(), at_[v][0], at_[v][1], at_[v][2]);
  }

  // Of a step of length 1 in the lattice, at most: the largest singular value of the lattice's axes
  // is no more than the square root of the largest row sum of their products (Gershgorin).
  [[nodiscard]] double voxelsOfStep() const {
    double most = 0;
    for (int i = 0; i < 3; ++i) {
      double sum = 0;
      for (int j = 0; j < 3; ++j) sum += std::abs(affine_.axis(i).dot(affine_.axis(j)));
      most = std::max(most, sum);
    }
    return std::sqrt(most) / affine_.voxelSize();
  }

  void load() {
    // For the vertices that cuts make, or all would be moved when the first one is made: three cuts
    // across some three edges a vertex, which are half a voxel long along an axis.
    const std::size_t room = uniform_.size() + 5 * uniform_.size() / size_;
    const auto make = [&](auto& vector) {
      base::reservePopulated(vector, room, job_);
      base::resizeLarge(vector, uniform_.size(), job_);
    };
    make(at_), make(place_), make(out_.isNew);
    base::resizeLarge(isMoved_, uniform_.size(), job_);
    moves_.reserve(uniform_.size(), room, job_);
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
    std::vector<MovedVertex> moved =
        moveToPlanes(planes_, axis, flatDistance_, out_.mesh.triangles, at_, job_);
    noteMoved(moved, perVoxel);
    return !moved.empty();
  }

  // Flips caps with a marked vertex, or all without marks.
  void flip(Marks marks) {
    unlessIntersecting([&](const Stays& stays, std::vector<MovedVertex>& changed) {
      const auto mayFlip = [&](const std::array<VertexIndex, 4>& v) {
        return std::none_of(v.begin(), v.end(), stays) && isOnOneSide(v);
      };
      flipCaps(at_, kLeastHeight, marks, mayFlip, out_.mesh.triangles, changed, job_);
    });
  }

  // Collapses short edges of triangles with a marked vertex, or of all without marks, both ends of
  // which `isWanted`.
  template <class IsWanted>
  void join(double least, Marks marks, bool mayFold, const IsWanted& isWanted) {
    unlessIntersecting([&](const Stays& stays, std::vector<MovedVertex>& changed) {
      const auto mayJoin = [&](VertexIndex v, VertexIndex into) {
        return isWanted(v) && isWanted(into) && !stays(v) && !stays(into) && mayGoInto(v, into);
      };
      joinNearVertices(at_, least, mayFold, marks, mayJoin, out_.mesh.triangles, changed, job_);
    });
  }

  // Makes a change to the triangles, except around vertices where it would make some of them
  // intersect. `change` is told which vertices these are, and lists those whose triangles it has
  // changed, with how far that moves them in steps.
  template <class Change>
  void unlessIntersecting(const Change& change) {
    std::vector<Triangle> before;
    base::copyLarge(out_.mesh.triangles, before, job_);
    std::vector<std::uint8_t> stays(at_.size(), 0);
    std::vector<MovedVertex> changed;
    for (bool isAny = true; isAny;) {
      changed.clear();
      change([&](VertexIndex v) { return stays[v] != 0; }, changed);
      if (changed.empty()) return;
      std::vector<std::uint8_t> isChanged(at_.size(), 0);
      for (const MovedVertex& v : changed) isChanged[v.vertex] = 1;
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
    for (auto& [v, by] : changed) {
      out_.isNew[v] = 1;
      by *= voxelsOfStep();
    }
    moves_.add(SurfaceMoves::Kind::Triangles, before, changed, job_);
  }

  // Where triangles that were cut intersect once they are rounded, collapses their short edges, and
  // pushes them apart: sheets of the uniform mesh, which does not intersect itself, may be no
  // farther from each other than rounding takes vertices that cuts have made. Whether none is known
  // to intersect at the end.
  bool separateWhereRounded() {
    const auto rounded = [&](VertexIndex v) {
      const Position world = affine_.toWorld(positionOf(v));
      return Vec3(singlePrecision_ ? base::toSingle(world) : world);
    };
    std::vector<std::uint8_t> marks = out_.isNew;
    std::vector<intersect::PolygonPair> pairs = pairsAt(rounded, marks);
    const auto separate = [&](const auto& change) {
      if (pairs.empty()) return;
      // Only what they have is changed, so only they can still intersect, or newly.
      marks.assign(at_.size(), 0);
      for (const intersect::PolygonPair& pair : pairs) {
        for (const std::uint32_t t : {pair.a, pair.b}) {
          for (const VertexIndex v : out_.mesh.triangles[t].vertices) marks[v] = 1;
        }
      }
      change();
      pairs = pairsAt(rounded, marks);
    };
    const auto joinMarked = [&](double least) {
      join(least, marks, true, [&](VertexIndex v) { return marks[v] != 0; });
    };
    for (const double least : kRoundedEdges) separate([&] { joinMarked(least); });
    for (const double margin : kMargins) separate([&] { push(pairs, margin); });
    for (const double least : kEdgesAtFolds) separate([&] { joinMarked(least); });
    return pairs.empty();
  }

  // Moves vertices of pairs out of the other triangle, inside their chunks.
  void push(const std::vector<intersect::PolygonPair>& pairs, double margin) {
    const auto mayMove = [&](VertexIndex v, const Vec3& to) {
      for (int axis = 0; axis < 3; ++axis) {
        const Place now = placeAt(v, axis);
        if ((now & 1) == 0 || planes_.placeOf(axis, to[axis]) != now) return false;
      }
      return true;
    };
    std::vector<MovedVertex> moved;
    pushApart(out_.mesh.triangles, pairs, margin, mayMove, at_, moved);
    noteMoved(moved, voxelsOfStep());
  }

  // Of vertices that were moved by so many units of `voxels` each.
  void noteMoved(std::vector<MovedVertex>& moved, double voxels) {
    for (auto& [v, by] : moved) {
      by *= voxels;
      if (v < uniform_.size()) isMoved_[v] = 1;
      out_.isNew[v] = 1;
    }
    moves_.add(SurfaceMoves::Kind::Places, out_.mesh.triangles, moved, job_);
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
    moves_.addBetween(a, b);
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
  std::size_t axesCut_ = 0;            ///< across the first so many axes the mesh is cut
  std::vector<std::uint8_t> isMoved_;  ///< of vertices of the uniform mesh: whether at_ is another
  SurfaceMoves moves_;                 ///< voxels
  std::unordered_map<std::uint64_t, VertexIndex> cuts_;
};

}  // namespace

CutMesh cutAtChunks(Mesh uniform, const grid::Affine& affine, int size, bool singlePrecision,
                    double flatDistance, base::Job& job) {
  return Cutter(std::move(uniform), affine, size, singlePrecision, flatDistance, job).run();
}

}  // namespace tufa::chunks
