#include "implicit/spans.h"

#include <algorithm>
#include <cmath>

#include "implicit/interval.h"

namespace tufa::implicit {

void appendHalf(double a, double b, Spans& spans) {
  const double root = -b / a;
  if (a > 0) {
    spans.push_back({-kInfinity, root});
  } else if (a < 0) {
    spans.push_back({root, kInfinity});
  } else if (b < 0) {
    spans.push_back(everything());
  }
}

void appendSlab(double a, double b, double half, Spans& spans) {
  if (a == 0) {
    if (std::abs(b) < half) spans.push_back(everything());
    return;
  }
  const double one = (-half - b) / a;
  const double other = (half - b) / a;
  spans.push_back({std::min(one, other), std::max(one, other)});
}

void appendBelow0(double a, double b, double c, double discriminant, Spans& spans) {
  if (a == 0) {
    appendHalf(2 * b, c, spans);
    return;
  }
  if (!(discriminant > 0)) {
    if (a < 0) spans.push_back(everything());
    return;
  }
  // The sum of two numbers of one sign loses nothing; the other root is by the product of both.
  const double sum = -(b + std::copysign(std::sqrt(discriminant), b));
  const double one = sum / a;
  const double other = c / sum;
  const double least = std::min(one, other);
  const double greatest = std::max(one, other);
  if (a > 0) {
    spans.push_back({least, greatest});
  } else {
    spans.push_back({-kInfinity, least});
    spans.push_back({greatest, kInfinity});
  }
}

void uniteFrom(Spans& spans, std::size_t first) {
  const auto begin = spans.begin() + static_cast<std::ptrdiff_t>(first);
  if (spans.end() - begin < 2) return;
  std::sort(begin, spans.end(), [](const Interval& a, const Interval& b) {
    return a.least != b.least ? a.least < b.least : a.greatest < b.greatest;
  });
  auto last = begin;
  for (auto next = begin + 1; next != spans.end(); ++next) {
    if (next->least <= last->greatest) {
      last->greatest = std::max(last->greatest, next->greatest);
    } else {
      *++last = *next;
    }
  }
  spans.erase(last + 1, spans.end());
}

void complementFrom(Spans& spans, std::size_t first) {
  // Each range becomes the gap before it; the one behind the last is new.
  double end = -kInfinity;
  std::size_t kept = first;
  for (std::size_t n = first; n < spans.size(); ++n) {
    const Interval span = spans[n];
    if (end < span.least) spans[kept++] = {end, span.least};
    end = span.greatest;
  }
  spans.resize(kept);
  if (end < kInfinity) spans.push_back({end, kInfinity});
}

void dropShort(Spans& spans, double length) {
  std::size_t kept = 0;
  for (const Interval span : spans) {
    if (!(span.greatest - span.least > length)) continue;
    if (kept > 0 && !(span.least - spans[kept - 1].greatest > length)) {
      spans[kept - 1].greatest = span.greatest;
    } else {
      spans[kept++] = span;
    }
  }
  spans.resize(kept);
}

}  // namespace tufa::implicit
