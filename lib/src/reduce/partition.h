#pragma once

#include <span>
#include <vector>

#include "base/group.h"
#include "base/job.h"
#include "reduce/box3f.h"
#include "reduce/part_tree.h"
#include "reduce/surface.h"

namespace tufa::reduce {

/// The k-d parts of a surface that a phase works on one by one, in parallel.
///
/// Parts cannot disturb each other. A part moves vertices only strictly inside its box, and changes
/// only triangles with all corners in the box, those it owns. Triangles of several parts stay as
/// they are while the phase lasts, and every part knows those that reach into its box, the foreign
/// ones. So surface that two parts change cannot meet, and the order of the parts does not show in
/// the result.
class Partition {
 public:
  /// Parts as splitIntoParts() makes them. Depends on the surface alone.
  void build(const Surface& surface, const PartSize& size, float share, base::Job& job);

  /// The tree of the parts.
  [[nodiscard]] const std::vector<PartTree::Node>& tree() const { return tree_.nodes; }
  /// Cuts as a tree did, wherever the vertices are: so what changes in one place of a surface does
  /// not change the parts elsewhere.
  void build(const Surface& surface, const std::vector<PartTree::Node>& tree, base::Job& job);

  [[nodiscard]] std::size_t size() const { return tree_.size(); }
  [[nodiscard]] const Box3f& box(Index part) const { return tree_.boxes[part]; }
  /// Vertices of a part, in rising order. Numbers in the part are places in these lists.
  [[nodiscard]] std::span<const Index> vertices(Index p) const {
    return of(tree_.vertices, tree_.ranges, p);
  }
  /// Triangles with all corners in a part, in rising order.
  [[nodiscard]] std::vector<Index> triangles(Index p) const {
    std::vector<Index> all;
    forTriangles(p, [&](Index t) { all.push_back(t); });
    return all;
  }
  /// Triangles of several parts that reach into the box of a part.
  [[nodiscard]] std::span<const Index> foreign(Index p) const {
    return of(foreign_.members, foreign_.first, p);
  }
  /// Those of Surface::oldForms that reach into the box of a part, in rising order.
  [[nodiscard]] std::span<const Index> oldForms(Index p) const {
    return of(forms_.members, forms_.first, p);
  }
  /// Triangles of several parts, in rising order.
  [[nodiscard]] std::span<const Index> acrossParts() const { return across_; }
  /// Reference vertices whose owners are triangles of a part; where these have several, those of a
  /// triangle together. Not of a surface that is whole, where they are at the part's vertices.
  [[nodiscard]] std::span<const Index> samples(Index p) const {
    return of(samples_.members, samples_.first, p);
  }
  [[nodiscard]] Index partOf(Index vertex) const { return partOf_[vertex]; }
  /// Numbers in their part. That of a reference vertex means nothing if its owner is in none. Of a
  /// surface that is whole there are those of vertices alone.
  [[nodiscard]] Index localVertex(Index vertex) const { return localVertex_[vertex]; }
  [[nodiscard]] Index localTriangle(Index triangle) const { return localTriangle_[triangle]; }
  [[nodiscard]] Index localSample(Index sample) const { return localSample_[sample]; }
  /// Whether all triangles at a vertex are triangles of its part, and none of its edges is open.
  [[nodiscard]] bool isInner(Index vertex) const { return inner_[vertex] != 0; }
  /// The share of the vertices that are inner ones.
  [[nodiscard]] float innerShare() const;

  /// f(part) for each part that a box reaches into.
  template <class F>
  void forPartsAt(const Box3f& box, F&& f, Index node = 0) const {
    const PartTree::Node& n = tree_.nodes[node];
    if (n.axis < 0) return void(f(n.low));
    if (box.lower[n.axis] <= n.at) forPartsAt(box, f, n.low);
    if (box.upper[n.axis] >= n.at) forPartsAt(box, f, n.high);
  }

 private:
  /// Triangles of a part one behind the other: most are, as neighbours mostly are neighbours in the
  /// order of triangles too.
  struct Run {
    Index begin, end;
  };
  template <class T>
  static std::span<const T> of(const std::vector<T>& all, const std::vector<Index>& first,
                               Index part) {
    return {all.data() + first[part], all.data() + first[part + 1]};
  }
  template <class F>
  void forTriangles(Index p, const F& f) const {
    for (const Run& run : of(runs_, firstRun_, p)) {
      for (Index t = run.begin; t < run.end; ++t) f(t);
    }
  }
  [[nodiscard]] static std::vector<Index> samplesAtVertices(const Surface& surface, base::Job& job);
  void share(const Surface& surface, base::Job& job);
  void numberVertices(base::Job& job);
  /// That of all its corners, or kNone.
  [[nodiscard]] Index partOfTriangle(const Triangle& triangle) const {
    const auto& v = triangle.vertices;
    const Index part = partOf_[v[0]];
    return part == partOf_[v[1]] && part == partOf_[v[2]] ? part : kNone;
  }
  void shareTriangles(const Surface& surface, base::Job& job);
  void findRuns(const Surface& surface, base::Job& job);
  void shareForms(const Surface& surface, base::Job& job);
  void shareSamples(const Surface& surface, base::Job& job);
  void sortSamples(const Surface& surface, Index part, std::vector<Index>& next,
                   std::vector<Index>& sorted);

  PartTree tree_;
  std::vector<Index> partOf_, localVertex_;
  std::vector<Index> localTriangle_, localSample_;
  std::vector<Run> runs_;
  std::vector<Index> firstRun_;  ///< of each part
  base::Groups foreign_, forms_, samples_;
  std::vector<Index> across_;
  std::vector<std::uint8_t> inner_;
};

}  // namespace tufa::reduce
