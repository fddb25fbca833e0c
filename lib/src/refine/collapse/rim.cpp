#include "refine/collapse/rim.h"

#include <algorithm>

namespace tufa::refine {
namespace {

// Whether two stretches are neighbours in the same part of a curve.
bool follows(const Rim::Stretch& a, const Rim::Stretch& b) {
  return a.part == b.part && (a.last + 1 == b.first || b.last + 1 == a.first);
}

}  // namespace

void Rim::add(VertexIndex vertex, const Stretch& stretch) {
  if (numbers_.size() <= vertex) numbers_.resize(vertex + 1, kNone);
  std::uint32_t& number = numbers_[vertex];
  if (number == kNone) {
    number = static_cast<std::uint32_t>(stretches_.size());
    stretches_.emplace_back();
  }
  stretches_[number].push_back(stretch);
}

const std::vector<Rim::Stretch>* Rim::find(VertexIndex vertex) const {
  if (vertex >= numbers_.size() || numbers_[vertex] == kNone) return nullptr;
  return &stretches_[numbers_[vertex]];
}

bool Rim::mayJoin(VertexIndex a, VertexIndex b) const {
  const std::vector<Stretch>*of = find(a), *other = find(b);
  if (of == nullptr || other == nullptr) return true;
  // Without a common curve they are at different borders of the surface.
  bool common = false;
  for (const Stretch& stretch : *of) {
    for (const Stretch& beside : *other) {
      if (stretch.curve != beside.curve) continue;
      if (!follows(stretch, beside)) return false;
      common = true;
    }
  }
  return common;
}

void Rim::join(VertexIndex keep, VertexIndex drop) {
  const std::vector<Stretch>* found = find(drop);
  if (found == nullptr) return;
  const std::vector<Stretch> dropped = *found;
  for (const Stretch& stretch : dropped) {
    const std::vector<Stretch>* own = find(keep);
    const auto same = [&](const Stretch& other) { return other.curve == stretch.curve; };
    if (own == nullptr || std::none_of(own->begin(), own->end(), same)) {
      add(keep, stretch);
      continue;
    }
    auto& kept = stretches_[numbers_[keep]];
    Stretch& one = *std::find_if(kept.begin(), kept.end(), same);
    one.first = std::min(one.first, stretch.first);
    one.last = std::max(one.last, stretch.last);
  }
}

}  // namespace tufa::refine
