#include "reduce/way_back.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_set>

#include "base/sort_unique.h"

namespace tufa::reduce {
namespace {

// Voxels; a larger tolerance is many faces wide.
constexpr float kLarge = 2;

Corners cornersOf(const Surface& s, Index triangle) {
  return {s.corner(triangle, 0), s.corner(triangle, 1), s.corner(triangle, 2)};
}

// From what of a triangle is in a sphere to the nearest of some faces.
float boundTo(const ReferenceMesh& reference, const std::vector<Index>& faces, const Corners& p,
              const Sphere& about, float limit) {
  const auto toFace = [&](Vec3f q, Index f) { return reference.distance(f, q); };
  return Halving(toFace, about, limit).bound(p, faces);
}

}  // namespace

WayBack::WayBack(const Surface& s, const ReferenceMesh& reference, const CornersOfVertices& corners,
                 std::span<const Index> owner, std::span<const Gap> gaps, const Limits& limits,
                 RegionMaxima& regions)
    : s_(s),
      reference_(reference),
      corners_(corners),
      limits_(limits),
      regions_(regions),
      place_(s.triangles.size(), kNone) {
  Index count = 0;
  for (const Gap& gap : gaps) {
    for (const Index t : trianglesAround(s.triangles, corners, {&gap.triangle, 1})) {
      if (place_[t] == kNone) place_[t] = count++;
    }
  }
  owned_.resize(count);
  for (Index r = 0; r < owner.size(); ++r) {
    if (owner[r] != kNone && place_[owner[r]] != kNone) owned_[place_[owner[r]]].push_back(r);
  }
}

void WayBack::fromGaps(std::span<const Gap> gaps, Measured& measured) const {
  const auto [a, b, c] = cornersOf(s_, gaps.front().triangle);
  const float area = length(cross(b - a, c - a)) / 2;
  std::vector<Sphere> spheres;
  Sphere all{{}, 0};
  for (const Gap& gap : gaps) {
    const Corners face = reference_.cornersOf(gap.face);
    Sphere about{(face[0] + face[1] + face[2]) * (1.0f / 3), 0};
    for (const Vec3f& p : face) about.radius = std::max(about.radius, length(p - about.middle));
    about.radius += 2 * limits_.ofFace(gap.face) + kBeyond;
    spheres.push_back(about);
    all.middle = all.middle + about.middle * (1 / static_cast<float>(gaps.size()));
  }
  for (const Sphere& about : spheres) {
    all.radius = std::max(all.radius, length(about.middle - all.middle) + about.radius);
  }
  if (3 * all.radius * all.radius > area) all = {{}, kEverywhere};
  fromGap(gaps.front(), all, measured);
}

// From what of a triangle is in a sphere. With a large tolerance a few of the faces nearby do for
// most, as each of them gives a bound.
void WayBack::fromGap(const Gap& gap, const Sphere& about, Measured& measured) const {
  const Corners p = cornersOf(s_, gap.triangle);
  float back = std::numeric_limits<float>::infinity();
  const float limit = limits_.ofFace(gap.face);
  if (limit >= kLarge) back = boundTo(reference_, someFacesNear(gap, about), p, about, limit);
  if (back > limit) back = boundTo(reference_, allFacesNear(gap, about), p, about, limit);
  regions_.see(gap.triangle, back);
  measured.see(back, gap.face, limit);
}

// Calls f(vertex) for the reference vertices of the triangles around a gap's that are so near a
// sphere that a face there may be the nearest.
template <class F>
void WayBack::forVerticesNear(const Gap& gap, const Sphere& about, F&& f) const {
  const float reach = about.radius + kBeyond + 2 * limits_.ofFace(gap.face) + 1;
  for (const Index t : trianglesAround(s_.triangles, corners_, {&gap.triangle, 1})) {
    for (const Index r : owned_[place_[t]]) {
      if (squaredLength(reference_.positions()[r] - about.middle) <= reach * reach) f(r);
    }
  }
}

std::vector<Index> WayBack::allFacesNear(const Gap& gap, const Sphere& about) const {
  std::vector<Index> faces{gap.face};
  forVerticesNear(gap, about, [&](Index r) {
    reference_.allAround(r, [&](Index f) {
      faces.push_back(f);
      return true;
    });
  });
  base::sortUnique(faces);
  return faces;
}

// One of each cube of a share of the tolerance.
std::vector<Index> WayBack::someFacesNear(const Gap& gap, const Sphere& about) const {
  constexpr float kShare = 0.125f;
  const float perCube = 1 / (kShare * limits_.ofFace(gap.face));
  std::vector<Index> faces{gap.face};
  std::unordered_set<std::uint64_t> seen;
  forVerticesNear(gap, about, [&](Index r) {
    const Vec3f at = (reference_.positions()[r] - about.middle) * perCube;
    std::uint64_t cube = 0;
    for (int axis = 0; axis < 3; ++axis) {
      constexpr float kMiddle = 1 << 20;
      const float cell = std::clamp(std::floor(at[axis]) + kMiddle, 0.0f, 2 * kMiddle - 1);
      cube = cube << 21 | static_cast<std::uint64_t>(cell);
    }
    if (seen.insert(cube).second) faces.push_back(reference_.cornerOf(r) / 3);
  });
  return faces;
}

void measureWayBack(const Surface& s, const ReferenceMesh& reference, const Limits& limits,
                    RegionMaxima& regions, Index triangle, const FacesNear& faces,
                    Measured& measured) {
  const Corners p = cornersOf(s, triangle);
  const std::vector<Index> near = faces.of(p);
  const float limit = limits.ofFace(near.front());
  const float back = boundTo(reference, near, p, {{}, kEverywhere}, limit);
  regions.see(triangle, back);
  measured.see(back, near.front(), limit);
}

}  // namespace tufa::reduce
