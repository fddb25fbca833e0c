#pragma once

#include <cstdint>
#include <vector>

#include "refine/collapse/collapse.h"
#include "refine/collapse/edge_mesh.h"

namespace tufa::refine {

/// Which samples belong to each triangle of an EdgeMesh, as linked lists in two arrays.
class SampleLists {
 public:
  SampleLists(std::size_t triangles, std::size_t samples)
      : first_(triangles, kNone), next_(samples), triangles_(samples) {}

  /// The first sample of a triangle, and the one after another; kNone if there is none.
  [[nodiscard]] std::uint32_t front(std::uint32_t t) const { return first_[t / 3]; }
  [[nodiscard]] std::uint32_t after(std::uint32_t sample) const { return next_[sample]; }
  /// The triangle that each sample was attached to last.
  [[nodiscard]] const std::vector<std::uint32_t>& triangles() const { return triangles_; }

  /// Attaches a sample that belongs to no triangle to the front of this one's list.
  void attach(std::uint32_t sample, std::uint32_t t) {
    triangles_[sample] = t;
    next_[sample] = first_[t / 3];
    first_[t / 3] = sample;
  }
  /// Moves a sample of triangle `t`, which follows `before`, to the front.
  void moveToFront(std::uint32_t sample, std::uint32_t before, std::uint32_t t) {
    next_[before] = next_[sample];
    attach(sample, t);
  }
  /// Removes all samples from a triangle.
  void clear(std::uint32_t t) { first_[t / 3] = kNone; }

 private:
  std::vector<std::uint32_t> first_, next_, triangles_;
};

/// The triangle that a sample is nearest to, of those around the corners of its polygon of the mesh
/// as it was `given`.
[[nodiscard]] std::uint32_t locateSample(const EdgeMesh& mesh, const Mesh& given,
                                         const Sample& sample);

}  // namespace tufa::refine
