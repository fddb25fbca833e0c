#pragma once

#include <tufa/mesh.h>

#include <array>
#include <vector>

#include "base/job.h"
#include "base/triangle_array.h"
#include "base/vec3.h"
#include "base/vec3f.h"

namespace tufa::refine {

/// Positions of a mesh in single precision: in voxels, counted from the mesh's middle. Where
/// nothing lies between two planes across an axis for long, as between pieces of a mesh or beside
/// one stray particle, space is taken out; no piece is bent by that, and pieces stay apart.
class LocalFrame {
 public:
  LocalFrame() = default;
  /// Of a mesh whose edges longer than some voxels are all of these triangles. Cost: a pass over
  /// the positions, and one more and one over the triangles if they reach farther than 8192 voxels.
  LocalFrame(const std::vector<Position>& positions, double voxelSize, base::Job& job,
             const base::TriangleView& longTriangles = {});

  [[nodiscard]] base::Vec3f toLocal(const Position& p) const {
    return base::Vec3f((hasVoids_ ? moved(Vec3(p), voids_, -1) : Vec3(p) - middle_) * perVoxel_);
  }
  [[nodiscard]] Position toExact(const base::Vec3f& local) const {
    const Vec3 p = moved(middle_ + Vec3(local) * voxelSize_, closedVoids_, 1);
    return {p[0], p[1], p[2]};
  }

  /// The diagonal of the mesh's box, voxels.
  [[nodiscard]] double size() const { return size_; }
  /// How much farther from each other two meshes may be than in single precision, voxels; 0 where
  /// that is so little as other rounding.
  [[nodiscard]] double rounding() const { return rounding_; }
  /// A tolerance in the frame that keeps another one outside of it, voxels; 0 if none does.
  [[nodiscard]] double within(double tolerance) const;

 private:
  /// Space that is taken out: what lies above is moved.
  struct Void {
    double at;  ///< a coordinate in it
    double by;  ///< how far all above is moved down, with what voids below have moved it
  };
  using Voids = std::array<std::vector<Void>, 3>;

  [[nodiscard]] Vec3 moved(Vec3 p, const Voids& voids, double direction) const;
  void findVoids(const std::vector<Position>& positions, const base::TriangleView& longTriangles,
                 int axis, double lower, base::Job& job);

  Vec3 middle_{0.0};  ///< once voids are out
  double voxelSize_ = 1, perVoxel_ = 1;
  double size_ = 0;
  double rounding_ = 0;
  bool isTooLarge_ = false;
  bool hasVoids_ = false;
  Voids voids_;        ///< rising; their places in the mesh
  Voids closedVoids_;  ///< and once they are taken out
};

}  // namespace tufa::refine
