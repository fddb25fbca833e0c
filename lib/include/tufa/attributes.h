#pragma once

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <optional>
#include <span>
#include <string>

namespace tufa {

/// Options of sampleAttribute().
struct AttributeOptions {
  std::optional<std::string> name;            ///< unset: the grid's
  AttributeRole role = AttributeRole::Value;  ///< Colour and Motion: of a grid of vectors
  /// All values are multiplied by it: with Motion, and velocities in world units per second, the
  /// seconds that the positions move.
  double factor = 1;
  int threads = 0;  ///< most threads; 0: as many as the TBB arena allows. Never changes the result.
};

/// Samples a grid at the vertices of a mesh, trilinearly between its voxels, at their places in
/// world space: one float each of a grid of numbers or booleans, three of a grid of vectors, as
/// they are in the grid but for AttributeOptions::factor. The components of a staggered grid are
/// those at the faces of voxels. Values that are not finite become 0, finite ones beyond the range
/// of float the largest float. Masks count as booleans. Add the result to Mesh::attributes to have
/// it written.
///
/// The grid needs neither the lattice nor the transform of the one that was meshed. Throws Error:
/// UnsupportedGrid (values of another type, a transform that is not linear), InvalidArgument (no
/// name, a colour or a motion of numbers, a factor that is not finite).
[[nodiscard]] TUFA_API Attribute sampleAttribute(const Mesh& mesh, const openvdb::GridBase& grid,
                                                 const AttributeOptions& options = {});

/// The same at any positions in world space, such as those of a ChunkLevel.
[[nodiscard]] TUFA_API Attribute sampleAttribute(std::span<const Position> positions,
                                                 const openvdb::GridBase& grid,
                                                 const AttributeOptions& options = {});

}  // namespace tufa
