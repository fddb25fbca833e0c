#include "implicit/scene_skeletons.h"

#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/memory.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "implicit/convolution.h"
#include "implicit/metaballs.h"
#include "io/input_bytes.h"

namespace tufa::implicit {
namespace {

template <class Kernel>
Kernel readKernel(SceneObject& object, const std::map<std::string, Kernel>& kernels,
                  Kernel otherwise) {
  const auto value = object.find("kernel");
  if (!value) return otherwise;
  const auto found = kernels.find(value->text());
  if (found != kernels.end()) return found->second;
  std::string names;
  for (const auto& [name, kernel] : kernels) names += (names.empty() ? "" : ", ") + name;
  value->failWith("one of " + names);
}

double above0Or(SceneObject& object, const char* key, double otherwise) {
  const auto value = object.find(key);
  return value ? value->above0() : otherwise;
}

/// Columns x, y, z and perhaps radius and weight, with commas, semicolons or blanks between them. A
/// first line of words is a heading; # begins a comment.
std::vector<Metaball> readTable(const std::filesystem::path& path, const Metaball& usual) {
  const io::InputBytes file(path);
  std::string text(file.view());
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
  const io::InputBytes spaced(FileBytes{text, path.string()});
  io::TextCursor cursor(spaced, 0, 1);
  std::vector<Metaball> balls;
  bool first = true;
  while (cursor.nextContentLine()) {
    const std::string_view word = cursor.nextWord();
    const bool heading = first && std::isalpha(static_cast<unsigned char>(word.front())) != 0;
    first = false;
    if (heading) continue;
    Metaball ball = usual;
    ball.centre[0] = cursor.parseNumber(word);
    ball.centre[1] = cursor.nextNumber();
    ball.centre[2] = cursor.nextNumber();
    if (const auto radius = cursor.nextWord(); !radius.empty()) {
      ball.radius = cursor.parseNumber(radius);
    }
    if (const auto weight = cursor.nextWord(); !weight.empty()) {
      ball.weight = cursor.parseNumber(weight);
    }
    if (!cursor.nextWord().empty()) cursor.fail("has more than x, y, z, radius and weight");
    balls.push_back(ball);
  }
  return balls;
}

std::vector<Metaball> readPoints(const std::filesystem::path& path, const Metaball& usual) {
  if (!io::sameWord(path.extension().string(), ".ply")) return readTable(path, usual);
  std::vector<Metaball> balls;
  for (const Position& p : readMesh(path).positions) {
    balls.push_back({p, usual.radius, usual.weight});
  }
  return balls;
}

/// Throws unless balls of a file are such as the scene itself may have.
void requireUsable(const std::vector<Metaball>& balls, const SceneValue& from) {
  constexpr double kMost = 1e12;
  if (balls.empty()) from.fail("must name one ball or more");
  for (std::size_t n = 0; n < balls.size(); ++n) {
    const Metaball& ball = balls[n];
    const auto usable = [](double x) { return std::abs(x) <= kMost; };
    if (usable(ball.centre[0]) && usable(ball.centre[1]) && usable(ball.centre[2]) &&
        usable(ball.weight) && ball.radius >= 1 / kMost && ball.radius <= kMost) {
      continue;
    }
    from.fail("ball " + std::to_string(n + 1) +
              " needs a radius above 0, and no number beyond 1e+12");
  }
}

std::vector<Metaball> readBallFile(const SceneValue& name, const std::filesystem::path& folder,
                                   const Metaball& usual) {
  try {
    return readPoints(folder / std::filesystem::path(name.text()), usual);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::UnreadableFile) throw;
    name.fail(error.what());
  }
}

SkeletonSegment readSegment(const SceneValue& from, const SceneValue& to) {
  SkeletonSegment segment{from.point(), to.point()};
  if (!((segment.b - segment.a).length() >= 1e-12)) to.fail("is the same point as the one before");
  return segment;
}

SkeletonTriangle readTriangle(const SceneValue& corners) {
  const std::vector<SceneValue> all = corners.list();
  if (all.size() != 3) corners.fail("must have three points");
  SkeletonTriangle triangle{all[0].point(), all[1].point(), all[2].point()};
  const Vec3 u = triangle.b - triangle.a;
  const Vec3 v = triangle.c - triangle.a;
  if (!(u.cross(v).length() > 1e-9 * u.length() * v.length())) {
    corners.fail("has its corners on a line");
  }
  return triangle;
}

SkeletonArc readArc(const SceneValue& value) {
  SceneObject object(value);
  SkeletonArc arc;
  arc.centre = object.pointOr("center", Vec3(0.0));
  const auto axis = object.find("normal");
  arc.axis = (axis ? axis->direction() : Vec3(0, 0, 1)).unitOrX();
  const SceneValue start = object.at("start");
  const Vec3 offset = start.point() - arc.centre;
  arc.start = offset - arc.axis * arc.axis.dot(offset);
  if (!(arc.start.length() >= 1e-12)) start.fail("lies on the axis of the arc");
  if (std::abs(arc.axis.dot(offset)) > 1e-6 * arc.start.length()) {
    start.fail("does not lie in the plane of the arc");
  }
  const SceneValue degrees = object.at("degrees");
  arc.angle = degrees.above0() * std::numbers::pi / 180;
  if (arc.angle > 2 * std::numbers::pi * (1 + 1e-12)) degrees.failWith("at most 360");
  object.requireNoOther();
  return arc;
}

/// One entry of "skeleton": a shape under its name, and perhaps a weight.
void readPart(const SceneValue& value, ConvolutionKernel kernel, std::vector<SkeletonPart>& parts) {
  SceneObject object(value);
  const double weight = object.numberOr("weight", 1);
  if (const auto points = object.find("polyline")) {
    const std::vector<SceneValue> all = points->list();
    for (std::size_t n = 1; n < all.size(); ++n) {
      parts.push_back({readSegment(all[n - 1], all[n]), weight});
    }
    if (all.size() < 2) points->fail("must have two points or more");
  }
  const auto triangle = object.find("triangle");
  const auto arc = object.find("arc");
  for (const auto& shape : {triangle, arc}) {
    if (shape && kernel != ConvolutionKernel::Cauchy) {
      shape->fail("has a closed form with the kernel cauchy only");
    }
  }
  if (triangle) parts.push_back({readTriangle(*triangle), weight});
  if (arc) parts.push_back({readArc(*arc), weight});
  object.requireNoOther();
  const std::size_t due = object.has("weight") ? 2 : 1;
  if (value.json().size() != due) value.fail("must have one of polyline, triangle and arc");
}

}  // namespace

FieldPtr readMetaballs(SceneObject& object, const std::filesystem::path& folder) {
  MetaballOptions options;
  options.kernel = readKernel<BallKernel>(object,
                                          {{"blinn", BallKernel::Blinn},
                                           {"nishimura", BallKernel::Nishimura},
                                           {"wyvill", BallKernel::Wyvill}},
                                          options.kernel);
  options.threshold = above0Or(object, "threshold", options.threshold);
  options.blobbiness = above0Or(object, "blobbiness", options.blobbiness);
  Metaball usual;
  usual.radius = above0Or(object, "radius", usual.radius);
  usual.weight = object.numberOr("weight", usual.weight);
  std::vector<Metaball> balls;
  if (const auto list = object.find("balls")) {
    for (const SceneValue& value : list->list()) {
      SceneObject one(value);
      Metaball ball;
      ball.centre = one.at("center").point();
      ball.radius = above0Or(one, "radius", usual.radius);
      ball.weight = one.numberOr("weight", usual.weight);
      one.requireNoOther();
      balls.push_back(ball);
    }
    requireUsable(balls, *list);
  }
  if (const auto file = object.find("file")) {
    const std::vector<Metaball> read = readBallFile(*file, folder, usual);
    requireUsable(read, *file);
    balls.insert(balls.end(), read.begin(), read.end());
  }
  if (balls.empty()) object.value().fail("must have \"balls\" or a \"file\" of them");
  return makeMetaballs(std::move(balls), options);
}

FieldPtr readConvolution(SceneObject& object) {
  ConvolutionOptions options;
  options.kernel = readKernel<ConvolutionKernel>(object,
                                                 {{"cauchy", ConvolutionKernel::Cauchy},
                                                  {"gaussian", ConvolutionKernel::Gaussian},
                                                  {"polynomial", ConvolutionKernel::Polynomial}},
                                                 options.kernel);
  options.width = object.at("width").above0();
  options.threshold = above0Or(object, "threshold", options.threshold);
  const SceneValue skeleton = object.at("skeleton");
  std::vector<SkeletonPart> parts;
  for (const SceneValue& value : skeleton.list()) readPart(value, options.kernel, parts);
  if (parts.empty()) skeleton.fail("must have one part or more");
  return makeConvolution(parts, options);
}

}  // namespace tufa::implicit
