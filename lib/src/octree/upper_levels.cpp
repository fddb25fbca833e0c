#include "octree/upper_levels.h"

#include <algorithm>

#include "octree/solve_patch.h"

namespace tufa::octree {
namespace {

using uniform::kCorners;

// The result for one cell of the new level.
struct Outcome {
  bool safe = false;
  std::vector<Cluster> clusters;
  std::vector<Patch> patches;
  std::vector<std::uint32_t> parents;  // of the children's clusters, child by child
};

using ChildCells = std::array<std::uint32_t, kCorners>;

// Joins the children of one cell. A child that is not safe ends the branch. Planes move to the
// corner of the new cell, so that coordinates stay small at all levels.
Outcome tryCell(const ClusterLevel& below, const std::vector<Patch>& patches,
                const ChildCells& cells, const grid::Affine& affine, PatchJoiner& joiner) {
  Outcome outcome;
  PatchJoiner::Children children;
  for (int child = 0; child < kCorners; ++child) {
    if (cells[child] == kNone) continue;
    if (below.safe[cells[child]] == 0) return outcome;
    const std::uint32_t first = below.first[cells[child]];
    children[child] = {patches.data() + first, below.first[cells[child] + 1] - first};
  }
  if (!joiner.join(children)) return outcome;
  outcome.safe = true;
  outcome.patches = joiner.patches();
  outcome.parents = joiner.parents();
  const int childSize = 1 << below.level;
  std::size_t next = 0;
  for (int child = 0; child < kCorners; ++child) {
    const Vec3 corner(((child >> 2) & 1) * childSize, ((child >> 1) & 1) * childSize,
                      (child & 1) * childSize);
    for (const Patch& patch : children[child]) {
      Patch& parent = outcome.patches[outcome.parents[next++]];
      parent.planes += patch.planes.translatedTo(-corner);
      parent.cone.add(patch.cone);
    }
  }
  for (const Patch& patch : outcome.patches) {
    outcome.clusters.push_back(solvePatch(patch, Vec3(0), 2 * childSize, affine));
  }
  return outcome;
}

// Finds the cells above those of a level, in the order of their first child, with their children.
std::vector<ChildCells> findCells(ClusterLevel& below, ClusterLevel& above, base::Job& job) {
  std::vector<ChildCells> children;
  below.parentCells.resize(below.cells.size());
  above.table.reserve(below.cells.size());
  for (std::uint32_t i = 0; i < below.cells.size(); ++i) {
    job.pollCancelled(i);
    const Coord& cell = below.cells[i];
    const auto fresh = static_cast<std::uint32_t>(above.cells.size());
    const std::uint32_t own = above.table.tryEmplace(cell >> 1, fresh);
    if (own == fresh) {
      above.cells.push_back(cell >> 1);
      children.emplace_back().fill(kNone);
    }
    below.parentCells[i] = own;
    children[own][(cell[0] & 1) * 4 + (cell[1] & 1) * 2 + (cell[2] & 1)] = i;
  }
  return children;
}

}  // namespace

ClusterLevel buildLevelAbove(ClusterLevel& below, std::vector<Patch>& patches,
                             const grid::Affine& affine, base::Job& job) {
  ClusterLevel above;
  above.level = below.level + 1;
  const std::vector<ChildCells> children = findCells(below, above, job);
  std::vector<Outcome> outcomes(above.cells.size());
  job.forRanges(outcomes.size(), 16, [&](std::size_t begin, std::size_t end) {
    PatchJoiner joiner;
    for (std::size_t i = begin; i < end; ++i) {
      outcomes[i] = tryCell(below, patches, children[i], affine, joiner);
    }
  });
  patches.clear();
  above.safe.resize(outcomes.size());
  above.first.reserve(outcomes.size() + 1);
  for (std::uint32_t i = 0; i < outcomes.size(); ++i) {
    job.pollCancelled(i);
    Outcome& outcome = outcomes[i];
    above.safe[i] = outcome.safe ? 1 : 0;
    const auto first = static_cast<std::uint32_t>(above.clusters.size());
    above.first.push_back(first);
    std::size_t next = 0;
    for (const std::uint32_t child : children[i]) {
      if (!outcome.safe || child == kNone) continue;
      for (std::uint32_t c = below.first[child]; c < below.first[child + 1]; ++c) {
        below.clusters[c].parent = first + outcome.parents[next++];
      }
    }
    for (Cluster& cluster : outcome.clusters) {
      cluster.cell = i;
      above.clusters.push_back(cluster);
    }
    patches.insert(patches.end(), outcome.patches.begin(), outcome.patches.end());
    outcome = {};
  }
  above.first.push_back(static_cast<std::uint32_t>(above.clusters.size()));
  return above;
}

}  // namespace tufa::octree
