#pragma once

#include <tufa/mesh.h>
#include <string_view>

namespace tufa::io {

/// Whether single precision would move some position.
[[nodiscard]] bool needsDoublePrecision(const Mesh& mesh);

/// Where a format that stores floats and a translation counts positions from: their middle, in
/// whole floats, or the origin of the world if no position needs that.
[[nodiscard]] Position floatOrigin(const Mesh& mesh);

/// Throws Error(LimitExceeded) for positions that no float is near: what a format of single
/// precision holds, counted from their middle too.
void requireFloatRange(const Mesh& mesh);

/// How far a position moves at most when it is stored as floats counted from `origin`, world units.
/// Throws Error(LimitExceeded), which names the format, where that is more than a twentieth of the
/// edges in the mean, or turns triangles over, but for needles about as thin as a hundredth of
/// them.
[[nodiscard]] double requireFloatsEnough(const Mesh& mesh, const Position& origin,
                                         std::string_view format);

}  // namespace tufa::io
