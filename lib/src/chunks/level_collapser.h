#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "certify/certificate.h"
#include "certify/simplify_cut.h"
#include "chunks/chunk_cells.h"
#include "chunks/level_mender.h"
#include "chunks/polyline.h"
#include "chunks/seams.h"
#include "chunks/split_chunks.h"
#include "cut/cut_rule.h"
#include "forest/forest.h"

namespace tufa::chunks {

/// Collapses edges of a region's levels, see certify::simplifyCut(). What is on seams stays; what
/// is beside them is joined as rimOf() says, so that strips to any line close the surface.
template <class TreeT>
class LevelCollapser {
 public:
  /// What all levels share; must outlive the collapser.
  struct Region {
    const forest::Base<TreeT>& base;             ///< with the seams' vertices
    const certify::BaseSurface<TreeT>& surface;  ///< of the base
    const std::vector<openvdb::Coord>& cells;    ///< of the base vertices but for the seams'
    const Seams& seams;
    const ChunkCells& chunks;
    const std::vector<std::uint8_t>& beyond;  ///< base quads that no chunk to be made reaches
    const LevelMender& mender;
  };
  /// One level.
  struct Level {
    cut::CutRule rule;
    double nextTolerance;        ///< of the transition mesh, voxels
    const SeamLines& nextLines;  ///< of the transition mesh
    bool alone;                  ///< there is no transition mesh
  };

  LevelCollapser(const Region& region, base::Job& job) : region_(region), job_(job) {}

  /// Collapses the edges of a level's meshes, which are measured then; `certifier` is of the
  /// level's rule. Where that makes a mesh worse it is tried again without what is around, and
  /// given up at last.
  void collapse(LevelMeshes& meshes, const Level& level, const certify::Repair* repair,
                certify::Certifier<TreeT>& certifier) const;

  /// Measures the errors of a level's meshes, of those that have none yet.
  void measure(LevelMeshes& meshes, const Level& level) const;

 private:
  [[nodiscard]] std::vector<std::uint8_t> findOwn(const SeamedCut& mesh) const;
  [[nodiscard]] certify::Goal goalFor(const SeamedCut& mesh,
                                      std::vector<std::uint8_t>& fixed) const;
  [[nodiscard]] SeamedCut collapse(const SeamedCut& mesh, const certify::Goal& goal,
                                   cut::CutRule rule, const certify::Repair* repair,
                                   certify::Certifier<TreeT>& certifier) const;
  [[nodiscard]] std::vector<std::uint8_t> findWorse(LevelMeshes& before, const LevelMeshes& now,
                                                    const Level& level) const;

  Region region_;
  base::Job& job_;
};

}  // namespace tufa::chunks
