#include "chunks/stitch.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <set>
#include <utility>

namespace tufa::chunks {
namespace {

using openvdb::Vec3d;

// More than all edges of a strip together: no fold is worth a short edge.
constexpr double kFold = 1e6;
// A triangle whose normal and the mean of those of its corners have a smaller cosine is folded.
constexpr double kLeastCosine = 0.1;

// What an edge across between vertices that stand for no common arc costs more.
constexpr double kAstray = 3;

// A vertex of one side, and the first of the arcs that it stands for.
struct Link {
  VertexIndex vertex;
  std::size_t arc;
};

// The vertices of a side, each run of equal ones once; a closed side starts with a fresh one.
std::vector<Link> chainOf(const std::vector<VertexIndex>& vertices, bool closed) {
  std::vector<Link> chain;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const bool first = i == 0 && (!closed || vertices.front() != vertices.back());
    if (first || (i > 0 && vertices[i] != vertices[i - 1])) chain.push_back({vertices[i], i});
  }
  if (chain.empty()) chain.push_back({vertices[0], 0});
  return chain;
}

class Stitcher {
 public:
  using MayJoin = std::function<bool(VertexIndex, VertexIndex)>;

  Stitcher(const ChunkSeam& seam, std::span<const Position> positions,
           std::span<const Normal> normals, const MayJoin& mayJoin)
      : seam_(seam), positions_(positions), normals_(normals), mayJoin_(mayJoin) {}

  // As the arcs run.
  std::vector<StripTriangle> direct() {
    const std::size_t count = seam_.tiles.size();
    for (std::size_t i = 0; i + (seam_.closed ? 0 : 1) < count; ++i) {
      const std::size_t j = (i + 1) % count;
      const VertexIndex p = seam_.line[i], q = seam_.line[j];
      const VertexIndex a = seam_.tiles[i], b = seam_.tiles[j];
      if (p == q) {
        add(p, a, b, i);
      } else if (a == b) {
        add(p, a, q, i);
      } else if (stepCost(p, a, q) + stepCost(q, a, b) < stepCost(p, a, b) + stepCost(p, b, q)) {
        add(p, a, q, i);
        add(q, a, b, i);
      } else {
        add(p, a, b, i);
        add(p, b, q, i);
      }
    }
    addEnds();
    return std::move(strip_);
  }

  // The best of all ways. Empty if it uses an edge across twice.
  std::vector<StripTriangle> best() {
    for (std::size_t i = 0; i < seam_.tiles.size(); ++i) {
      paired_.emplace(seam_.tiles[i], seam_.line[i]);
    }
    tiles_ = chainOf(seam_.tiles, seam_.closed);
    line_ = chainOf(seam_.line, seam_.closed);
    if (seam_.closed) startNearest();
    lineCount_ = line_.size();
    if (seam_.closed) {
      tiles_.push_back(tiles_.front());
      line_.push_back(line_.front());
    }
    findCosts();
    while (mayJoin_ && cutEar()) {
    }
    if (!followCosts()) return {};
    addEnds();
    return std::move(strip_);
  }

 private:
  [[nodiscard]] Vec3d at(VertexIndex vertex) const {
    const Position& p = positions_[vertex];
    return {p.x, p.y, p.z};
  }

  void add(VertexIndex a, VertexIndex b, VertexIndex c, std::size_t arc) {
    if (a != b && b != c && a != c) strip_.push_back({{a, b, c}, arc});
  }

  void addEnds() {
    if (seam_.begin != ChunkSeam::kNone) add(seam_.begin, seam_.tiles[0], seam_.line[0], 0);
    const std::size_t last = seam_.tiles.size() - 1;
    if (seam_.end != ChunkSeam::kNone) add(seam_.line[last], seam_.tiles[last], seam_.end, last);
  }

  // What a triangle costs but for its edges; its squared size makes folds comparable to them.
  [[nodiscard]] double stepCost(VertexIndex a, VertexIndex b, VertexIndex c) const {
    const Vec3d u = at(b) - at(a), v = at(c) - at(a), normal = u.cross(v);
    Vec3d facing(0.0);
    for (const VertexIndex i : {a, b, c}) {
      facing += Vec3d(normals_[i].x, normals_[i].y, normals_[i].z);
    }
    const double cosine = normal.dot(facing);
    if (cosine > kLeastCosine * normal.length() * facing.length()) return 0;
    return kFold * ((at(c) - at(b)).lengthSqr() + u.lengthSqr() + v.lengthSqr());
  }
  [[nodiscard]] double acrossCost(std::size_t i, std::size_t j) const {
    const std::pair<VertexIndex, VertexIndex> pair{tiles_[i].vertex, line_[j].vertex};
    return (paired_.contains(pair) ? 1 : kAstray) * (at(pair.first) - at(pair.second)).lengthSqr();
  }

  // Turns both sides of a loop to a short edge across that the arcs have.
  void startNearest() {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < seam_.tiles.size(); ++i) {
      const double squared = (at(seam_.tiles[i]) - at(seam_.line[i])).lengthSqr();
      if (squared >= least) continue;
      least = squared;
      best = i;
    }
    const auto turn = [](std::vector<Link>& chain, VertexIndex first) {
      const auto found = std::find_if(chain.begin(), chain.end(),
                                      [&](const Link& link) { return link.vertex == first; });
      std::rotate(chain.begin(), found, chain.end());
    };
    turn(tiles_, seam_.tiles[best]);
    turn(line_, seam_.line[best]);
  }

  // Cuts off a vertex of the chunk beside a fold that stands back behind its neighbours, the one
  // that helps most. Returns whether one helps.
  bool cutEar() {
    const double before = costs_.back();
    const std::vector<Link> tiles = tiles_;
    std::vector<Link> bestTiles;
    double best = before;
    StripTriangle bestEar;
    for (const std::size_t i : besideFolds()) {
      const Link &a = tiles[i - 1], &b = tiles[i], &c = tiles[i + 1];
      if (a.vertex == c.vertex || stepCost(a.vertex, b.vertex, c.vertex) > 0) continue;
      if (areJoined(tiles, a.vertex, c.vertex) || !mayJoin_(a.vertex, c.vertex)) continue;
      tiles_ = tiles;
      tiles_.erase(tiles_.begin() + static_cast<std::ptrdiff_t>(i));
      findCosts();
      if (costs_.back() >= best) continue;
      best = costs_.back();
      bestTiles = tiles_;
      bestEar = {{a.vertex, b.vertex, c.vertex}, b.arc};
    }
    tiles_ = bestTiles.empty() ? tiles : bestTiles;
    findCosts();
    if (bestTiles.empty()) return false;
    strip_.push_back(bestEar);
    return true;
  }

  // Whether two vertices follow each other on the chunk's side already, as in a loop of three.
  static bool areJoined(const std::vector<Link>& tiles, VertexIndex a, VertexIndex b) {
    for (std::size_t i = 0; i + 1 < tiles.size(); ++i) {
      const VertexIndex from = tiles[i].vertex, to = tiles[i + 1].vertex;
      if ((from == a && to == b) || (from == b && to == a)) return true;
    }
    return false;
  }

  // Places in tiles_, but for the ends, next to folded triangles of the best way; sorted.
  [[nodiscard]] std::vector<std::size_t> besideFolds() {
    std::vector<std::size_t> places;
    const auto note = [&](std::size_t i) {
      for (std::size_t k = i < 2 ? 1 : i - 1; k <= i + 1 && k + 1 < tiles_.size(); ++k) {
        places.push_back(k);
      }
    };
    std::size_t i = tiles_.size() - 1, j = line_.size() - 1;
    while (i > 0 || j > 0) {
      const VertexIndex a = tiles_[i].vertex, p = line_[j].vertex;
      if (byTile_[i * line_.size() + j] != 0) {
        if (stepCost(p, tiles_[--i].vertex, a) > 0) note(i);
      } else {
        if (j == 0) break;
        if (stepCost(line_[--j].vertex, a, p) > 0) note(i);
      }
    }
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    return places;
  }

  [[nodiscard]] double& costAt(std::size_t i, std::size_t j) {
    return costs_[i * line_.size() + j];
  }

  // Least costs of all ways from the first pair to each other one.
  void findCosts() {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    costs_.assign(tiles_.size() * line_.size(), kNever);
    byTile_.assign(costs_.size(), 0);
    costs_[0] = 0;
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
      for (std::size_t j = 0; j < line_.size(); ++j) {
        const bool round =
            seam_.closed && ((i == 0 && j == lineCount_) || (i + 1 == tiles_.size() && j == 0));
        if ((i == 0 && j == 0) || round) continue;
        double best = kNever;
        if (i > 0) {
          best =
              costAt(i - 1, j) + stepCost(line_[j].vertex, tiles_[i - 1].vertex, tiles_[i].vertex);
          byTile_[i * line_.size() + j] = 1;
        }
        if (j > 0) {
          const double other =
              costAt(i, j - 1) + stepCost(line_[j - 1].vertex, tiles_[i].vertex, line_[j].vertex);
          if (i == 0 || other < best) {
            best = other;
            byTile_[i * line_.size() + j] = 0;
          }
        }
        costAt(i, j) = best + acrossCost(i, j);
      }
    }
  }

  bool followCosts() {
    std::set<std::pair<VertexIndex, VertexIndex>> used;
    std::size_t i = tiles_.size() - 1, j = line_.size() - 1;
    while (i > 0 || j > 0) {
      if (!used.emplace(tiles_[i].vertex, line_[j].vertex).second) return false;
      if (byTile_[i * line_.size() + j] != 0) {
        add(line_[j].vertex, tiles_[i - 1].vertex, tiles_[i].vertex, tiles_[i].arc);
        --i;
      } else {
        if (j == 0) return false;
        add(line_[j - 1].vertex, tiles_[i].vertex, line_[j].vertex, line_[j].arc);
        --j;
      }
    }
    // The first pair of a loop is the last one again.
    return seam_.closed || used.emplace(tiles_[0].vertex, line_[0].vertex).second;
  }

  const ChunkSeam& seam_;
  std::span<const Position> positions_;
  std::span<const Normal> normals_;
  std::vector<StripTriangle> strip_;
  std::vector<Link> tiles_, line_;  // of a loop with the first again at the end
  std::size_t lineCount_ = 0;       // without that
  const MayJoin& mayJoin_;
  std::set<std::pair<VertexIndex, VertexIndex>> paired_;  // vertices that stand for one arc
  std::vector<double> costs_;                             // of the pairs (tile, line)
  std::vector<std::uint8_t> byTile_;  // whether the last step to a pair was one from tile to tile
};

}  // namespace

std::vector<StripTriangle> stitch(const ChunkSeam& seam, bool several,
                                  std::span<const Position> positions,
                                  std::span<const Normal> normals,
                                  const std::function<bool(VertexIndex, VertexIndex)>& mayJoin) {
  if (!several) {
    std::vector<StripTriangle> strip = Stitcher(seam, positions, normals, mayJoin).best();
    if (!strip.empty()) return strip;
  }
  return Stitcher(seam, positions, normals, mayJoin).direct();
}

}  // namespace tufa::chunks
