#pragma once

#include <vector>

#include "certify/certificate.h"
#include "certify/measured.h"
#include "certify/simplify_cut.h"
#include "chunks/seamed_cut.h"
#include "cut/cut_rule.h"
#include "forest/forest.h"

namespace tufa::chunks {

/// Collapses edges of a seamed mesh as far as rule and goal allow, see certify::simplifyCut(). With
/// the vertices beside its seams and on them among the fixed ones, the strips stay what they are.
/// `base` is that of the mesh, `certifier` of `base` and the rule.
template <class TreeT>
[[nodiscard]] SeamedCut collapseInside(const forest::Base<TreeT>& base, const SeamedCut& mesh,
                                       certify::Goal goal, cut::CutRule rule,
                                       const certify::Repair* repair,
                                       certify::Certifier<TreeT>& certifier, base::Job& job);

/// A mesh that shared all but its seams and strips with another one, made to share that with what
/// the other one became by collapseInside().
[[nodiscard]] SeamedCut withInsideOf(const SeamedCut& mesh, const SeamedCut& to);

}  // namespace tufa::chunks
