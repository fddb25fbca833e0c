#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "refine/repair/repair.h"
#include "uniform/vertex_sheets.h"

namespace tufa::refine {

/// A component around a single sample, of eight vertices: its six quads, in rising order.
using LoneComponent = std::array<std::uint32_t, 6>;

/// All of them, by their first quads.
[[nodiscard]] std::vector<LoneComponent> findLoneComponents(const Mesh& mesh, base::Job& job);

/// Unfolds components that a weak field has folded flat or turned inside out, or that have hardly
/// any size, as around a sample on the surface: their vertices go to their mass points, the corners
/// of a box around the sample, or to those of a larger box with the same middle. Returns how many
/// moved.
std::size_t unfoldLoneComponents(Mesh& mesh, const std::vector<LoneComponent>& components,
                                 const Source& source);

/// Moves components that lie on a convex crease of other surface out of it, where they become small
/// boxes beside one of its sheets. Along an acute edge single samples can be inside by a hair, past
/// the end of what the lattice connects: the crease is theirs too, and one of the two has to give
/// way, or they intersect. Returns how many vertices moved.
std::size_t liftLoneComponents(Mesh& mesh, uniform::VertexSheets& sheets,
                               const std::vector<LoneComponent>& components, const Source& source);

}  // namespace tufa::refine
