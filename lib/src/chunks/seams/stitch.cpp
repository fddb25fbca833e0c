#include "chunks/seams/stitch.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include "base/vec3.h"

namespace tufa::chunks {
namespace {

// More than all edges of a strip together: no fold is worth a short edge.
constexpr double kFold = 1e6;
// A triangle is folded if the cosine between its normal and the mean of those of its corners is
// smaller.
constexpr double kLeastCosine = 0.1;

constexpr double kNever = std::numeric_limits<double>::infinity();
// Costs that differ by less are equal but for the order of summation.
constexpr double kSlack = 1 + 1e-9;
// Factor on the cost of an edge across between vertices that have no arc in common.
constexpr double kAstray = 3;

// A vertex of one side, and the first of the arcs that it stands for.
struct Link {
  VertexIndex vertex;
  std::size_t arc;
};

// The vertices of a side, each run of equal ones once; a closed side starts with a new run.
std::vector<Link> chainOf(const std::vector<VertexIndex>& vertices, bool closed) {
  std::vector<Link> chain;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const bool first = i == 0 && (!closed || vertices.front() != vertices.back());
    if (first || (i > 0 && vertices[i] != vertices[i - 1])) chain.push_back({vertices[i], i});
  }
  if (chain.empty()) chain.push_back({vertices[0], 0});
  return chain;
}

// Finds a strip as a path through the grid of pairs (tile, vertex of the polyline): each step
// advances on one side and adds one triangle, and its cost is that of the triangle and of the edge
// across that it ends at. Any path closes the strip; the cheapest is found in one sweep over the
// grid.
class Stitcher {
 public:
  using MayJoin = std::function<bool(VertexIndex, VertexIndex)>;

  Stitcher(const ChunkSeam& seam, std::span<const Position> positions,
           std::span<const Normal> normals, const MayJoin& mayJoin)
      : seam_(seam), positions_(positions), normals_(normals), mayJoin_(mayJoin) {}

  // Triangles as the arcs run. Where both sides advance at once there are two ways; around a loop
  // one of them may repeat an edge across.
  std::vector<StripTriangle> direct() {
    const std::size_t count = seam_.tiles.size();
    std::set<std::pair<VertexIndex, VertexIndex>> across;
    for (std::size_t i = 0; i < count; ++i) across.emplace(seam_.tiles[i], seam_.polyline[i]);
    for (std::size_t i = 0; i + (seam_.closed ? 0 : 1) < count; ++i) {
      const std::size_t j = (i + 1) % count;
      const VertexIndex p = seam_.polyline[i], q = seam_.polyline[j];
      const VertexIndex a = seam_.tiles[i], b = seam_.tiles[j];
      if (p == q) {
        add(p, a, b, i);
      } else if (a == b) {
        add(p, a, q, i);
      } else if (!across.contains({a, q}) &&
                 (across.contains({b, p}) ||
                  stepCost(p, a, q) + stepCost(q, a, b) < stepCost(p, a, b) + stepCost(p, b, q))) {
        across.emplace(a, q);
        add(p, a, q, i);
        add(q, a, b, i);
      } else {
        across.emplace(b, p);
        add(p, a, b, i);
        add(p, b, q, i);
      }
    }
    addEnds();
    return std::move(strip_);
  }

  // The cheapest sequence of steps. Empty if it uses an edge across twice.
  std::vector<StripTriangle> best() {
    for (std::size_t i = 0; i < seam_.tiles.size(); ++i) {
      paired_.emplace_back(seam_.tiles[i], seam_.polyline[i]);
    }
    std::sort(paired_.begin(), paired_.end());
    tiles_ = chainOf(seam_.tiles, seam_.closed);
    line_ = chainOf(seam_.polyline, seam_.closed);
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
  [[nodiscard]] Vec3 at(VertexIndex vertex) const { return Vec3(positions_[vertex]); }

  void add(VertexIndex a, VertexIndex b, VertexIndex c, std::size_t arc) {
    if (a != b && b != c && a != c) strip_.push_back({{a, b, c}, arc});
  }

  void addEnds() {
    if (seam_.begin != ChunkSeam::kNone) add(seam_.begin, seam_.tiles[0], seam_.polyline[0], 0);
    const std::size_t last = seam_.tiles.size() - 1;
    if (seam_.end != ChunkSeam::kNone)
      add(seam_.polyline[last], seam_.tiles[last], seam_.end, last);
  }

  // The cost of a triangle without its edges: nothing unless it is folded; its squared size then,
  // to be comparable with edges.
  [[nodiscard]] double stepCost(VertexIndex a, VertexIndex b, VertexIndex c) const {
    if (!isFolded({a, b, c}, positions_, normals_)) return 0;
    return kFold * ((at(c) - at(b)).squaredLength() + (at(b) - at(a)).squaredLength() +
                    (at(c) - at(a)).squaredLength());
  }
  [[nodiscard]] double acrossCost(std::size_t i, std::size_t j) const {
    const std::pair<VertexIndex, VertexIndex> pair{tiles_[i].vertex, line_[j].vertex};
    const bool paired = std::binary_search(paired_.begin(), paired_.end(), pair);
    return (paired ? 1 : kAstray) * (at(pair.first) - at(pair.second)).squaredLength();
  }

  // Rotates both sides of a loop to start at a short edge across that the arcs have.
  void startNearest() {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < seam_.tiles.size(); ++i) {
      const double squared = (at(seam_.tiles[i]) - at(seam_.polyline[i])).squaredLength();
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
    turn(line_, seam_.polyline[best]);
  }

  // Cuts off the vertex of the chunk, beside a fold, that helps most. Whether one helps.
  bool cutEar() {
    double best = costs_.back();
    std::size_t ear = 0;
    const std::vector<std::size_t> places = besideFolds();
    if (!places.empty()) findOnward();
    for (const std::size_t i : places) {
      const VertexIndex a = tiles_[i - 1].vertex, b = tiles_[i].vertex, c = tiles_[i + 1].vertex;
      if (a == c || stepCost(a, b, c) > 0) continue;
      if (areJoined(tiles_, a, c) || !mayJoin_(a, c)) continue;
      const double cost = costWithout(i);
      if (cost >= best) continue;
      best = cost;
      ear = i;
    }
    if (ear == 0) return false;
    strip_.push_back(
        {{tiles_[ear - 1].vertex, tiles_[ear].vertex, tiles_[ear + 1].vertex}, tiles_[ear].arc});
    tiles_.erase(tiles_.begin() + static_cast<std::ptrdiff_t>(ear));
    findCosts();
    return true;
  }

  // The least cost of all sequences without one of the inner tiles: a way up to the tile before,
  // and one on from the tile behind.
  [[nodiscard]] double costWithout(std::size_t i) {
    double least = kNever;
    for (std::size_t j = 0; j < line_.size(); ++j) {
      if (isRound(i - 1, j) || isRound(i + 1, j)) continue;
      const double ends = costAt(i - 1, j) + onward_[(i + 1) * line_.size() + j];
      if (ends >= least) continue;
      least = std::min(least,
                       ends + acrossCost(i + 1, j) +
                           stepCost(line_[j].vertex, tiles_[i - 1].vertex, tiles_[i + 1].vertex));
    }
    return least;
  }

  // Whether two vertices are neighbours on the chunk's side already, as in a loop of three.
  static bool areJoined(const std::vector<Link>& tiles, VertexIndex a, VertexIndex b) {
    for (std::size_t i = 0; i + 1 < tiles.size(); ++i) {
      const VertexIndex from = tiles[i].vertex, to = tiles[i + 1].vertex;
      if ((from == a && to == b) || (from == b && to == a)) return true;
    }
    return false;
  }

  // Places in tiles_, without the ends, next to folded triangles of the cheapest sequence; sorted.
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

  // Pairs that a sequence around a loop must not pass: they would repeat the first edge across.
  [[nodiscard]] bool isRound(std::size_t i, std::size_t j) const {
    return seam_.closed && ((i == 0 && j == lineCount_) || (i + 1 == tiles_.size() && j == 0));
  }
  [[nodiscard]] double tileStep(std::size_t i, std::size_t j) const {
    return stepCost(line_[j].vertex, tiles_[i - 1].vertex, tiles_[i].vertex);
  }
  [[nodiscard]] double lineStep(std::size_t i, std::size_t j) const {
    return stepCost(line_[j - 1].vertex, tiles_[i].vertex, line_[j].vertex);
  }

  // The cost of the sequence that follows the arcs, an upper bound: no cheaper one passes a pair
  // that costs more.
  [[nodiscard]] double costAlongArcs() const {
    const std::size_t arcs = seam_.tiles.size();
    const auto place = [&](const std::vector<Link>& chain, std::size_t k) {
      if (k + 1 == chain.size() && seam_.closed) return arcs;
      return (chain[k].arc + arcs - chain[0].arc) % arcs;
    };
    double cost = 0;
    for (std::size_t i = 0, j = 0; i + 1 < tiles_.size() || j + 1 < line_.size();) {
      const bool byTile = j + 1 == line_.size() ||
                          (i + 1 < tiles_.size() && place(tiles_, i + 1) <= place(line_, j + 1));
      byTile ? ++i : ++j;
      if (isRound(i, j)) return kNever;
      cost += (byTile ? tileStep(i, j) : lineStep(i, j)) + acrossCost(i, j);
    }
    return cost;
  }

  // The least cost from the first pair to each other one; kNever for pairs that cannot be on the
  // cheapest sequence. Row by row, as each pair is reached from the pair before it on one side.
  void findCosts() {
    const double most = kSlack * costAlongArcs();
    costs_.assign(tiles_.size() * line_.size(), kNever);
    byTile_.assign(costs_.size(), 0);
    costs_[0] = 0;
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
      for (std::size_t j = 0; j < line_.size(); ++j) {
        if ((i == 0 && j == 0) || isRound(i, j)) continue;
        double best = kNever;
        if (i > 0 && costAt(i - 1, j) < kNever) {
          best = costAt(i - 1, j) + tileStep(i, j);
          byTile_[i * line_.size() + j] = 1;
        }
        if (j > 0 && costAt(i, j - 1) < best) {
          const double other = costAt(i, j - 1) + lineStep(i, j);
          if (other < best) {
            best = other;
            byTile_[i * line_.size() + j] = 0;
          }
        }
        if (!(best <= most)) continue;
        best += acrossCost(i, j);
        if (best <= most) costAt(i, j) = best;
      }
    }
  }

  // The least cost from each pair to the last, of those that findCosts() reached.
  void findOnward() {
    const std::size_t width = line_.size();
    onward_.assign(costs_.size(), kNever);
    onward_.back() = 0;
    for (std::size_t i = tiles_.size(); i-- > 0;) {
      for (std::size_t j = width; j-- > 0;) {
        double& own = onward_[i * width + j];
        if (isRound(i, j)) continue;
        if (i + 1 < tiles_.size() && onward_[(i + 1) * width + j] < own) {
          own = std::min(own,
                         onward_[(i + 1) * width + j] + tileStep(i + 1, j) + acrossCost(i + 1, j));
        }
        if (j + 1 < width && onward_[i * width + j + 1] < own) {
          own =
              std::min(own, onward_[i * width + j + 1] + lineStep(i, j + 1) + acrossCost(i, j + 1));
        }
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
  std::vector<std::pair<VertexIndex, VertexIndex>> paired_;  // that stand for one arc; sorted
  // For each pair of a tile and a vertex of the polyline: the least cost from the first pair,
  // whether the last step is one between tiles, and the least cost to the last pair.
  std::vector<double> costs_;
  std::vector<std::uint8_t> byTile_;
  std::vector<double> onward_;
};

}  // namespace

bool isFolded(const Triangle& triangle, std::span<const Position> positions,
              std::span<const Normal> normals) {
  const auto& v = triangle.vertices;
  const Vec3 a = Vec3(positions[v[0]]);
  const Vec3 normal = (Vec3(positions[v[1]]) - a).cross(Vec3(positions[v[2]]) - a);
  Vec3 facing(0.0);
  for (const VertexIndex i : v) facing += Vec3(normals[i].x, normals[i].y, normals[i].z);
  return !(normal.dot(facing) > kLeastCosine * normal.length() * facing.length());
}

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
