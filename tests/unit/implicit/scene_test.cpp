#include <gtest/gtest.h>
#include <tufa/implicit.h>
#include <tufa/memory.h>

#include <cmath>
#include <string>

#include "base/vec3.h"
#include "support/expect_error.h"

namespace tufa {
namespace {

using implicit::Box;
using implicit::readScene;
using implicit::Scene;
using test::expectError;

Scene sceneOf(const std::string& text, const std::optional<Box>& bounds = {}) {
  return readScene(FileBytes{text, "s.json"}, bounds);
}

/// A scene of some objects, with single quotes for double ones.
std::string sceneText(std::string objects, std::string more = "") {
  std::string text = "{'tufa_scene': 1, 'objects': [" + objects + "]" + more + "}";
  std::replace(text.begin(), text.end(), '\'', '"');
  return text;
}

double valueOf(const std::string& objects, const Position& p) {
  return sceneOf(sceneText(objects)).field->value(p);
}

TEST(Scene, ReadsItsObjects) {
  EXPECT_NEAR(valueOf("{'type': 'sphere', 'center': [1, 0, 0], 'radius': 2}", {4, 0, 0}), 1, 1e-12);
  EXPECT_NEAR(valueOf("{'type': 'box', 'size': [2, 4, 6]}", {0, 3, 0}), 1, 1e-12);
  EXPECT_NEAR(valueOf("{'type': 'circle', 'radius': 2, 'tube': 0.5}", {0, 2, 1}), 0.5, 1e-12);
  EXPECT_NEAR(valueOf("{'type': 'plane', 'normal': [0, 2, 0], 'point': [0, 1, 0]}", {5, 3, 1}), 2,
              1e-12);
  EXPECT_NEAR(valueOf("{'type': 'quadric', 'shape': 'ellipsoid', 'center': [1, 2, 3],"
                      " 'radii': [2, 3, 4]}",
                      {1, 2, 7}),
              0, 1e-12);
  EXPECT_NEAR(valueOf("{'type': 'quadric', 'shape': 'paraboloid', 'center': [1, 2, 3],"
                      " 'radii': [2, 3, 4]}",
                      {3, 2, 7}),
              0, 1e-12);
  EXPECT_NEAR(valueOf("{'type': 'difference', 'objects': [{'type': 'sphere', 'radius': 2},"
                      "{'type': 'sphere', 'radius': 1}]}",
                      {0, 0, 0}),
              1, 1e-12);
  EXPECT_NEAR(valueOf("{'type': 'shell', 'thickness': 0.2, 'object': {'type': 'sphere',"
                      " 'radius': 1}}",
                      {0, 1, 0}),
              -0.1, 1e-12);
  EXPECT_NEAR(valueOf("{'type': 'offset', 'distance': 0.5, 'object': {'type': 'complement',"
                      " 'object': {'type': 'sphere', 'radius': 1}}}",
                      {0, 0, 0}),
              0.5, 1e-12);
}

TEST(Scene, TransformsInTheirOrder) {
  const std::string sphere = "{'type': 'sphere', 'center': [1, 0, 0], 'radius': 0.5, 'transform': ";
  const auto centreAt = [&](const std::string& steps, const Position& p, double value) {
    EXPECT_NEAR(valueOf(sphere + steps + "}", p), value, 1e-12) << steps;
  };
  centreAt("[]", {1, 0, 0}, -0.5);
  centreAt("[{'translate': [0, 2, 0]}]", {1, 2, 0}, -0.5);
  centreAt("[{'rotate': {'axis': [0, 0, 3], 'degrees': 90}}]", {0, 1, 0}, -0.5);
  centreAt("[{'scale': 3}]", {3, 0, 0}, -1.5);
  centreAt("[{'mirror': [2, 0, 0]}]", {-1, 0, 0}, -0.5);
  centreAt("[{'translate': [0, 2, 0]}, {'rotate': {'axis': [0, 0, 1], 'degrees': 90}}]", {-2, 1, 0},
           -0.5);
  centreAt("[{'rotate': {'axis': [0, 0, 1], 'degrees': 90}}, {'translate': [0, 2, 0]}]", {0, 3, 0},
           -0.5);
  const Scene flat = sceneOf(sceneText(sphere + "[{'scale': [1, 1, 0.1]}]}"));
  EXPECT_FALSE(flat.field->hasUnitGradient());
  EXPECT_NEAR(flat.field->extent().greatest.z, 0.05, 1e-9);
}

TEST(Scene, RepeatsAndUsesDefinitions) {
  const std::string bead = "{'type': 'sphere', 'radius': 0.5}";
  const std::string text = sceneText(
      "{'type': 'repeat', 'object': {'type': 'use', 'name': 'bead'}, 'step': [2, 1, 5],"
      " 'count': [1000000000, 1, 2]}",
      ", 'definitions': {'bead': " + bead + "}, 'name': 'chain', 'voxel': 0.1, 'half_width': 4");
  const Scene scene = sceneOf(text);
  EXPECT_EQ(scene.name, "chain");
  EXPECT_EQ(scene.voxelSize, 0.1);
  EXPECT_EQ(scene.halfWidth, 4);
  EXPECT_NEAR(scene.field->value({0, 0, 0}), -0.5, 1e-12);
  EXPECT_NEAR(scene.field->value({1000000, 0, 5}), -0.5, 1e-9);
  EXPECT_NEAR(scene.field->value({1000001, 0, 5}), 0.5, 1e-9);
  EXPECT_NEAR(scene.field->value({-3, 0, 0}), 2.5, 1e-12);
  EXPECT_EQ(scene.field->extent().greatest.x, 2 * 999999999.0 + 0.5);
}

TEST(Scene, BoundsCutAndClose) {
  const std::string plane = "{'type': 'plane'}";
  EXPECT_TRUE(std::isinf(sceneOf(sceneText(plane)).field->extent().least.z));
  const std::string bounds = ", 'bounds': [-1, -1, -1, 1, 1, 1]";
  const auto cut = sceneOf(sceneText(plane, bounds)).field;
  EXPECT_EQ(cut->extent().least.z, -1);
  EXPECT_EQ(cut->extent().greatest.z, 0);
  EXPECT_GT(cut->value({0, 0, -1.5}), 0);
  const Box other{{-2, -2, -2}, {2, 2, 2}};
  EXPECT_EQ(sceneOf(sceneText(plane, bounds), other).field->extent().least.z, -2);
  expectError(ErrorCode::InvalidArgument, "bounds", [&] {
    static_cast<void>(sceneOf(sceneText(plane), Box{{0, 0, 0}, {1, 0, 1}}));
  });
}

TEST(Scene, ErrorsNameThePath) {
  const auto refused = [](const std::string& text, const std::string& part) {
    expectError(ErrorCode::UnreadableFile, part, [&] { static_cast<void>(sceneOf(text)); });
  };
  refused(sceneText("{'type': 'plane'}", ", 'half_width': 0.5"),
          "/half_width: must be a number of voxels from 1 to 1000");
  const auto object = [&](const std::string& text, const std::string& part) {
    refused(sceneText("{'type': 'sphere', 'radius': 1}, " + text), "s.json: /objects/1" + part);
  };
  object("{'type': 'sphere', 'radius': 0}", "/radius: must be a number above 0");
  object("{'type': 'sphere', 'radius': -1}", "/radius: must be a number above 0");
  object("{'type': 'sphere', 'radius': '1'}", "/radius: must be a number");
  object("{'type': 'sphere', 'radius': 1e300}", "/radius: must be a number from -1e+12 to 1e+12");
  object("{'type': 'sphere', 'radius': null}", "/radius: must be a number");
  object("{'type': 'sphere'}", ": has no \"radius\"");
  object("{'type': 'sphere', 'radius': 1, 'centre': [0, 0, 0]}",
         "/centre: is not known here; there are center, radius, transform, type");
  object("{'type': 'sphere', 'radius': 1, 'center': [0, 0]}", "/center: must be an array of 3");
  object("{'type': 'sphere', 'radius': 1, 'center': [0, 0, 'x']}", "/center/2: must be a number");
  object("{'type': 'ball', 'radius': 1}", "/type: must be one of union, ");
  object("{'radius': 1}", ": has no \"type\"");
  object("7", ": must be an object, not 7");
  object("{'type': 'box', 'size': [1, 0, 1]}", "/size/1: must be a number above 0");
  object("{'type': 'box', 'size': [1, 2, 3], 'rounding': 0.6}", "/rounding: must be at most half");
  object("{'type': 'polyline', 'points': [[0, 0, 0]], 'radius': 1}", "/points: must have two");
  object("{'type': 'plane', 'normal': [0, 0, 0]}", "/normal: must be a vector of some length");
  object("{'type': 'quadric', 'shape': 'egg'}", "/shape: must be one of cone, cylinder, ");
  object("{'type': 'quadric', 'coefficients': [1]}", "/coefficients: must be an array of 10");
  object("{'type': 'gyroid', 'period': 1, 'thickness': {'from': 1}}", "/thickness: has no \"to\"");
  object("{'type': 'expression', 'text': 'x +'}", "/text: at character 4");
  object("{'type': 'union', 'objects': []}", "/objects: must have one object or more");
  object("{'type': 'union', 'objects': [{'type': 'sphere', 'radius': false}]}",
         "/objects/0/radius: must be a number");
  object("{'type': 'difference', 'objects': 3}", "/objects: must be an array, not 3");
  object("{'type': 'complement'}", ": has no \"object\"");
  object("{'type': 'sphere', 'radius': 1, 'transform': [{'scale': 0}]}",
         "/transform/0/scale: must be a number above 0");
  object("{'type': 'sphere', 'radius': 1, 'transform': [{'turn': 0}]}",
         "/transform/0/turn: is not known here");
  object("{'type': 'sphere', 'radius': 1, 'transform': [{}]}", "/transform/0: must have one of");
  object("{'type': 'sphere', 'radius': 1, 'transform': [{'translate': [0, 0, 0], 'scale': 2}]}",
         "/transform/0: must have one of translate, rotate, scale and mirror, each step");
  object("{'type': 'repeat', 'object': {'type': 'plane'}, 'step': [1, 1, 1], 'count': [2, 1, 1]}",
         "/object: may go on for ever");
  object(
      "{'type': 'repeat', 'object': {'type': 'sphere', 'radius': 1}, 'step': [1, 1, 1],"
      " 'count': [2, 1, 1]}",
      "/step/0: must be at least the object's length of 2");
  object(
      "{'type': 'repeat', 'object': {'type': 'sphere', 'radius': 1}, 'step': [1, 1, 1],"
      " 'count': [0, 1, 1]}",
      "/count/0: must be a whole number from 1 ");
  object("{'type': 'metaballs'}", ": must have \"balls\" or a \"file\"");
  object("{'type': 'metaballs', 'balls': []}", "/balls: must name one ball or more");
  object("{'type': 'metaballs', 'balls': [{'center': [0, 0, 0], 'radius': 0}]}",
         "/balls/0/radius: must be a number above 0");
  object("{'type': 'metaballs', 'threshold': -1, 'balls': []}", "/threshold: must be a number");
  object("{'type': 'metaballs', 'kernel': 'x', 'balls': []}", "/kernel: must be one of blinn, ");
  object("{'type': 'metaballs', 'file': 'none.csv'}", "/file: cannot read none.csv");
  object("{'type': 'convolution', 'width': 0}", "/width: must be a number above 0");
  object("{'type': 'convolution', 'width': 1, 'skeleton': []}", "/skeleton: must have one part");
  object("{'type': 'convolution', 'width': 1, 'skeleton': [{}]}", "/skeleton/0: must have one of");
  object("{'type': 'convolution', 'width': 1, 'skeleton': [{'weight': 2}]}",
         "/skeleton/0: must have one of");
  object(
      "{'type': 'convolution', 'width': 1, 'skeleton': [{'polyline': [[0,0,0], [1,0,0]],"
      " 'weight': 2, 'triangle': [[0,0,0], [1,0,0], [0,1,0]]}]}",
      "/skeleton/0: must have one of polyline, triangle and arc");
  object("{'type': 'convolution', 'width': 1, 'skeleton': [{'polyline': [[0,0,0], [0,0,0]]}]}",
         "/skeleton/0/polyline/1: is the same point");
  object(
      "{'type': 'convolution', 'width': 1, 'kernel': 'gaussian', 'skeleton':"
      " [{'triangle': [[0,0,0], [1,0,0], [0,1,0]]}]}",
      "/skeleton/0/triangle: has a closed form with the kernel cauchy only");
  object(
      "{'type': 'convolution', 'width': 1, 'skeleton': [{'triangle': [[0,0,0], [1,0,0],"
      " [2,0,0]]}]}",
      "/skeleton/0/triangle: has its corners on a line");
  object(
      "{'type': 'convolution', 'width': 1, 'skeleton': [{'arc': {'start': [1, 0, 0],"
      " 'degrees': 361}}]}",
      "/skeleton/0/arc/degrees: must be at most 360");
  object(
      "{'type': 'convolution', 'width': 1, 'skeleton': [{'arc': {'start': [0, 0, 1],"
      " 'degrees': 90}}]}",
      "/skeleton/0/arc/start: lies on the axis");
  refused("{", "cannot read s.json: ");
  refused("[]", "/: must be an object");
  refused("{}", "has no \"tufa_scene\"");
  refused(R"({"tufa_scene": 2})", "/tufa_scene: must be 1");
  refused(R"({"tufa_scene": 1})", "has no \"objects\"");
  refused(R"({"tufa_scene": 1, "objects": []})", "/objects: must have one");
  refused(R"({"tufa_scene": 1, "objects": [{"type": "sphere", "radius": NaN}]})", "s.json: ");
  refused(R"({"tufa_scene": 1, "objects": [{"type": "sphere", "radius": 1e999}]})", "s.json: ");
  refused(sceneText("{'type': 'plane'}", ", 'bounds': [0, 0, 0, 1, 1, 0]"), "/bounds: must be");
  refused(sceneText("{'type': 'plane'}", ", 'voxel': 0"), "/voxel: must be a number above 0");
  refused(sceneText("{'type': 'plane'}", ", 'voxels': 1"), "/voxels: is not known here");
  refused(std::string("\xff\xfe{"), "s.json: ");
}

TEST(Scene, ReferencesThatGoWrongAreNamed) {
  const auto refused = [](const std::string& definitions, ErrorCode code, const std::string& part) {
    expectError(code, part, [&] {
      static_cast<void>(sceneOf(
          sceneText("{'type': 'use', 'name': 'a'}", ", 'definitions': {" + definitions + "}")));
    });
  };
  const std::string aUsesB = "'a': {'type': 'complement', 'object': {'type': 'use', 'name': 'b'}}";
  refused(aUsesB, ErrorCode::UnreadableFile, "/definitions/a/object/name: must be the name of one");
  refused(aUsesB + ", 'b': {'type': 'use', 'name': 'a'}", ErrorCode::UnreadableFile,
          "/definitions/b/name: the definition uses itself");
  refused("'a': {'type': 'use', 'name': 'a'}", ErrorCode::UnreadableFile, "uses itself");
  refused("'a': {'type': 'sphere', 'radius': 1}, 'c': {'type': 'sphere', 'radius': 0}",
          ErrorCode::UnreadableFile, "/definitions/c/radius");
  // A few lines that stand for 2^60 objects.
  std::string doubling =
      "'a': {'type': 'use', 'name': 'd60'}, 'd0': {'type': 'sphere', 'radius': 1}";
  for (int n = 1; n <= 60; ++n) {
    const std::string use = "{'type': 'use', 'name': 'd" + std::to_string(n - 1) + "'}";
    doubling +=
        ", 'd" + std::to_string(n) + "': {'type': 'union', 'objects': [" + use + "," + use + "]}";
  }
  refused(doubling, ErrorCode::LimitExceeded, "more than 1000000 objects");
  // A thousand objects in each other, though the text is flat.
  std::string chain = "'a': {'type': 'use', 'name': 'd999'}, 'd0': {'type': 'sphere', 'radius': 1}";
  for (int n = 1; n < 1000; ++n) {
    chain += ", 'd" + std::to_string(n) +
             "': {'type': 'complement', 'object': " + "{'type': 'use', 'name': 'd" +
             std::to_string(n - 1) + "'}}";
  }
  refused(chain, ErrorCode::UnreadableFile,
          "is one of more than 500 objects and transforms in each other");
}

/// Whether a definition was read before, or not, it is as deep as it is.
TEST(Scene, DefinitionsAreAsDeepInWhateverOrderTheyAreRead) {
  const auto chain = [](int length, const std::string& more, bool upward) {
    std::string objects;
    std::string definitions = "'d10000': {'type': 'sphere', 'radius': 1}";
    for (int n = 1; n <= length; ++n) {
      const std::string name = "'d" + std::to_string(10000 + n) + "'";
      definitions += ", " + name + ": {'type': 'use', 'name': 'd" + std::to_string(9999 + n) + "'" +
                     more + "}";
      if (upward && n < length) objects += "{'type': 'use', 'name': " + name + "}, ";
    }
    objects += "{'type': 'use', 'name': 'd" + std::to_string(10000 + length) + "'}";
    return sceneText(objects, ", 'definitions': {" + definitions + "}");
  };
  const std::string moved = ", 'transform': [{'translate': [1e-3, 0, 0]}]";
  for (const bool upward : {false, true}) {
    const auto refused = [&](int length, const std::string& more) {
      expectError(ErrorCode::UnreadableFile, "more than 500 objects and transforms",
                  [&] { static_cast<void>(sceneOf(chain(length, more, upward))); });
    };
    EXPECT_LT(sceneOf(chain(498, "", upward)).field->value({0, 0, 0}), 0);
    EXPECT_LT(sceneOf(chain(249, moved, upward)).field->value({0, 0, 0}), 0);
    refused(499, "");
    refused(250, moved);
    refused(10000, moved);
  }
}

TEST(Scene, DeepTreesAreReadOrRefused) {
  const auto nested = [](int depth) {
    std::string open;
    std::string close;
    for (int n = 0; n < depth; ++n) {
      open += "{'type': 'complement', 'object': ";
      close += "}";
    }
    return sceneText(open + "{'type': 'sphere', 'radius': 1}" + close);
  };
  EXPECT_LT(sceneOf(nested(90)).field->value({0, 0, 0}), 0);
  expectError(ErrorCode::UnreadableFile, "deeper than 100",
              [&] { static_cast<void>(sceneOf(nested(100000))); });
}

}  // namespace
}  // namespace tufa
