#include "uniform/snap_to_creases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "uniform/vertex_sheets.h"

namespace tufa::uniform {
namespace {

using Kind = VertexSheets::Kind;

const float kHalf = std::sqrt(0.5F);
const Normal kLeft(-kHalf, 0, kHalf);
const Normal kRight(kHalf, 0, kHalf);

std::size_t snap(Mesh& mesh, VertexSheets& sheets, double voxelSize, base::Job& job,
                 bool admits = true) {
  const auto quadsAt = [&](const std::vector<VertexIndex>&,
                           const std::vector<std::uint8_t>& marks) {
    std::vector<std::uint32_t> quads;
    for (std::uint32_t i = 0; i < mesh.quads.size(); ++i) {
      const auto& v = mesh.quads[i].vertices;
      if ((marks[v[0]] | marks[v[1]] | marks[v[2]] | marks[v[3]]) != 0) quads.push_back(i);
    }
    return quads;
  };
  return snapToCreases(
      mesh, sheets, voxelSize, quadsAt, [&](const Position&) { return admits; }, job);
}

/// A roof with its ridge along y at x = 0, z = 0, and quads that step over it.
struct Roof {
  Mesh mesh;
  VertexSheets sheets;

  void add(double x, double y) {
    mesh.positions.emplace_back(x, y, -std::abs(x));
    mesh.normals.push_back(x < 0 ? kLeft : kRight);
  }
  Roof() {
    for (int y = 0; y < 4; ++y) {
      add(-0.5, y);
      add(0.3, y);
    }
    for (VertexIndex y = 0; y < 3; ++y) {
      mesh.quads.emplace_back(2 * y, 2 * y + 1, 2 * y + 3, 2 * y + 2);
    }
    sheets = VertexSheets(mesh.positions.size());
    sheets.setKinds(0, std::vector<Kind>(mesh.positions.size(), Kind::Near));
  }
};

TEST(VertexSheets, TellSidesApart) {
  Roof roof;
  EXPECT_EQ(roof.sheets.kind(0), Kind::Near);
  EXPECT_EQ(roof.sheets.sheets(roof.mesh, 0).count, 1);
  EXPECT_EQ(roof.sheets.sheets(roof.mesh, 0).normals[0], kLeft);
  roof.sheets.setMeeting(1, {2, {kLeft, kRight}});
  EXPECT_EQ(roof.sheets.sheets(roof.mesh, 1).count, 2);
  EXPECT_TRUE(roof.sheets.isSharp(1));
  roof.sheets.setKinds(2, {Kind::Unknown});
  EXPECT_EQ(roof.sheets.sheets(roof.mesh, 2).count, 0);
  EXPECT_EQ(roof.sheets.sharpCount(), 2U);
}

TEST(QuadSheets, FitWhereADiagonalFollowsTheCrease) {
  Roof roof;
  const Quad& quad = roof.mesh.quads[0];
  EXPECT_EQ(QuadSheets(roof.mesh, roof.sheets, quad).count(), 2);
  EXPECT_FALSE(QuadSheets(roof.mesh, roof.sheets, quad).fits(false));
  EXPECT_FALSE(QuadSheets(roof.mesh, roof.sheets, quad).fits(true));
  // Corners 1 and 3 on the ridge: the diagonal between them leaves one side on either side.
  roof.sheets.setMeeting(quad.vertices[1], {2, {kLeft, kRight}});
  roof.sheets.setMeeting(quad.vertices[3], {2, {kLeft, kRight}});
  EXPECT_FALSE(QuadSheets(roof.mesh, roof.sheets, quad).fits(false));
  EXPECT_TRUE(QuadSheets(roof.mesh, roof.sheets, quad).fits(true));
}

TEST(PromoteToCreases, MovesTheNearestVerticesOntoTheRidge) {
  Roof roof;
  const Mesh before = roof.mesh;
  base::Job job(2, {});
  const std::size_t moved = snap(roof.mesh, roof.sheets, 1, job);
  EXPECT_GT(moved, 0U);
  EXPECT_EQ(moved, roof.sheets.sharpCount());
  for (VertexIndex v = 0; v < before.positions.size(); ++v) {
    const Position& p = roof.mesh.positions[v];
    if (roof.sheets.kind(v) != Kind::Meeting) {
      EXPECT_EQ(p, before.positions[v]);
      continue;
    }
    EXPECT_EQ(v % 2, 1U) << "the right ones are nearer";
    EXPECT_NEAR(p.x, 0, 1e-6);
    EXPECT_NEAR(p.z, 0, 1e-6);
    EXPECT_NEAR(p.y, before.positions[v].y, 1e-6);
    EXPECT_NEAR(roof.mesh.normals[v].z, 1, 1e-6);
  }
  for (const Quad& quad : roof.mesh.quads) {
    const QuadSheets around(roof.mesh, roof.sheets, quad);
    EXPECT_TRUE(around.fits(false) || around.fits(true));
  }
}

/// A band of quads along y whose vertices lie on one of three sheets each, or nobody knows where.
struct Band {
  static constexpr int kWidth = 6;
  Mesh mesh;
  VertexSheets sheets;

  Band(int from, int to) {
    std::vector<Kind> kinds;
    for (int y = from; y < to; ++y) {
      // The same numbers at the same place.
      std::mt19937 random(static_cast<unsigned>(y + 1));
      std::uniform_real_distribution<double> shift(-0.3, 0.3);
      for (int x = 0; x < kWidth; ++x) {
        mesh.positions.emplace_back(x + shift(random), y + shift(random), shift(random));
        const auto tilt = static_cast<float>(0.1 * shift(random));
        const auto side = random() % 3;
        mesh.normals.push_back(side == 0   ? Normal(-kHalf, tilt, kHalf)
                               : side == 1 ? Normal(kHalf, tilt, kHalf)
                                           : Normal(tilt, kHalf, kHalf));
        kinds.push_back(random() % 4 == 0 ? Kind::Unknown : Kind::Near);
      }
    }
    for (int y = 0; y + 1 < to - from; ++y) {
      for (int x = 0; x + 1 < kWidth; ++x) {
        const auto at = static_cast<VertexIndex>(y * kWidth + x);
        mesh.quads.emplace_back(at, at + 1, at + 1 + kWidth, at + kWidth);
      }
    }
    sheets = VertexSheets(mesh.positions.size());
    sheets.setKinds(0, kinds);
  }
};

TEST(PromoteToCreases, DependsOnWhatIsNearAlone) {
  constexpr int kReach = 12, kLength = 60;  // two cells in each of six rounds
  const auto promote = [](int from, int to) {
    Band band(from, to);
    base::Job job(2, {});
    EXPECT_GT(snap(band.mesh, band.sheets, 1, job), 0U);
    return band.mesh;
  };
  const Mesh whole = promote(0, 400);
  for (int from = 1; from + kLength < 400; from += 7) {
    const Mesh part = promote(from, from + kLength);
    for (int i = kReach * Band::kWidth; i < (kLength - kReach) * Band::kWidth; ++i) {
      ASSERT_EQ(part.positions[i], whole.positions[from * Band::kWidth + i]) << from << " " << i;
    }
  }
}

TEST(PromoteToCreases, LeavesWhatIsTooFar) {
  Roof roof;
  base::Job job(1, {});
  EXPECT_EQ(snap(roof.mesh, roof.sheets, 0.2, job), 0U);  // in voxels of a fifth
}

/// A ridge along y at x = 0, z = 0, as steep as that, and a quad that steps over it 1.5 below.
struct Wedge {
  Mesh mesh;
  VertexSheets sheets{4};

  explicit Wedge(double steepness) {
    const Normal left = toNormal({-steepness, 0, 1}), right = toNormal({steepness, 0, 1});
    const double half = 1.5 / std::sqrt(1 + steepness * steepness);
    for (const double y : {0.0, 1.0}) {
      mesh.positions.emplace_back(-half, y, -half * steepness);
      mesh.positions.emplace_back(half, y, -half * steepness);
      mesh.normals.push_back(left);
      mesh.normals.push_back(right);
    }
    mesh.quads.emplace_back(0, 1, 3, 2);
    sheets.setKinds(0, std::vector<Kind>(4, Kind::Near));
  }
  static Normal toNormal(const Vec3& v) { return Normal(v.unitOrX()); }
};

// Two voxels are near enough onto an acute edge that the samples admit.
TEST(PromoteToCreases, GoesFartherOntoAcuteEdges) {
  base::Job job(1, {});
  Wedge acute(3);  // 37 degrees
  EXPECT_GT(snap(acute.mesh, acute.sheets, 1, job), 0U);
  EXPECT_TRUE(acute.sheets.isSharp(0) || acute.sheets.isSharp(1) || acute.sheets.isSharp(2) ||
              acute.sheets.isSharp(3));
  Wedge blunt(3);
  EXPECT_EQ(snap(blunt.mesh, blunt.sheets, 1, job, false), 0U);
  Wedge farther(3);
  EXPECT_EQ(snap(farther.mesh, farther.sheets, 0.7, job), 0U);
  Wedge obtuse(0.8);  // 103 degrees
  EXPECT_EQ(snap(obtuse.mesh, obtuse.sheets, 1, job), 0U);
  Wedge bent(3);
  bent.mesh.positions[0].x -= 0.1;
  EXPECT_EQ(snap(bent.mesh, bent.sheets, 1, job), 0U);
}

TEST(PromoteToCreases, LeavesSmoothVertices) {
  Roof roof;
  roof.sheets = VertexSheets(roof.mesh.positions.size());
  base::Job job(1, {});
  EXPECT_EQ(snap(roof.mesh, roof.sheets, 1, job), 0U);
}

}  // namespace
}  // namespace tufa::uniform
