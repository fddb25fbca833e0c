#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "chunks/levels/level_repairer.h"
#include "chunks/levels/split_chunks.h"
#include "chunks/seams/chunk_cells.h"
#include "chunks/seams/polyline.h"
#include "chunks/seams/seams.h"
#include "distance/certifier.h"
#include "octree/cluster_forest.h"
#include "octree/cut_rule.h"
#include "refine/simplify_cut.h"

namespace tufa::chunks {

/// Collapses edges of a region's LODs, see refine::simplifyCut(). Vertices on seams stay; those
/// beside seams are joined only as rimOf() allows, so that strips to any polyline close the
/// surface.
class LevelCollapser {
 public:
  /// What all LODs share; must outlive this object.
  struct Region {
    const uniform::SurfaceView base;            ///< with the seams' vertices
    const distance::UniformReference& surface;  ///< of the uniform mesh
    const std::vector<Coord>& cells;            ///< of the uniform vertices but for the seams'
    const Seams& seams;
    const ChunkCells& chunks;
    const std::vector<std::uint8_t>& beyond;  ///< uniform quads that no chunk to be made reaches
    const LevelRepairer& repairer;
  };
  /// One LOD.
  struct Level {
    octree::CutRule rule;
    double nextTolerance;            ///< of the transition mesh, voxels
    const SeamPolylines& nextLines;  ///< of the transition mesh
    bool alone;                      ///< there is no transition mesh
  };

  LevelCollapser(const Region& region, base::Job& job) : region_(region), job_(job) {}

  /// Collapses the edges of an LOD's meshes and measures them; `certifier` has the LOD's rule.
  /// Where a mesh has more pairs than before, or a larger error than both the tolerance and before,
  /// the surroundings are fixed and all is tried again, twice as far each time; in the end nothing
  /// is collapsed.
  void collapse(LevelMeshes& meshes, const Level& level, const refine::Repair* repair,
                distance::Certifier& certifier) const;

  /// Measures the errors of those of an LOD's meshes that have none yet.
  void measure(LevelMeshes& meshes, const Level& level) const;

 private:
  [[nodiscard]] std::vector<std::uint8_t> findOwn(const SeamedCut& mesh) const;
  [[nodiscard]] refine::Goal goalFor(const SeamedCut& mesh, std::vector<std::uint8_t>& fixed) const;
  [[nodiscard]] SeamedCut collapse(const SeamedCut& mesh, const refine::Goal& goal,
                                   octree::CutRule rule, const refine::Repair* repair,
                                   distance::Certifier& certifier) const;
  [[nodiscard]] std::vector<std::uint8_t> findWorse(LevelMeshes& before, const LevelMeshes& now,
                                                    const Level& level) const;

  Region region_;
  base::Job& job_;
};

}  // namespace tufa::chunks
