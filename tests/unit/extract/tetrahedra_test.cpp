// The four splits of cells into tetrahedra, and the surface of the piecewise linear interpolant.

#include "extract/derive_tetrahedra.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/extract.h>
#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "base/vec3.h"
#include "support/fields.h"
#include "support/mesh_oracle.h"

namespace tufa::extraction {
namespace {

using openvdb::FloatGrid;

/// Three corners of a tetrahedron on a face of the cell, by their places.
using FaceTriangles = std::set<std::set<HalfPlace>>;

template <std::size_t kCount>
FaceTriangles onFace(const std::array<Tetrahedron, kCount>& all, int face, bool odd) {
  FaceTriangles found;
  for (const Tetrahedron& tetrahedron : all) {
    if (tetrahedron.where == (odd ? Where::EvenCells : Where::OddCells)) continue;
    for (int left = 0; left < 4; ++left) {
      std::set<HalfPlace> corners;
      for (int i = 0; i < 4; ++i) {
        HalfPlace place = kPlaces[tetrahedron.points[i]];
        if (i == left || place[face / 2] != 2 * (face & 1)) continue;
        place[face / 2] = 0;
        corners.insert(place);
      }
      if (corners.size() == 3) found.insert(corners);
    }
  }
  return found;
}

template <std::size_t kCount>
void expectFillsTheCell(const std::array<Tetrahedron, kCount>& all) {
  for (const bool odd : {false, true}) {
    int volume = 0;
    for (const Tetrahedron& tetrahedron : all) {
      EXPECT_GT(volumeOf(tetrahedron.points), 0);
      if (tetrahedron.where == (odd ? Where::EvenCells : Where::OddCells)) continue;
      volume += volumeOf(tetrahedron.points);
    }
    EXPECT_EQ(volume, 6 * 8);
    for (int axis = 0; axis < 3; ++axis) {
      const FaceTriangles below = onFace(all, axis * 2, !odd);
      EXPECT_FALSE(below.empty());
      EXPECT_EQ(onFace(all, axis * 2 + 1, odd), below) << "diagonals must match";
    }
  }
}

TEST(Tetrahedra, FillTheCellAndMatchAcrossItsFaces) {
  expectFillsTheCell(SplitInFive::kTetrahedra);
  expectFillsTheCell(SplitInSix::kTetrahedra);
  expectFillsTheCell(SplitInTwentyFour::kTetrahedra);
}

/// Squared lengths of the edges, sorted.
std::vector<int> shapeOf(const Tetrahedron& tetrahedron) {
  std::vector<int> lengths;
  for (const auto& [a, b] : kTetrahedronEdges) {
    int squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int d = kPlaces[tetrahedron.points[a]][axis] - kPlaces[tetrahedron.points[b]][axis];
      squared += d * d;
    }
    lengths.push_back(squared);
  }
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

TEST(Tetrahedra, OfTwentyFourAndOfTheBodyCentredLatticeAreOfOneShape) {
  for (const Tetrahedron& one : SplitInTwentyFour::kTetrahedra) {
    EXPECT_EQ(shapeOf(one), shapeOf(SplitInTwentyFour::kTetrahedra[0]));
  }
  int volume = 0;
  for (const Tetrahedron& one : BodyCentred::kTetrahedra) {
    EXPECT_EQ(shapeOf(one), (std::vector<int>{3, 3, 3, 3, 4, 4}));
    EXPECT_GT(volumeOf(one.points), 0);
    volume += one.where == Where::Everywhere ? volumeOf(one.points) : 0;
  }
  EXPECT_EQ(volume, 6 * 8);  // across the upper faces: half of it in the cells beyond
}

TEST(Tetrahedra, CasesSeparateInsideFromOutside) {
  const std::array<HalfPlace, 4> corners = {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}};
  for (unsigned mask = 0; mask < 16; ++mask) {
    const TetrahedronCase& found = kTetrahedronCases[mask];
    std::set<int> crossed, used;
    for (int e = 0; e < 6; ++e) {
      const auto [a, b] = kTetrahedronEdges[e];
      if (((mask >> a) & 1) != ((mask >> b) & 1)) crossed.insert(e);
    }
    std::map<std::pair<int, int>, int> sides;
    for (int i = 0; i < found.count; ++i) {
      const auto& t = found.triangles[i];
      std::array<HalfPlace, 3> at;
      for (int k = 0; k < 3; ++k) {
        used.insert(t[k]);
        ++sides[{t[k], t[(k + 1) % 3]}];
        const auto [a, b] = kTetrahedronEdges[t[k]];
        for (int axis = 0; axis < 3; ++axis) {
          at[k][axis] = (corners[a][axis] + corners[b][axis]) / 2;
        }
      }
      // Each corner lies on its side of the triangle, which is a plane here.
      for (int corner = 0; corner < 4; ++corner) {
        std::array<HalfPlace, 3> from;
        for (int axis = 0; axis < 3; ++axis) {
          from[0][axis] = at[1][axis] - at[0][axis];
          from[1][axis] = at[2][axis] - at[0][axis];
          from[2][axis] = corners[corner][axis] - at[0][axis];
        }
        const auto& [u, v, w] = from;
        const int side = w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
                         w[2] * (u[0] * v[1] - u[1] * v[0]);
        EXPECT_EQ(side < 0, ((mask >> corner) & 1) != 0) << mask;
      }
    }
    EXPECT_EQ(used, crossed) << mask;
    EXPECT_EQ(found.count, crossed.empty() ? 0 : crossed.size() - 2) << mask;
    for (const auto& [side, times] : sides) EXPECT_EQ(times, 1);
  }
}

/// The piecewise linear interpolant of a grid, by the plain definition of each split: its crossed
/// edges, triangles and tetrahedra are the vertices, edges and faces of the surface.
class PiecewiseLinear {
 public:
  explicit PiecewiseLinear(const FloatGrid& grid) : grid_(grid) {}

  void addCell(const openvdb::Coord& cell, Method method) {
    const auto corner = [&](int i) {
      return openvdb::Coord(2 * cell[0] + (i >> 2 << 1), 2 * cell[1] + (i & 2),
                            2 * cell[2] + ((i & 1) << 1));
    };
    const openvdb::Coord centre(2 * cell[0] + 1, 2 * cell[1] + 1, 2 * cell[2] + 1);
    if (method == Method::MarchingTetrahedra6) {
      std::array<int, 3> order = {4, 2, 1};
      std::sort(order.begin(), order.end());
      do {
        add({corner(0), corner(order[0]), corner(order[0] | order[1]), corner(7)});
      } while (std::next_permutation(order.begin(), order.end()));
      return;
    }
    if (method == Method::MarchingTetrahedra5) {
      const int odd = ((cell[0] + cell[1] + cell[2]) & 1) != 0 ? 7 : 0;
      add({corner(0 ^ odd), corner(3 ^ odd), corner(5 ^ odd), corner(6 ^ odd)});
      for (const int apex : {1, 2, 4, 7}) {
        add({corner(apex ^ odd), corner(apex ^ 1 ^ odd), corner(apex ^ 2 ^ odd),
             corner(apex ^ 4 ^ odd)});
      }
      return;
    }
    const bool body = method == Method::BodyCentred;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        if (body && side < 0) continue;  // the cell below has those
        openvdb::Coord other = centre;
        other[axis] += body ? 2 * side : side;
        openvdb::Coord middle = centre;
        middle[axis] += side;
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const std::array<std::array<int, 2>, 5> around = {
            {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}}};
        for (int i = 0; i < 4; ++i) {
          openvdb::Coord a = middle, b = middle;
          a[u] += around[i][0], a[v] += around[i][1];
          b[u] += around[i + 1][0], b[v] += around[i + 1][1];
          add({centre, other, a, b});
        }
      }
    }
  }

  [[nodiscard]] std::size_t vertices() const { return edges_.size(); }
  [[nodiscard]] long long euler() const {
    return static_cast<long long>(edges_.size()) - static_cast<long long>(triangles_.size()) +
           static_cast<long long>(tetrahedra_);
  }

 private:
  [[nodiscard]] bool isInside(const openvdb::Coord& half) const {
    double sum = 0;
    for (int i = 0; i < 8; ++i) {
      sum += grid_.tree().getValue(openvdb::Coord(
          (half[0] + (i >> 2)) >> 1, (half[1] + ((i >> 1) & 1)) >> 1, (half[2] + (i & 1)) >> 1));
    }
    return sum < 0;
  }

  void add(std::vector<openvdb::Coord> points) {
    std::sort(points.begin(), points.end());
    std::array<bool, 4> inside;
    for (int i = 0; i < 4; ++i) inside[i] = isInside(points[i]);
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        if (inside[i] != inside[j]) edges_.insert({points[i], points[j]});
        for (int k = j + 1; k < 4; ++k) {
          if (inside[i] != inside[j] || inside[i] != inside[k]) {
            triangles_.insert({points[i], points[j], points[k]});
          }
        }
      }
    }
    tetrahedra_ += std::count(inside.begin(), inside.end(), true) % 4 != 0 ? 1 : 0;
  }

  const FloatGrid& grid_;
  std::set<std::vector<openvdb::Coord>> edges_, triangles_;
  std::size_t tetrahedra_ = 0;
};

TEST(Tetrahedra, HaveTheSurfaceOfThePiecewiseLinearInterpolant) {
  const auto grid = tufa::test::noise<FloatGrid>({.size = 12, .seed = 5});
  openvdb::CoordBBox cells = grid->evalActiveVoxelBoundingBox();
  cells.expand(2);
  for (const Method method : {Method::MarchingTetrahedra5, Method::MarchingTetrahedra6,
                              Method::MarchingTetrahedra24, Method::BodyCentred}) {
    PiecewiseLinear expected(*grid);
    for (auto cell = cells.begin(); cell; ++cell) expected.addCell(*cell, method);
    ExtractOptions options;
    options.contour.isovalue = 0;
    options.contour.inside = Inside::Below;
    const Mesh mesh = extract(*grid, method, options);
    EXPECT_EQ(mesh.positions.size(), expected.vertices()) << static_cast<int>(method);
    EXPECT_EQ(tufa::test::inspect(mesh).euler(), expected.euler()) << static_cast<int>(method);
  }
}

// Of samples that are 0 or 1 the gradients at both ends of an edge often cancel out, and so do the
// normals around a loop now and then.
TEST(Tetrahedra, HaveUnitNormalsOnBinaryData) {
  std::mt19937 random(1);
  const auto grid = tufa::test::sampled<FloatGrid>(
      {openvdb::Coord(0), openvdb::Coord(23)}, 0,
      [&](const openvdb::Coord&) { return random() % 4 == 0 ? 1 : 0; });
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  ExtractOptions options;
  options.contour.isovalue = 0.5;
  for (const Method method :
       {Method::MarchingTetrahedra5, Method::MarchingTetrahedra6, Method::MarchingTetrahedra24,
        Method::BodyCentred, Method::MarchingCubes33, Method::ExtendedMarchingCubes,
        Method::CubicalMarchingSquares, Method::OctreeCubes}) {
    const Mesh mesh = extract(*grid, method, options);
    for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
      const Vec3 normal(mesh.normals[v]);
      ASSERT_NEAR(normal.length(), 1, 1e-5) << static_cast<int>(method) << " at " << v;
    }
  }
}

// One sample inside, at whose neighbours the gradient is as long the other way.
TEST(Tetrahedra, HaveOutwardNormalsAroundOneSample) {
  const auto grid = FloatGrid::create(0);
  grid->tree().setValue(openvdb::Coord(10), 1);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  ExtractOptions options;
  options.contour.isovalue = 0.5;
  for (const Method method : {Method::MarchingTetrahedra5, Method::MarchingTetrahedra6}) {
    const Mesh mesh = extract(*grid, method, options);
    for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
      EXPECT_GT(Vec3(mesh.normals[v]).dot(Vec3(mesh.positions[v]) - Vec3(10)), 0);
    }
  }
}

}  // namespace
}  // namespace tufa::extraction
