#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "chunks/chain/chunk_chain.h"
#include "chunks/cut/cut_mesh.h"

namespace tufa::chunks {

/// Finds pairs of triangles of one chunk that change in different planes, the first of which, in
/// its form beside the next level, intersects the second one in its own form; and with themselves
/// those that change in two planes. Places in `level.triangles`, sorted. The level must have its
/// `into`. An audit: reduction guards that there are none.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> findMixedForms(const ChainLevel& level,
                                                                       base::Job& job);

/// The plane in which a triangle changes beside the next level, ChunkPlane::kNone if it does not.
/// `isMixed` is set where there are several.
[[nodiscard]] std::uint32_t changingPlane(const ChainLevel& level, const Triangle& triangle,
                                          bool& isMixed);

/// A triangle beside the next level.
[[nodiscard]] inline Triangle changed(const ChainLevel& level, const Triangle& t) {
  return {level.into[t.vertices[0]], level.into[t.vertices[1]], level.into[t.vertices[2]]};
}

/// Whether two of its corners are one.
[[nodiscard]] inline bool isGone(const Triangle& t) {
  const auto& v = t.vertices;
  return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

}  // namespace tufa::chunks
