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

/// Collapses edges of a region's levels, see refine::simplifyCut(). What is on seams stays; what
/// is beside them is joined as rimOf() says, so that strips to any line close the surface.
class LevelCollapser {
 public:
  /// What all levels share; must outlive the collapser.
  struct Region {
    const uniform::SurfaceView base;            ///< with the seams' vertices
    const distance::UniformReference& surface;  ///< of the base
    const std::vector<Coord>& cells;            ///< of the base vertices but for the seams'
    const Seams& seams;
    const ChunkCells& chunks;
    const std::vector<std::uint8_t>& beyond;  ///< base quads that no chunk to be made reaches
    const LevelRepairer& repairer;
  };
  /// One level.
  struct Level {
    octree::CutRule rule;
    double nextTolerance;            ///< of the transition mesh, voxels
    const SeamPolylines& nextLines;  ///< of the transition mesh
    bool alone;                      ///< there is no transition mesh
  };

  LevelCollapser(const Region& region, base::Job& job) : region_(region), job_(job) {}

  /// Collapses the edges of a level's meshes, which are measured then; `certifier` is of the
  /// level's rule. Where that makes a mesh worse it is tried again without what is around, and
  /// given up at last.
  void collapse(LevelMeshes& meshes, const Level& level, const refine::Repair* repair,
                distance::Certifier& certifier) const;

  /// Measures the errors of a level's meshes, of those that have none yet.
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
