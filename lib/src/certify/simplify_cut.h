#pragma once

#include "certify/measured.h"
#include "forest/forest.h"

namespace tufa::certify {

/// Collapses edges of a mesh as far as the rule's tolerance and the topology allow:
/// simplify::collapse(), with the planes of the base vertices that each vertex stands for, then
/// mended, measured, and begun again with less freedom around the vertices that were faulty, until
/// none is. `mesh` may be taken from a cut or be a result itself. The result is no worse than it
/// where that keeps the rule.
///
/// With `triangles`, it stops at so many, and the rule's tolerance is what it begins with: it grows
/// as far as it must, in the rule, too. There may then be points that are farther off.
template <class TreeT>
[[nodiscard]] Measured simplifyCut(const forest::Base<TreeT>& base, const Measured& mesh,
                                   cut::CutRule& rule, std::size_t triangles, const Repair* repair,
                                   Certifier<TreeT>& certifier, base::Job& job);

}  // namespace tufa::certify
