#include "certify/adapt.h"

namespace tufa::certify {
namespace {

// Forbids the cells of these vertices. Returns whether any could be split.
bool splitCells(const std::vector<VertexIndex>& vertices, const cut::Cut& cut, int minLevel,
                cut::CellFlags& forbidden) {
  bool any = false;
  for (const VertexIndex vertex : vertices) {
    const cut::ClusterRef& ref = cut.clusters[vertex];
    if (ref.level <= minLevel) continue;
    any = true;
    if (ref.level == 1) forbidden.level1[ref.parentCell] |= std::uint64_t{1} << ref.cell;
    if (ref.level == 2) forbidden.level2[ref.parentCell] |= static_cast<std::uint8_t>(1 << ref.cell);
    if (ref.level >= 3) forbidden.levels[ref.level - 3][ref.parentCell] = 1;
  }
  return any;
}

}  // namespace

template <class TreeT>
AdaptiveMesh adapt(const forest::Base<TreeT>& base, const forest::Forest& forest,
                   const cut::CutRule& rule, base::Job& job) {
  const BaseSurface<TreeT> surface(base, forest.levels[0], job);
  const std::function<double(const openvdb::Vec3d&)> tolerance =
      [&rule](const openvdb::Vec3d& point) {
        return rule.scale ? rule.tolerance * rule.scale(point) : rule.tolerance;
      };
  cut::CellFlags forbidden(forest);
  for (int round = 1;; ++round) {
    cut::CellFlags merged = cut::mergeCells(forest, base.topology, rule, forbidden, job);
    const cut::Cut cut = cut::makeCut(forest, base.topology, merged, job);
    polygons::CutMesh made = polygons::meshCut(forest, cut, base.mesh, base.affine, job);
    const Deviation deviation =
        measureDeviation(base, surface, {cut, made.mesh}, tolerance, job);
    if (!splitCells(deviation.coarse, cut, rule.minLevel, forbidden)) {
      return {std::move(made.mesh), std::move(merged), deviation.largest, deviation.mean, round};
    }
  }
}

template AdaptiveMesh adapt(const forest::Base<openvdb::FloatTree>&, const forest::Forest&,
                            const cut::CutRule&, base::Job&);
template AdaptiveMesh adapt(const forest::Base<openvdb::DoubleTree>&, const forest::Forest&,
                            const cut::CutRule&, base::Job&);

}  // namespace tufa::certify
