// Both forms of triangles in a step of lines alone: see formsMeet().

#include <algorithm>
#include <utility>

#include "reduce/part.h"

namespace tufa::reduce {
namespace {

constexpr float kFormGap = 1e-3f;         // voxels between triangles without a common vertex
constexpr float kLeastSine = 1e-3f;       // of the angle between those that share one, about it
constexpr float kFoldedCosine = 0.9999f;  // of that at a common edge: folded onto each other

// Whether a plane through their common vertex, the first of both, certainly parts two triangles,
// but for one edge of each or all of one that may lie in it. All planes that could be the only one
// are tried: of a triangle, across it through one of its edges, and through an edge of each.
bool isSeparatedAtVertex(const std::array<Vec3f, 3>& a, const std::array<Vec3f, 3>& b) {
  const Vec3f p[2] = {unit(a[1] - a[0]), unit(a[2] - a[0])};
  const Vec3f q[2] = {unit(b[1] - b[0]), unit(b[2] - b[0])};
  // Whether the two vectors `in` are on one side of a plane, or on it, and the others on the other.
  const auto parts = [](Vec3f across, const Vec3f* in, const Vec3f* others) {
    const float l = length(across), gap = kLeastSine * l;
    if (!(l > kLeastSine)) return false;
    const float i0 = dot(across, in[0]), i1 = dot(across, in[1]);
    const float o0 = dot(across, others[0]), o1 = dot(across, others[1]);
    return (std::min(i0, i1) > -gap / 8 && std::max(o0, o1) < -gap) ||
           (std::max(i0, i1) < gap / 8 && std::min(o0, o1) > gap);
  };
  const Vec3f n = cross(p[0], p[1]), m = cross(q[0], q[1]);
  for (const Vec3f& across : {n, cross(n, p[0]), cross(n, p[1])}) {
    if (parts(across, p, q)) return true;
  }
  for (const Vec3f& across : {m, cross(m, q[0]), cross(m, q[1])}) {
    if (parts(across, q, p)) return true;
  }
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const Vec3f across = cross(p[i], q[j]);
      const float l = length(across), gap = kLeastSine * l;
      const float own = dot(across, p[1 - i]), other = dot(across, q[1 - j]);
      if (l > kLeastSine && std::min(own, -other) > gap) return true;
      if (l > kLeastSine && std::max(own, -other) < -gap) return true;
    }
  }
  return false;
}

// The first two are the common edge.
bool isFolded(const std::array<Vec3f, 3>& a, const std::array<Vec3f, 3>& b) {
  const Vec3f edge = unit(a[1] - a[0]);
  const auto across = [&](Vec3f p) {
    const Vec3f d = p - a[0];
    return unit(d - edge * dot(d, edge));
  };
  return !(dot(across(a[2]), across(b[2])) < kFoldedCosine);
}

// Whether two triangles may meet elsewhere than in what they share.
bool mayMeet(Form a, Form b) {
  Box3f box = boxOf(a.corners.data());
  box.growBy(kFormGap);
  if (!box.meets(boxOf(b.corners.data()))) return false;
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = shared; j < 3; ++j) {
      if (a.names[i] != b.names[j]) continue;
      std::swap(a.names[i], a.names[shared]), std::swap(a.corners[i], a.corners[shared]);
      std::swap(b.names[j], b.names[shared]), std::swap(b.corners[j], b.corners[shared]);
      ++shared;
      break;
    }
  }
  if (shared == 0) return !planeParts(a.corners.data(), b.corners.data(), kFormGap);
  if (shared == 1) return !isSeparatedAtVertex(a.corners, b.corners);
  return shared == 3 || isFolded(a.corners, b.corners);
}

}  // namespace

// What other parts change while this one works was as it is now, or is foreign and stays, and lies
// in their boxes in both forms.
void Part::loadForms(const Surface& surface) {
  changeOf_.resize(triangleCount_);
  formsOf_.clear();
  for (Index t = 0; t < triangleCount_; ++t) {
    changeOf_[t] = surface.changeOf[triangleIds_[t]];
    if (changeOf_[t] != kNone) formsOf_[region_[t]].changed.push_back(t);
  }
  for (const Index i : partition_->oldForms(number_)) {
    const Form& form = surface.oldForms[i];
    formsOf_[form.region].old.push_back(form);
  }
  for (const Index t : partition_->foreign(number_)) {
    if (surface.changeOf[t] == kNone) continue;
    Form form{{}, {}, surface.region[t], surface.changeOf[t]};
    for (std::size_t i = 0; i < 3; ++i) {
      form.corners[i] = surface.corner(t, i);
      form.names[i] = surface.lineStep[surface.triangles[t].vertices[i]].name;
    }
    formsOf_[form.region].foreign.push_back(form);
  }
}

Form Part::formOf(Index t, Index plane) const {
  Form form{{}, {}, region_[t], plane};
  for (Index i = 0; i < 3; ++i) {
    const Index v = vertex_[3 * t + i];
    form.corners[i] = position_[v], form.names[i] = line_[v].name;
  }
  return form;
}

bool Part::meetsOldForm(const Form& form, const FormsOfRegion& forms) {
  return std::any_of(forms.old.begin(), forms.old.end(), [&](const Form& old) {
    return old.plane != form.plane && mayMeet(form, old);
  });
}

bool Part::meetsNewForm(const Form& form, const FormsOfRegion& forms) const {
  for (const Form& other : forms.foreign) {
    if (other.plane != form.plane && mayMeet(form, other)) return true;
  }
  for (const Index t : forms.changed) {
    if (isDead(t) || changeOf_[t] == form.plane) continue;
    if (mayMeet(form, formOf(t, changeOf_[t]))) return true;
  }
  return false;
}

// Beside chunks of several LODs some triangles of a region are drawn as they were, those that
// change for the sake of one plane, and others as they are. So of two that change in different
// planes, neither may meet the other's old form. The collapse at hand makes new forms of all
// triangles around the vertex that goes, and around the one that stays if it moves; those that have
// not changed before become old forms. Cost: little, as few triangles of a part change in another
// plane.
bool Part::formsMeet(Index kept, Index gone) const {
  const Index plane = planeOfGoing(gone);
  const auto meets = [&](Index t) {
    const auto forms = formsOf_.find(region_[t]);
    if (forms == formsOf_.end()) return false;
    Form form = formOf(t, plane);
    if (changeOf_[t] == kNone && meetsNewForm(form, forms->second)) return true;
    int merged = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (form.names[i] != line_[gone].name && form.names[i] != line_[kept].name) continue;
      form.names[i] = line_[kept].name, form.corners[i] = place_;
      ++merged;
    }
    return merged < 2 && meetsOldForm(form, forms->second);
  };
  for (int i = isMovingKept() ? 0 : split_; i < size_; ++i) {
    if (meets(at_[i] / 3)) return true;
  }
  return meets(left_ / 3) || meets(right_ / 3);
}

// Called while the ring is that of a collapse that will be made.
void Part::noteForms(Index plane) {
  const auto note = [&](Index t) {
    if (changeOf_[t] != kNone) return;
    newForms_.push_back(formOf(t, plane));
    changeOf_[t] = plane;
    FormsOfRegion& forms = formsOf_[region_[t]];
    forms.old.push_back(newForms_.back());
    forms.changed.push_back(t);
  };
  for (int i = isMovingKept() ? 0 : split_; i < size_; ++i) note(at_[i] / 3);
  note(left_ / 3), note(right_ / 3);
}

}  // namespace tufa::reduce
