#include "check/topology.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/sort_unique.h"
#include "check/stars.h"

namespace tufa::checks {
namespace {

using Edge = std::pair<VertexIndex, VertexIndex>;

/// Union-find in which the root of a set is its smallest member, whatever the order of the joins.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), VertexIndex{0});
  }
  VertexIndex root(VertexIndex i) {
    while (parents_[i] != i) {
      parents_[i] = parents_[parents_[i]];
      i = parents_[i];
    }
    return i;
  }
  void join(VertexIndex a, VertexIndex b) {
    a = root(a);
    b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<VertexIndex> parents_;
};

/// Counts of a component while they are added up.
struct PieceCounts {
  CheckComponent component;
  VertexIndex firstVertex = 0;
  long long edges = 0;
  bool closedManifold = true;  ///< and oriented
};

/// Connected groups of boundary edges: each is a closed curve unless curves touch in a vertex.
std::size_t countLoops(std::vector<Edge> edges) {
  std::vector<VertexIndex> ends;
  ends.reserve(2 * edges.size());
  for (const Edge& edge : edges) {
    ends.push_back(edge.first);
    ends.push_back(edge.second);
  }
  base::sortUnique(ends);
  const auto indexOf = [&](VertexIndex v) {
    return static_cast<VertexIndex>(std::lower_bound(ends.begin(), ends.end(), v) - ends.begin());
  };
  DisjointSets sets(ends.size());
  for (const Edge& edge : edges) sets.join(indexOf(edge.first), indexOf(edge.second));
  std::size_t loops = 0;
  for (VertexIndex i = 0; i < ends.size(); ++i) loops += sets.root(i) == i ? 1 : 0;
  return loops;
}

/// Numbers the components by their first vertices.
Pieces findLoneComponents(const Faces& faces, const VertexFaces& around) {
  Pieces pieces;
  DisjointSets sets(around.vertexCount());
  for (const Triangle& face : faces.proper) {
    sets.join(face.vertices[0], face.vertices[1]);
    sets.join(face.vertices[0], face.vertices[2]);
  }
  pieces.ofVertex.assign(around.vertexCount(), Pieces::kNone);
  for (VertexIndex v = 0; v < pieces.ofVertex.size(); ++v) {
    if (around.begin(v) == around.end(v)) continue;
    const VertexIndex root = sets.root(v);
    // The root is the smallest vertex of its component, so it is numbered before the others.
    pieces.ofVertex[v] =
        root == v ? static_cast<VertexIndex>(pieces.count++) : pieces.ofVertex[root];
  }
  return pieces;
}

std::vector<PieceCounts> countPieces(const Faces& faces, const std::vector<StarCounts>& stars,
                                     const Pieces& pieces) {
  std::vector<PieceCounts> counts(pieces.count);
  for (VertexIndex v = 0; v < stars.size(); ++v) {
    if (pieces.ofVertex[v] == Pieces::kNone) continue;
    PieceCounts& piece = counts[pieces.ofVertex[v]];
    const StarCounts& star = stars[v];
    if (piece.component.vertices++ == 0) piece.firstVertex = v;
    piece.edges += star.edges;
    if (star.boundaryEdges + star.nonManifoldEdges + star.misorientedEdges > 0 || !star.isFan) {
      piece.closedManifold = false;
    }
  }
  for (const Triangle& face : faces.proper) {
    ++counts[pieces.ofVertex[face.vertices[0]]].component.triangles;
  }
  for (PieceCounts& piece : counts) {
    CheckComponent& component = piece.component;
    component.eulerCharacteristic = static_cast<long long>(component.vertices) - piece.edges +
                                    static_cast<long long>(component.triangles);
    if (piece.closedManifold) component.genus = (2 - component.eulerCharacteristic) / 2;
  }
  return counts;
}

/// Lists the components in the report, largest first, and renumbers `pieces` to match.
void listPieces(const std::vector<PieceCounts>& counts, Pieces& pieces, CheckReport& report) {
  std::vector<VertexIndex> order(counts.size());
  std::iota(order.begin(), order.end(), VertexIndex{0});
  std::stable_sort(order.begin(), order.end(), [&](VertexIndex a, VertexIndex b) {
    return counts[a].component.triangles > counts[b].component.triangles;
  });
  std::vector<VertexIndex> rank(counts.size());
  report.components.reserve(counts.size());
  for (const VertexIndex piece : order) {
    rank[piece] = static_cast<VertexIndex>(report.components.size());
    report.components.push_back(counts[piece].component);
    report.eulerCharacteristic += counts[piece].component.eulerCharacteristic;
  }
  for (VertexIndex& piece : pieces.ofVertex) {
    if (piece != Pieces::kNone) piece = rank[piece];
  }
}

void sumStars(const std::vector<StarCounts>& stars, CheckReport& report) {
  for (const StarCounts& star : stars) {
    report.boundaryEdges += star.boundaryEdges;
    report.nonManifoldEdges += star.nonManifoldEdges;
    report.misorientedEdges += star.misorientedEdges;
    report.duplicateFaces += star.duplicateFaces;
    report.nonManifoldVertices += star.isFan ? 0 : 1;
  }
}

}  // namespace

Pieces analyseTopology(const Faces& faces, base::Job& job, CheckReport& report) {
  const VertexFaces around(faces.proper, faces.positions.size());
  std::vector<Edge> boundaryEdges;
  const std::vector<StarCounts> stars = studyStars(faces.proper, around, job, boundaryEdges);
  sumStars(stars, report);
  report.boundaryLoops = countLoops(std::move(boundaryEdges));

  Pieces pieces = findLoneComponents(faces, around);
  listPieces(countPieces(faces, stars, pieces), pieces, report);

  for (const CheckComponent& component : report.components) report.vertices += component.vertices;
  report.unusedVertices = faces.positionCount - report.vertices;
  report.closed = report.boundaryEdges == 0 && !faces.proper.empty();
  report.manifold = report.nonManifoldEdges == 0 && report.nonManifoldVertices == 0;
  report.oriented = report.misorientedEdges == 0;
  return pieces;
}

}  // namespace tufa::checks
