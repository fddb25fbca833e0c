// tufa mesh --labels. Labels come from raw values, which need no ITK.

#include <gtest/gtest.h>

#include <tufa/io.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Outcome;
using test::writeBytes;

std::string bytesOf(std::uint16_t label) {
  return {static_cast<char>(label & 0xff), static_cast<char>(label >> 8)};
}

class LabelMeshes : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    // A block of 2 in one of 7, and a bar of 300 that touches both.
    std::string bytes;
    for (int z = 0; z < 20; ++z) {
      for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 20; ++x) {
          const auto in = [&](int least, int most) {
            return std::min({x, y, z}) >= least && std::max({x, y, z}) <= most;
          };
          const bool bar = x >= 10 && std::max(y, z) <= 11 && std::min(y, z) >= 9 && x <= 17;
          bytes += bytesOf(static_cast<std::uint16_t>(bar         ? 300
                                                      : in(6, 9)  ? 2
                                                      : in(3, 14) ? 7
                                                                  : 0));
        }
      }
    }
    writeBytes(folder / "l.raw", bytes);
    ASSERT_EQ(run("import l.raw -o l.vdb --size 20,20,20 --type u16 --labels").exitCode, 0);
  }
};

TEST_F(LabelMeshes, AreClosedEachOfItsOwn) {
  const Outcome made = run("mesh l.vdb -o 'm_{}.ply' --labels all --check --json --uniform");
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const auto json = test::parseJson(made.out);
  const std::vector<std::string> names = {"label_2", "label_7", "label_300"};
  // Voxels of each, less what the corners and edges lose.
  const std::vector<double> voxels = {4 * 4 * 4, 12 * 12 * 12 - 64 - 5 * 9, 8 * 9};
  ASSERT_EQ(json.at("grids").size(), names.size());
  for (std::size_t n = 0; n < names.size(); ++n) {
    const auto& grid = json.at("grids").at(n);
    EXPECT_EQ(grid.at("grid"), names[n]);
    EXPECT_EQ(grid.at("active_voxels"), voxels[n]);
    const double volume = grid.at("check").at("volume");
    EXPECT_GT(volume, 0.8 * voxels[n]) << names[n];
    EXPECT_LT(volume, 1.05 * voxels[n]) << names[n];
    EXPECT_TRUE(std::filesystem::exists(folder / ("m_" + names[n] + ".ply")));
  }
  EXPECT_EQ(run("mesh l.vdb -o m.obj --labels 300,2 --check").exitCode, 0);
  EXPECT_EQ(run("mesh l.vdb -o m.ply --labels 7 --smooth gaussian --check").exitCode, 0);
}

/// Faces as their corners in a fixed order, and which way round they go.
std::map<std::vector<std::array<double, 3>>, int> facesOf(const Mesh& mesh) {
  std::map<std::vector<std::array<double, 3>>, int> faces;
  const auto add = [&](std::initializer_list<VertexIndex> corners) {
    std::vector<std::array<double, 3>> face;
    for (const VertexIndex v : corners) {
      const Position& p = mesh.positions[v];
      face.push_back({p.x, p.y, p.z});
    }
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    const bool turned = face[2] < face[1];
    if (turned) std::swap(face[1], face[2]);
    faces[face] += turned ? -1 : 1;
  };
  for (const Triangle& t : mesh.triangles) add({t.vertices[0], t.vertices[1], t.vertices[2]});
  for (const Quad& q : mesh.quads) {
    add({q.vertices[0], q.vertices[1], q.vertices[2]});
    add({q.vertices[0], q.vertices[2], q.vertices[3]});
  }
  return faces;
}

/// Each pair of neighbouring voxels of different labels is two triangles in both meshes, one the
/// other turned round.
TEST_F(LabelMeshes, ShareTheirInterfacesToTheBit) {
  // Random labels touch in every way; the transform is no power of two, and far from the origin.
  std::mt19937 random(24);
  std::string bytes;
  constexpr int kSide = 14;
  std::vector<int> values;
  for (int n = 0; n < kSide * kSide * kSide; ++n) {
    values.push_back(static_cast<int>(random() % 4));
    bytes += bytesOf(static_cast<std::uint16_t>(values.back()));
  }
  writeBytes(folder / "n.raw", bytes);
  ASSERT_EQ(run("import n.raw -o n.vdb --size 14,14,14 --type u16 --labels --spacing 0.3,0.7,1.1 "
                "--origin 1000,-70,3")
                .exitCode,
            0);
  std::map<std::pair<int, int>, std::size_t> contacts;
  const auto at = [&](int x, int y, int z) {
    return values[static_cast<std::size_t>(x + kSide * (y + kSide * z))];
  };
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const auto meet = [&](int other) { ++contacts[std::minmax(at(x, y, z), other)]; };
        if (x + 1 < kSide) meet(at(x + 1, y, z));
        if (y + 1 < kSide) meet(at(x, y + 1, z));
        if (z + 1 < kSide) meet(at(x, y, z + 1));
      }
    }
  }
  for (const std::string threads : {"1", "2"}) {
    const Outcome made =
        run("mesh n.vdb -o 'n_{}.ply' --labels all --share-interfaces --json "
            "--check --threads " +
            threads);
    // Noise touches itself everywhere, so that inside and outside of pieces are not told apart.
    const auto json = test::parseJson(made.out);
    std::vector<std::map<std::vector<std::array<double, 3>>, int>> faces;
    for (int label = 1; label < 4; ++label) {
      const Mesh mesh = readMesh(folder / ("n_label_" + std::to_string(label) + ".ply"));
      const auto& told = json.at("grids").at(static_cast<std::size_t>(label - 1));
      for (const char* const promise : {"closed", "manifold", "oriented"}) {
        EXPECT_EQ(told.at("check").at(promise), true) << promise;
      }
      std::set<std::array<double, 3>> places;
      for (const Position& p : mesh.positions) places.insert({p.x, p.y, p.z});
      EXPECT_EQ(told.at("interfaces").at("touching_vertices"),
                mesh.positions.size() - places.size());
      EXPECT_GT(told.at("interfaces").at("shared_vertices"), mesh.positions.size() / 2);
      faces.push_back(facesOf(mesh));
    }
    for (int one = 1; one < 4; ++one) {
      for (int other = one + 1; other < 4; ++other) {
        std::size_t shared = 0;
        for (const auto& [face, turns] : faces[static_cast<std::size_t>(one - 1)]) {
          const auto& others = faces[static_cast<std::size_t>(other - 1)];
          const auto found = others.find(face);
          if (found == others.end()) continue;
          ++shared;
          ASSERT_EQ(turns, -found->second);
        }
        EXPECT_EQ(shared, 2 * (contacts[{one, other}])) << one << other;
      }
    }
  }
  // Parts that do not touch themselves bound their volumes.
  const Outcome blocks = run("mesh l.vdb -o m.obj --labels all --share-interfaces --check --json");
  ASSERT_EQ(blocks.exitCode, 0) << blocks.err;
  for (const auto& told : test::parseJson(blocks.out).at("grids")) {
    EXPECT_EQ(told.at("check").at("bounds_volume"), true);
    EXPECT_GT(told.at("interfaces").at("shared_vertices"), 20);
  }
  expectFailure("mesh n.vdb -o m.obj --share-interfaces", 2, "--share-interfaces is for --labels");
  expectFailure("mesh n.vdb -o m.obj --labels all --share-interfaces --method mc", 2,
                "by surface nets");
  expectFailure("mesh n.vdb -o m.obj --labels all --share-interfaces --smooth gaussian", 2,
                "without filters");
}

TEST_F(LabelMeshes, RefuseWhatIsNoLabel) {
  expectFailure("mesh l.vdb -o m.ply --labels 3", 3, "no label 3");
  expectFailure("mesh l.vdb -o m.ply --labels x", 2, "--labels takes all");
  expectFailure("mesh l.vdb -o m.ply --labels 2,2", 2, "asked for twice");
  expectFailure("mesh l.vdb -o m.ply --labels all", 2, "would hold 3");
  expectFailure("mesh l.vdb -o m.ply --labels 2 --iso 1", 2, "no --iso");
  expectFailure("mesh l.vdb -o 'm{}.ply' --labels all --smooth mean:20", 3,
                "is left of label_2 in l.vdb once it is filtered; --allow-empty");
  EXPECT_EQ(run("mesh l.vdb -o 'm{}.ply' --labels all --smooth mean:20 --allow-empty").exitCode, 0);
  ASSERT_EQ(run("make sphere -o s.vdb --voxel 0.2").exitCode, 0);
  expectFailure("mesh s.vdb -o m.ply --labels all", 3, "no grid of 32- or 64-bit integers");
  expectFailure("mesh s.vdb -o m.ply --labels all --grid '*'", 2, "is a pattern");
}

}  // namespace
}  // namespace tufa
