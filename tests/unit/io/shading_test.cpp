// What a viewer shades: the normals of .glb and .obj files, interpolated over every triangle,
// beside those of the true shape. The files are read by a small reader of the test's own, since
// readMesh() welds what creases split.

#include <gtest/gtest.h>

#include <tufa/contour.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/shapes.h>
#include <array>
#include <cmath>
#include <cstring>
#include <sstream>

#include "base/job.h"
#include "base/vec3.h"
#include "shading/shaded_mesh.h"
#include "support/json.h"
#include "support/scratch_folder.h"

namespace tufa {
namespace {

using Json = nlohmann::json;
using test::readBytes;
using test::ScratchFolder;

constexpr double kVoxel = 0.02;
constexpr double kDegrees = 180 / 3.14159265358979323846;

struct Corner {
  Vec3 point;
  Vec3 normal;
};
using ShadedTriangles = std::vector<std::array<Corner, 3>>;

/// The first mesh of a .glb without compression.
class GlbFile {
 public:
  explicit GlbFile(const std::filesystem::path& path) : bytes_(readBytes(path)) {
    const auto length = number<std::uint32_t>(12);
    json_ = test::parseJson(bytes_.substr(20, length));
    binary_ = 20 + length + 8;
  }

  [[nodiscard]] const Json& json() const { return json_; }

  [[nodiscard]] ShadedTriangles triangles() const {
    const Json& primitive = json_["meshes"][0]["primitives"][0];
    const auto positions = vectors(primitive["attributes"]["POSITION"]);
    const auto normals = vectors(primitive["attributes"]["NORMAL"]);
    const auto shift = json_["nodes"][0].value("translation", std::array<double, 3>{0, 0, 0});
    const Json& accessor = json_["accessors"][primitive["indices"].get<std::size_t>()];
    const std::size_t begin = beginOf(accessor);
    const bool isShort = accessor["componentType"] == 5123;
    ShadedTriangles triangles(accessor["count"].get<std::size_t>() / 3);
    for (std::size_t i = 0; i < 3 * triangles.size(); ++i) {
      const std::size_t v =
          isShort ? number<std::uint16_t>(begin + 2 * i) : number<std::uint32_t>(begin + 4 * i);
      triangles[i / 3][i % 3] = {positions[v] + Vec3(shift[0], shift[1], shift[2]), normals[v]};
    }
    return triangles;
  }

 private:
  template <class Number>
  [[nodiscard]] Number number(std::size_t at) const {
    Number value;
    std::memcpy(&value, bytes_.data() + at, sizeof value);
    return value;
  }
  [[nodiscard]] std::size_t beginOf(const Json& accessor) const {
    const Json& view = json_["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    return binary_ + view["byteOffset"].get<std::size_t>();
  }
  [[nodiscard]] std::vector<Vec3> vectors(const Json& index) const {
    const Json& accessor = json_["accessors"][index.get<std::size_t>()];
    const std::size_t begin = beginOf(accessor);
    std::vector<Vec3> all(accessor["count"].get<std::size_t>());
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::size_t at = begin + 12 * i;
      all[i] = {number<float>(at), number<float>(at + 4), number<float>(at + 8)};
    }
    return all;
  }

  std::string bytes_;
  Json json_;
  std::size_t binary_ = 0;
};

/// Polygons are fanned from their first corner, as viewers do.
ShadedTriangles readObjFile(const std::filesystem::path& path) {
  std::istringstream lines(readBytes(path));
  std::vector<Vec3> positions, normals;
  ShadedTriangles triangles;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "v" || keyword == "vn") {
      double x = 0, y = 0, z = 0;
      words >> x >> y >> z;
      (keyword == "v" ? positions : normals).emplace_back(x, y, z);
    } else if (keyword == "f") {
      std::vector<Corner> corners;
      for (std::string word; words >> word;) {
        const std::size_t slashes = word.find("//");
        corners.push_back({positions.at(std::stoul(word) - 1),
                           normals.at(std::stoul(word.substr(slashes + 2)) - 1)});
      }
      for (std::size_t i = 2; i < corners.size(); ++i) {
        triangles.push_back({corners[0], corners[i - 1], corners[i]});
      }
    }
  }
  return triangles;
}

/// The true normal beside a place on the surface, or zero where a crease is near.
Vec3 trueNormal(const Vec3& p) {
  constexpr double kStep = 0.5 * kVoxel;
  Vec3 gradient(0);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 step(0);
    step[axis] = kStep;
    gradient[axis] =
        (shapeDistance(Shape::Bracket, p + step) - shapeDistance(Shape::Bracket, p - step)) /
        (2 * kStep);
  }
  return gradient.length() > 0.98 ? gradient.unitOrX() : Vec3(0);
}

/// The share of the surface that is shaded more than 15 degrees wrong.
double shareWrong(const ShadedTriangles& triangles) {
  constexpr int kSteps = 8;  // samples along an edge
  double wrong = 0, all = 0;
  for (const auto& t : triangles) {
    const double area = (t[1].point - t[0].point).cross(t[2].point - t[0].point).length();
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; i + j < kSteps; ++j) {
        const double a = (i + 1.0 / 3) / kSteps, b = (j + 1.0 / 3) / kSteps, c = 1 - a - b;
        const Vec3 truth = trueNormal(a * t[0].point + b * t[1].point + c * t[2].point);
        if (truth == Vec3(0)) continue;
        const Vec3 seen = (a * t[0].normal + b * t[1].normal + c * t[2].normal).unitOrX();
        all += area;
        if (seen.dot(truth) < std::cos(15 / kDegrees)) wrong += area;
      }
    }
  }
  return wrong / all;
}

const Mesh& bracket() {
  static const Mesh mesh = [] {
    ShapeOptions shape;
    shape.voxelSize = kVoxel;
    return contour(*makeShape(Shape::Bracket, shape));
  }();
  return mesh;
}

TEST(Shading, IsTrueOnFlatFacesOfGlbAndObj) {
  const ScratchFolder folder;
  write(bracket(), folder / "b.glb");
  write(bracket(), folder / "b.obj");
  WriteOptions welded;
  welded.creaseAngle = 180;
  write(bracket(), folder / "w.glb", welded);
  const double before = shareWrong(GlbFile(folder / "w.glb").triangles());
  const double glb = shareWrong(GlbFile(folder / "b.glb").triangles());
  const double obj = shareWrong(readObjFile(folder / "b.obj"));
  RecordProperty("welded", std::to_string(before));
  RecordProperty("glb", std::to_string(glb));
  RecordProperty("obj", std::to_string(obj));
  EXPECT_GT(before, 0.3);
  EXPECT_LT(glb, 0.005);
  EXPECT_LT(obj, 0.005);
}

// A normal that is bent by a crease nearby, as a gradient across it is.
TEST(Shading, FollowsTheFacesWhereANormalIsBent) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const auto tilted = [](double degrees) {
    return Normal(Vec3(std::sin(degrees / kDegrees), 0, std::cos(degrees / kDegrees)));
  };
  base::Job job(1, {});
  for (const double degrees : {0.0, 15.0, 25.0, 60.0}) {
    mesh.normals.assign(4, tilted(0));
    mesh.normals[1] = tilted(degrees);
    const shading::ShadedMesh split = shading::splitAtCreases(mesh, 40, job);
    ASSERT_EQ(split.sources, (std::vector<VertexIndex>{0, 1, 2, 3}));
    EXPECT_NEAR(split.normals[1].x, degrees < 20 ? mesh.normals[1].x : 0, 1e-6) << degrees;
    EXPECT_EQ(shading::splitAtCreases(mesh, 180, job).normals[1].x, mesh.normals[1].x) << degrees;
  }
}

// Two large faces at a right angle, with small ones between them that turn by 30 degrees each.
TEST(Shading, KeepsTheSidesOfACreaseApartThatSmallFacesBevel) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0},
                    {10, 0, 0},
                    {0, 0.3f, 0},
                    {-0.087f, 0.3f, -0.05f},
                    {-0.137f, 0.3f, -0.137f},
                    {-0.137f, 0.3f, -10}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
  base::Job job(1, {});
  const shading::ShadedMesh split = shading::splitAtCreases(mesh, 40, job);
  ASSERT_EQ(split.sources.size(), 7U);  // the apex is two
  const VertexIndex top = split.indices[0], wall = split.indices[9];
  EXPECT_NE(top, wall);
  EXPECT_GT(split.normals[top].z, 0.9);
  EXPECT_LT(split.normals[wall].x, -0.9);
}

}  // namespace
}  // namespace tufa
