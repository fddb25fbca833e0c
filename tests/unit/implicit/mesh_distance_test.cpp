// Distances to meshes, by brute force and by the solid angle that a mesh is seen under.

#include <gtest/gtest.h>
#include <tufa/rays.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "base/flat_triangle.h"
#include "implicit/boxes.h"
#include "implicit/mesh_distance.h"
#include "support/expect_error.h"
#include "unit/implicit/field_list.h"

namespace tufa {
namespace {

using implicit::FieldPtr;
using implicit::makeMeshSheet;
using implicit::makeMeshSolid;
using test::expectError;
using test::spikes;

class Points {
 public:
  Vec3 next(double reach) {
    const auto one = [&] { return (static_cast<double>(random_()) / 2147483647.5 - 1) * reach; };
    const double x = one();
    const double y = one();
    return {x, y, one()};
  }

 private:
  std::mt19937 random_{7};
};

std::array<Vec3, 3> cornersOf(const Mesh& mesh, const Triangle& t) {
  return {mesh.positions[t.vertices[0]], mesh.positions[t.vertices[1]],
          mesh.positions[t.vertices[2]]};
}

double unsignedDistance(const Mesh& mesh, const Vec3& p) {
  double least = implicit::kInfinity;
  for (const Triangle& t : triangulate(mesh)) {
    const auto [a, b, c] = cornersOf(mesh, t);
    least = std::min(least, base::squaredDistanceTo(p, a, b, c));
  }
  return std::sqrt(least);
}

/// How often a closed mesh goes around a point (Van Oosterom and Strackee 1983).
double windingNumber(const Mesh& mesh, const Vec3& p) {
  double angle = 0;
  for (const Triangle& t : triangulate(mesh)) {
    const auto corners = cornersOf(mesh, t);
    const Vec3 a = corners[0] - p, b = corners[1] - p, c = corners[2] - p;
    const double la = a.length(), lb = b.length(), lc = c.length();
    angle += 2 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

Mesh boxMesh(const Vec3& half) {
  Mesh mesh;
  for (int n = 0; n < 8; ++n) {
    mesh.positions.push_back(Vec3((n & 1) != 0 ? half[0] : -half[0],
                                  (n & 2) != 0 ? half[1] : -half[1],
                                  (n & 4) != 0 ? half[2] : -half[2]));
  }
  mesh.quads.resize(6);
  mesh.quads[0].vertices = {0, 2, 3, 1};
  mesh.quads[1].vertices = {4, 5, 7, 6};
  mesh.quads[2].vertices = {0, 1, 5, 4};
  mesh.quads[3].vertices = {2, 6, 7, 3};
  mesh.quads[4].vertices = {0, 4, 6, 2};
  mesh.quads[5].vertices = {1, 3, 7, 5};
  return mesh;
}

TEST(MeshDistance, IsThatByBruteForce) {
  const Mesh mesh = spikes();
  const FieldPtr solid = makeMeshSolid(mesh);
  const FieldPtr sheet = makeMeshSheet(mesh, 0.3);
  Points points;
  int inside = 0;
  for (int n = 0; n < 4000; ++n) {
    const Vec3 p = points.next(1.2);
    const double distance = unsignedDistance(mesh, p);
    const bool in = windingNumber(mesh, p) > 0.5;
    inside += in ? 1 : 0;
    ASSERT_NEAR(solid->value(p), in ? -distance : distance, 1e-12);
    ASSERT_NEAR(sheet->value(p), distance - 0.15, 1e-12);
  }
  EXPECT_GT(inside, 300);
  // Vertices, and the middles of edges.
  for (const Triangle& t : mesh.triangles) {
    const auto [a, b, c] = cornersOf(mesh, t);
    ASSERT_NEAR(solid->value(a), 0, 1e-15);
    ASSERT_NEAR(solid->value((a + b) * 0.5), 0, 1e-15);
    ASSERT_NEAR(Vec3(solid->gradient((b + c) * 0.5)).length(), 1, 1e-12);
  }
}

/// The same surface, with corners on the first edge of each face, which triangles without area join
/// to the face beyond. That may have them in the same places, or `shift` farther on.
Mesh withCornersOnEdges(Mesh mesh, double shift) {
  const std::vector<Triangle> before = mesh.triangles;
  mesh.triangles.clear();
  for (std::size_t n = 0; n < before.size(); ++n) {
    const auto [a, b, c] = before[n].vertices;
    VertexIndex last = a;
    const std::size_t corners = n % 4;
    for (std::size_t k = 1; k <= corners; ++k) {
      const double share = (static_cast<double>(k) - shift) / static_cast<double>(corners + 1);
      const auto next = static_cast<VertexIndex>(mesh.positions.size());
      mesh.positions.push_back(Vec3(mesh.positions[a]) * (1 - share) +
                               Vec3(mesh.positions[b]) * share);
      mesh.triangles.emplace_back(last, next, c);
      if (last != a) mesh.triangles.emplace_back(a, next, last);
      last = next;
    }
    mesh.triangles.emplace_back(last, b, c);
    if (last != a) mesh.triangles.emplace_back(a, b, last);
  }
  return mesh;
}

/// It had the wrong sign beside edges of faces without area: these have no normal.
TEST(MeshDistance, FacesWithoutAreaChangeNothing) {
  const Mesh mesh = spikes();
  const FieldPtr one = makeMeshSolid(mesh);
  for (const double shift : {0.0, 0.4}) {
    const Mesh cut = withCornersOnEdges(mesh, shift);
    EXPECT_GT(cut.triangles.size(), 2 * mesh.triangles.size());
    const FieldPtr other = makeMeshSolid(cut);
    Points points;
    for (int n = 0; n < 4000; ++n) {
      const Vec3 p = points.next(1.2);
      ASSERT_NEAR(one->value(p), other->value(p), 1e-12);
    }
    // Beside the edges themselves.
    for (const Triangle& t : cut.triangles) {
      const auto [a, b, c] = cornersOf(cut, t);
      for (const Vec3& at : {a, (a + b) * 0.5, (b + c) * 0.5}) {
        for (int n = 0; n < 20; ++n) {
          const Vec3 p = at + points.next(0.2);
          ASSERT_NEAR(one->value(p), other->value(p), 1e-12);
        }
      }
    }
  }
}

/// A double pyramid, the tip of which is one corner for each face, in a polygon of that radius.
Mesh pyramids(double tipRadius) {
  constexpr int kSides = 7;
  Mesh mesh;
  mesh.positions.emplace_back(0, 0, -0.3);
  const auto ring = [](int k) { return static_cast<VertexIndex>(1 + k % kSides); };
  const auto tip = [](int k) { return static_cast<VertexIndex>(1 + kSides + k % kSides); };
  for (const double radius : {1.0, tipRadius}) {
    for (int k = 0; k < kSides; ++k) {
      const double angle = 2 * std::numbers::pi * k / kSides;
      mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                                  radius < 1 ? 3 : 0);
    }
  }
  for (int k = 0; k < kSides; ++k) {
    mesh.triangles.emplace_back(ring(k + 1), ring(k), 0);
    mesh.triangles.emplace_back(ring(k), ring(k + 1), tip(k));
    mesh.triangles.emplace_back(tip(k), ring(k + 1), tip(k + 1));
    if (k > 1) mesh.triangles.emplace_back(tip(0), tip(k - 1), tip(k));
  }
  return mesh;
}

TEST(MeshDistance, CornersBesideEachOtherAreOne) {
  const FieldPtr small = makeMeshSolid(pyramids(1e-9));
  for (const double radius : {0.0, 1e-16, 1e-14}) {
    const FieldPtr none = makeMeshSolid(pyramids(radius));
    Points points;
    for (int n = 0; n < 2000; ++n) {
      const Vec3 p = points.next(n % 2 == 0 ? 1.2 : 0.3) + Vec3(0, 0, n % 2 == 0 ? 0 : 3);
      ASSERT_NEAR(small->value(p), none->value(p), 3e-9) << radius;
    }
  }
}

TEST(MeshDistance, OfABoxIsThatOfTheBox) {
  const Vec3 half(0.5, 0.7, 0.3);
  const FieldPtr box = implicit::makeBox({0, 0, 0}, half, 0);
  const FieldPtr mesh = makeMeshSolid(boxMesh(half));
  Points points;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p = points.next(1);
    ASSERT_NEAR(mesh->value(p), box->value(p), 1e-14);
  }
  EXPECT_EQ(mesh->extent().greatest, Position(half));
}

// A normal shorter than 1e-7 was taken for none.
TEST(MeshDistance, OfATinyBoxIsThatOfTheBox) {
  const double size = 1e-6;
  const Vec3 half = Vec3(0.5, 0.7, 0.3) * size;
  const FieldPtr box = implicit::makeBox({0, 0, 0}, half, 0);
  const FieldPtr mesh = makeMeshSolid(boxMesh(half));
  Points points;
  for (int n = 0; n < 500; ++n) {
    const Vec3 p = points.next(1) * size;
    ASSERT_NEAR(mesh->value(p), box->value(p), 1e-14 * size);
  }
}

/// As an .stl has them: each face with corners of its own.
TEST(MeshDistance, VerticesInOnePlaceAreOne) {
  const Mesh mesh = spikes();
  Mesh apart;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<VertexIndex>(apart.positions.size());
    for (const VertexIndex v : t.vertices) apart.positions.push_back(mesh.positions[v]);
    apart.triangles.emplace_back(first, first + 1, first + 2);
  }
  const FieldPtr one = makeMeshSolid(mesh);
  const FieldPtr other = makeMeshSolid(apart);
  Points points;
  for (int n = 0; n < 500; ++n) {
    const Vec3 p = points.next(1.2);
    ASSERT_NEAR(one->value(p), other->value(p), 1e-15);
  }
}

TEST(MeshDistance, RaysMeetTheTriangles) {
  const Mesh mesh = spikes();
  const auto field = makeRaySurface(makeMeshSolid(mesh));
  const auto triangles = makeRaySurface(mesh);
  Points points;
  int hits = 0;
  for (int n = 0; n < 3000; ++n) {
    const Vec3 from = points.next(n % 3 == 0 ? 0.4 : 2);
    // At vertices and at middles of edges, too.
    const Triangle& t = mesh.triangles[n % mesh.triangles.size()];
    const auto [a, b, c] = cornersOf(mesh, t);
    const Vec3 aim = n % 5 == 0 ? a : n % 5 == 1 ? (a + b) * 0.5 : points.next(1);
    const auto one = castRay(*field, {from, aim - from});
    const auto other = castRay(*triangles, {from, aim - from});
    if (one.has_value() != other.has_value()) {
      // A ray that touches the mesh in a vertex or an edge does not change sides.
      ASSERT_LT(n % 5, 2) << n;
      continue;
    }
    if (!one) continue;
    ++hits;
    if (n % 5 < 2) continue;
    ASSERT_NEAR(one->distance, other->distance, 1e-9) << n;
  }
  EXPECT_GT(hits, 1500);
}

/// Where bounds must tell: the sheet has no closed form.
TEST(MeshDistance, RaysMeetTheSheet) {
  const Mesh mesh = spikes();
  const FieldPtr sheet = makeMeshSheet(mesh, 0.1);
  const auto surface = makeRaySurface(sheet);
  Points points;
  int hits = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec3 from = points.next(2);
    const Vec3 aim = points.next(0.5);
    const auto hit = castRay(*surface, {from, aim - from});
    // Steps no longer than the distance pass nothing.
    const Vec3 direction = (aim - from).unitOrX();
    const double side = sheet->value(from) < 0 ? -1 : 1;
    double t = 0;
    while (t < 5 && side * sheet->value(from + direction * t) > 1e-10) {
      t += side * sheet->value(from + direction * t);
    }
    ASSERT_EQ(hit.has_value(), t < 5) << n;
    if (!hit) continue;
    ++hits;
    ASSERT_NEAR(hit->distance, t, 1e-6) << n;
  }
  EXPECT_GT(hits, 200);
}

TEST(MeshDistance, RefusesMeshesWithoutASide) {
  const auto refused = [](const Mesh& mesh, const std::string& part) {
    expectError(ErrorCode::InvalidArgument, part, [&] { static_cast<void>(makeMeshSolid(mesh)); });
  };
  refused({}, "has no faces");
  Mesh mesh = spikes();
  mesh.triangles.pop_back();
  refused(mesh, "3 edges of one face: it is open");
  EXPECT_LT(makeMeshSheet(mesh, 0.1)->value({1, 0, 0}), 0);
  mesh = spikes();
  mesh.triangles.push_back(mesh.triangles[0]);
  refused(mesh, "3 edges of more than two faces");
  mesh = spikes();
  std::swap(mesh.triangles[0].vertices[0], mesh.triangles[0].vertices[1]);
  refused(mesh, "3 edges whose two faces turn both ways");
  mesh = spikes();
  for (Triangle& t : mesh.triangles) std::swap(t.vertices[0], t.vertices[1]);
  refused(mesh, "faces inward");
  mesh = {};
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {2, 1, 0}};
  refused(mesh, "enclose a line or a point");
  mesh.positions = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  refused(mesh, "enclose a line or a point");
  mesh = spikes();
  mesh.positions[2].y = std::nan("");
  refused(mesh, "vertex 2 of the mesh is not finite");
  mesh = spikes();
  mesh.triangles[3].vertices[1] = 99;
  refused(mesh, "a face names vertex 99");
}

}  // namespace
}  // namespace tufa
