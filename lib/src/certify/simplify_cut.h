#pragma once

#include "certify/measured.h"
#include "forest/forest.h"

namespace tufa::certify {

/// Collapses edges of a mesh taken from a cut as far as the rule's tolerance and the topology
/// allow: simplify::collapse(), with the planes of the base vertices that each vertex stands for,
/// then mended, measured, and begun again with less freedom around the vertices that were faulty,
/// until none is. The certifier's rule must be `rule`. The result is no worse than `mesh` where
/// that keeps the rule.
template <class TreeT>
[[nodiscard]] Measured simplifyCut(const forest::Base<TreeT>& base, const Measured& mesh,
                                   const cut::CutRule& rule, const Repair* repair,
                                   Certifier<TreeT>& certifier, base::Job& job);

}  // namespace tufa::certify
