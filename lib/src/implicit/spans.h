#pragma once

#include <tufa/implicit.h>

#include <cstddef>
#include <vector>

// Parts of a line as sorted ranges that lie apart (Roth 1982). Each function works on the ranges
// from `first` on, so that parts of a tree share one list.

namespace tufa::implicit {

using Spans = std::vector<Interval>;

/// Appends where a t^2 + 2 b t + c is below 0. `discriminant` is b^2 - a c, which callers may know
/// more exactly.
void appendBelow0(double a, double b, double c, double discriminant, Spans& spans);
/// Appends where |a t + b| is below `half`.
void appendSlab(double a, double b, double half, Spans& spans);
/// Appends where a t + b is below 0.
void appendHalf(double a, double b, Spans& spans);

/// Makes sorted ranges that lie apart of any.
void uniteFrom(Spans& spans, std::size_t first);
/// What lies in none of them.
void complementFrom(Spans& spans, std::size_t first);
/// Takes away ranges, and gaps between them, that are no longer than `length`.
void dropShort(Spans& spans, double length);

}  // namespace tufa::implicit
