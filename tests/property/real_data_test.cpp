// Every mesh and volume of the sample folder goes through the whole pipeline.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/check.h>
#include <tufa/chunks.h>
#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/extract.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/voxelize.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/expect_error.h"
#include "support/mesh_oracle.h"
#include "support/uniform_mesh.h"

namespace tufa {
namespace {

const std::filesystem::path kFolder = TUFA_TEST_DATA;
const char* const kNone = "none";

/// Names of the sample files with one of these endings; one name that stands for none if there are
/// no samples, so that the test is listed and says that it was skipped.
std::vector<std::string> filesOf(const std::set<std::string>& endings) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder, error)) {
    std::string ending = entry.path().extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (endings.count(ending) != 0) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  if (names.empty()) names.emplace_back(kNone);
  return names;
}

std::string testName(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

class Sample : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (GetParam() == kNone) GTEST_SKIP() << "no sample files in " << kFolder;
  }
  [[nodiscard]] static std::filesystem::path path() { return kFolder / GetParam(); }
};

/// Checks that need not search for intersections, which is the work of the command and its table.
CheckReport checkTopology(const Mesh& mesh, bool weld = false) {
  CheckOptions options;
  options.selfIntersections = false;
  options.weld = weld;
  return check(mesh, options);
}

/// What every level of a chain keeps.
void expectPromises(const LodChain& chain, const ContourReport& report) {
  const std::size_t pieces =
      chain.levels.empty() ? 0 : check(chain.levels[0].mesh).components.size();
  for (std::size_t i = 0; i < chain.levels.size(); ++i) {
    const Lod& lod = chain.levels[i];
    SCOPED_TRACE("level " + std::to_string(i));
    const CheckReport found = check(lod.mesh);
    EXPECT_EQ(found.watertight(), report.openEdges == 0);
    EXPECT_TRUE(found.manifold && found.oriented);
    EXPECT_EQ(found.selfIntersectingPairs, 0U);
    EXPECT_LE(lod.certificate.maxErrorVoxels, lod.tolerance);
    EXPECT_EQ(found.components.size(), pieces);
    EXPECT_EQ(lod.certificate.eulerCharacteristic, chain.levels[0].certificate.eulerCharacteristic);
  }
}

double extentOf(const Mesh& mesh) {
  openvdb::BBoxd box;
  for (const Position& p : mesh.positions) box.expand(openvdb::Vec3d(p.x, p.y, p.z));
  return box.extents()[static_cast<int>(box.maxExtent())];
}

class SampleMesh : public Sample {};

// As other programs make volumes of meshes: with distances that are wrong beside concave edges.
VoxelizeOptions voxelsOf(const Mesh& mesh, int along) {
  VoxelizeOptions options;
  options.voxelSize = extentOf(mesh) / along;
  options.exactDistances = false;
  return options;
}

INSTANTIATE_TEST_SUITE_P(Files, SampleMesh,
                         ::testing::ValuesIn(filesOf({".obj", ".off", ".stl", ".glb", ".ply"})),
                         testName);

TEST_P(SampleMesh, ComesBackFromItsVolumeAsAManifold) {
  const Mesh input = readMesh(path());
  ASSERT_GT(input.triangleCount(), 0U);
  const CheckReport truth = checkTopology(input, true);
  constexpr int kFine = 120;
  for (const int voxels : {50, kFine}) {
    VoxelizeOptions options;
    options.voxelSize = extentOf(input) / voxels;
    ContourReport report;
    const auto grid = voxelize(input, options);
    const Mesh mesh = tufa::test::uniformMesh(*grid, {}, &report);
    const CheckReport found = checkTopology(mesh);
    // A plate thinner than a voxel may have no sample inside.
    if (mesh.triangleCount() == 0 && voxels < kFine) continue;
    EXPECT_TRUE(found.manifold && found.oriented) << voxels;
    EXPECT_EQ(found.duplicateFaces + found.collapsedFaces + found.invalidFaces, 0U) << voxels;
    if (!truth.closed) continue;
    EXPECT_EQ(report.openEdges, 0U) << voxels;
    EXPECT_TRUE(found.closed) << voxels;
    if (!truth.oriented) continue;
    // The surface is off by less than half a voxel, so the volume by less than that times the area.
    EXPECT_NEAR(found.volume, truth.volume, 0.5 * options.voxelSize * truth.area) << voxels;
  }
}

TEST_P(SampleMesh, IsAManifoldByCubicalMarchingSquaresWithMergedCells) {
  const Mesh input = readMesh(path());
  const auto grid = voxelize(input, voxelsOf(input, 120));
  ContourReport report;
  const auto meshAt = [&](double tolerance) {
    ExtractOptions options;
    options.mergeTolerance = tolerance;
    return extract(*grid, Method::CubicalMarchingSquares, options, &report);
  };
  const std::size_t finest = meshAt(0).triangleCount();
  for (const double tolerance : {0.1, 0.5}) {
    const Mesh mesh = meshAt(tolerance);
    const CheckReport found = checkTopology(mesh);
    EXPECT_TRUE(found.manifold && found.oriented) << tolerance;
    EXPECT_EQ(found.closed, report.openEdges == 0) << tolerance;
    EXPECT_LE(mesh.triangleCount(), finest) << tolerance;
  }
}

TEST_P(SampleMesh, HasAChainThatKeepsItsPromises) {
  const Mesh input = readMesh(path());
  LodOptions levels;
  levels.levels = 3;
  ContourReport report;
  const LodChain chain = buildLods(*voxelize(input, voxelsOf(input, 60)), levels, &report);
  // A plate thinner than a voxel may have no sample inside.
  EXPECT_EQ(chain.levels.empty(), report.surfaceCells == 0);
  expectPromises(chain, report);
}

// Where its sheets fold, 5,000 triangles had an error five times as large as 2,000.
TEST(SampleChain, HasErrorsThatRiseWithFewerTriangles) {
  const std::filesystem::path path = kFolder / "tri_ADIS16480.STL";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no file " << path;
  const Mesh input = readMesh(path);
  LodOptions levels;
  levels.triangles = {5000, 2000};
  const LodChain chain = buildLods(*voxelize(input, voxelsOf(input, 150)), levels);
  ASSERT_EQ(chain.levels.size(), 2U);
  EXPECT_LE(chain.levels[0].certificate.maxErrorVoxels, chain.levels[1].certificate.maxErrorVoxels);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LE(chain.levels[i].mesh.triangleCount(), levels.triangles[i]);
    EXPECT_GE(chain.levels[i].mesh.triangleCount(), levels.triangles[i] * 95 / 100);
  }
}

// Of random LODs, each chunk within one of its neighbours.
TEST_P(SampleMesh, HasChunksOfWhichEveryMixtureIsWhole) {
  const Mesh input = readMesh(path());
  const auto grid = voxelize(input, voxelsOf(input, 60));
  ChunkOptions chunkOptions;
  chunkOptions.chunkSize = 16;
  std::vector<Chunk> chunks;
  ContourReport report;
  const ChunkIndex index = buildChunks(
      *grid, chunkOptions,
      [&](const ChunkIndex&, Chunk&& chunk) { chunks.push_back(std::move(chunk)); }, &report);
  if (chunks.empty()) GTEST_SKIP() << "a plate thinner than a voxel";
  const CheckReport uniform = checkTopology(tufa::test::uniformMesh(*grid));
  std::mt19937 random(13);
  std::vector<std::size_t> lods(chunks.size());
  for (std::size_t& lod : lods) lod = random() % index.tolerances.size();
  restrictLods(index, lods);
  const CheckReport found = check(assembleChunks(chunks, lods));
  EXPECT_EQ(found.closed, report.openEdges == 0);
  EXPECT_TRUE(found.manifold && found.oriented);
  EXPECT_EQ(found.eulerCharacteristic, uniform.eulerCharacteristic);
  EXPECT_EQ(found.components.size(), uniform.components.size());
  EXPECT_EQ(found.selfIntersectingPairs, 0U);
  EXPECT_EQ(report.intersectionsLeft, 0U);
}

class SampleVolume : public Sample {};
INSTANTIATE_TEST_SUITE_P(Files, SampleVolume, ::testing::ValuesIn(filesOf({".vdb"})), testName);

TEST_P(SampleVolume, GivesAManifold) {
  const auto grid = readGrid(path());
  ContourReport report;
  const Mesh mesh = tufa::test::uniformMesh(*grid, {}, &report);
  ASSERT_GT(mesh.triangleCount(), 0U);
  const CheckReport found = checkTopology(mesh);
  EXPECT_TRUE(found.manifold && found.oriented);
  EXPECT_EQ(found.closed, report.openEdges == 0);
  EXPECT_EQ(found.duplicateFaces + found.collapsedFaces + found.invalidFaces, 0U);
  EXPECT_GT(found.volume, 0);
}

// Near the low end of its values the surface passes close to many samples, where vertices crowd.
TEST(SampleSmoke, HasNoFolds) {
  const std::filesystem::path path = kFolder / "openvdb_smoke.vdb";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no file " << path;
  const auto grid = readGrid(path);
  ContourOptions options;
  for (const double isovalue : {0.01, 0.1, 1.0}) {
    options.isovalue = isovalue;
    options.uniform = true;
    EXPECT_EQ(test::foldedEdges(contour(*grid, options), grid->voxelSize()[0]), 0U) << isovalue;
  }
  options.uniform = false;
  EXPECT_EQ(test::foldedEdges(contour(*grid, options), grid->voxelSize()[0]), 0U);
}

class SampleOfOthers : public Sample {};
INSTANTIATE_TEST_SUITE_P(Files, SampleOfOthers, ::testing::ValuesIn(filesOf({".mhd"})), testName);

TEST_P(SampleOfOthers, IsRefusedByName) {
  test::expectError(ErrorCode::UnreadableFile, GetParam(), [] { (void)readGrid(path()); });
}

}  // namespace
}  // namespace tufa
