#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/vec3f.h"
#include "reduce/reduction.h"

namespace tufa::test {

/// A closed triangle mesh as reduce/ takes it.
struct FineMesh {
  std::vector<base::Vec3f> positions;
  std::vector<Triangle> triangles;

  [[nodiscard]] reduce::InputMesh input() const {
    return {base::SharedArray<base::Vec3f>(positions), base::TriangleArray(std::vector(triangles))};
  }
};

/// As it is before it is reduced.
[[nodiscard]] reduce::Surface surfaceOf(const FineMesh& mesh, base::Job& job);

/// As the library's other parts take it.
[[nodiscard]] Mesh toMesh(const std::vector<base::Vec3f>& positions,
                          const std::vector<Triangle>& triangles);

/// A polyhedron with each triangle split into four, so many times.
[[nodiscard]] FineMesh subdivided(FineMesh mesh, int times);

[[nodiscard]] FineMesh tetrahedron(float size);
[[nodiscard]] FineMesh octahedron(float size);
/// An axis-aligned box with a corner at the origin.
[[nodiscard]] FineMesh box(float x, float y, float z);
/// A prism along y over a triangle with this angle (degrees) at the origin.
[[nodiscard]] FineMesh wedge(float length, float degrees, float width);

/// A sphere with bumps of about `height` voxels.
[[nodiscard]] FineMesh bumpySphere(int times, float radius, float height, unsigned seed);

/// The points where f is 0, by marching tetrahedra on a lattice of `size` cells a side, with f > 0
/// forced on its border: closed, manifold and without intersections whatever f is.
[[nodiscard]] FineMesh levelSet(int size, const std::function<double(double, double, double)>& f);

/// Sums of waves with random directions: blobs of a few voxels, tunnels and thin walls.
[[nodiscard]] FineMesh noiseSolid(int size, double wavelength, unsigned seed);

/// Pairs of triangles that intersect elsewhere than in what they share.
[[nodiscard]] std::size_t intersectingPairs(const Mesh& mesh);

/// Edges that turn by more than `degrees` between triangles of at least `leastArea`.
[[nodiscard]] std::size_t folds(const Mesh& mesh, double degrees = 150, double leastArea = 0.05);

/// Smallest angle of a mesh in degrees, and the share of triangles that have one under 10.
struct Angles {
  double smallest = 180;
  double underTen = 0;
};
[[nodiscard]] Angles anglesOf(const Mesh& mesh);

/// The largest distance of random points of `from` (all positions, and so many in the triangles) to
/// `to`, by looking at every triangle.
[[nodiscard]] double sampledDistance(const Mesh& from, const Mesh& to, std::size_t samples);

}  // namespace tufa::test
