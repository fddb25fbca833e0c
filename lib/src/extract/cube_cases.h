#pragma once

#include <cstdint>

#include "extract/derive_cube.h"

namespace tufa::extraction {

/// Names a case: the corner mask in the lower eight bits, above them one for each of its ambiguous
/// faces, in the order of the faces, whether it is joined, and above these the number of its
/// tunnel.
using CaseCode = std::uint16_t;

/// The corner mask of a code.
[[nodiscard]] inline CornerMask maskOf(CaseCode code) {
  return static_cast<CornerMask>(code & 0xff);
}

/// The code of a cell. Bits of faces that are not ambiguous mean nothing. `tunnel`: 0 for none, or
/// 1 more than the index of a pair of loops among kTunnelEnds.
[[nodiscard]] CaseCode codeOf(CornerMask mask, FaceBits joined, int tunnel = 0);

/// The faces of a code's mask that are ambiguous and joined.
[[nodiscard]] FaceBits joinedFacesOf(CaseCode code);

/// The triangles of a case, from a table made at compile time.
[[nodiscard]] const CubeCase& caseOf(CaseCode code);

}  // namespace tufa::extraction
