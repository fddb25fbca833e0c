// Scene files: the tree of their objects. docs/scenes.md describes the format.

#include <tufa/error.h>
#include <tufa/implicit.h>
#include <tufa/memory.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <utility>

#include "base/lattice_range.h"
#include "base/number_text.h"
#include "implicit/boxes.h"
#include "implicit/fields.h"
#include "implicit/scene_objects.h"
#include "implicit/scene_value.h"
#include "io/input_bytes.h"
#include "io/json_input.h"

namespace tufa::implicit {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostNodes = 1000000;
/// Objects and their transforms in each other: functions call themselves.
constexpr std::size_t kDeepestScene = 500;

/// Rows of the rotation about a unit axis (Rodrigues).
Affine rotation(const Vec3& axis, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  const double s = std::sin(angle);
  const double c = std::cos(angle);
  Affine map;
  for (std::size_t row = 0; row < 3; ++row) {
    Vec3 e(0.0);
    e[row] = 1;
    // The rows of a rotation are the axes turned back.
    map.rows[row] = e * c - axis.cross(e) * s + axis * (axis[row] * (1 - c));
  }
  return map;
}

Affine mirror(const Vec3& normal) {
  Affine map;
  for (std::size_t row = 0; row < 3; ++row) map.rows[row] -= normal * (2 * normal[row]);
  return map;
}

Affine readScale(const SceneValue& value) {
  Vec3 factors(1.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    factors[axis] = value.isNumber() ? value.above0() : value.at(axis).above0();
  }
  Affine map;
  for (std::size_t axis = 0; axis < 3; ++axis) map.rows[axis] *= factors[axis];
  return map;
}

/// One step of "transform": an object of one key.
Affine readStep(const SceneValue& value) {
  SceneObject object(value);
  if (value.json().size() != 1) {
    value.fail(
        "must have one of translate, rotate, scale and mirror, each step being an object of its "
        "own");
  }
  Affine map;
  if (const auto shift = object.find("translate")) {
    map.shift = shift->point();
  } else if (const auto turn = object.find("rotate")) {
    SceneObject how(*turn);
    map = rotation(how.at("axis").direction().unitOrX(), how.at("degrees").number());
    how.requireNoOther();
  } else if (const auto scale = object.find("scale")) {
    if (!scale->isNumber()) static_cast<void>(scale->point());
    map = readScale(*scale);
  } else if (const auto normal = object.find("mirror")) {
    map = mirror(normal->direction().unitOrX());
  }
  object.requireNoOther();
  return map;
}

/// Reads the objects of one scene.
class SceneReader {
 public:
  SceneReader(const SceneValue& root, std::filesystem::path folder)
      : object_(root), folder_(std::move(folder)) {
    if (const auto definitions = object_.find("definitions")) {
      SceneObject named(*definitions);
      for (const auto& item : definitions->json().items()) {
        definitions_.emplace(item.key(), named.at(item.key()));
      }
    }
  }

  Scene read(const std::optional<Box>& bounds) {
    constexpr double kVersion = 1;
    const SceneValue version = object_.at("tufa_scene");
    if (!version.isNumber() || version.number() != kVersion) {
      version.failWith("1, the version of the format that this program reads");
    }
    Scene scene;
    scene.name = "surface";
    if (const auto name = object_.find("name")) scene.name = name->text();
    if (const auto voxel = object_.find("voxel")) scene.voxelSize = voxel->above0();
    if (const auto width = object_.find("half_width")) scene.halfWidth = halfWidthOf(*width);
    std::optional<Box> limits = bounds;
    if (const auto own = object_.find("bounds")) {
      const Box box = readBounds(*own);
      if (!limits) limits = box;
    }
    const ReadField all = readList(object_.at("objects"), Operation::Union, 0, 0);
    // What nothing uses is read too: it may be wrong.
    for (const auto& [name, value] : definitions_) static_cast<void>(resolve(name, value, 0));
    object_.requireNoOther();
    scene.field = limits ? cut(all.field, *limits) : all.field;
    scene.nodes = all.nodes;
    return scene;
  }

 private:
  static double halfWidthOf(const SceneValue& value) {
    const double width = value.number();
    if (!base::isHalfWidth(width)) {
      value.failWith("a number of voxels from 1 to " + base::numberText(base::kMostHalfWidth));
    }
    return width;
  }

  static Box readBounds(const SceneValue& value) {
    const std::vector<double> n = value.numbers(6);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(n[axis] < n[axis + 3])) {
        value.fail("must be a corner and the opposite one, each coordinate less than its other");
      }
    }
    return {Position(n[0], n[1], n[2]), Position(n[3], n[4], n[5])};
  }

  /// The part in a box, closed by its sides unless all of it lies inside.
  static FieldPtr cut(const FieldPtr& field, const Box& bounds) {
    const Box extent = field->extent();
    const Box inner = both(extent, bounds);
    if (inner.least == extent.least && inner.greatest == extent.greatest) return field;
    return combine(Operation::Intersection, {field, makeBox(centreOf(bounds), halfOf(bounds), 0)},
                   0);
  }

  void count(const SceneValue& value, std::size_t nodes) const {
    if (nodes <= kMostNodes) return;
    throw Error(ErrorCode::LimitExceeded, "the scene " + value.input().name() + " has more than " +
                                              std::to_string(kMostNodes) + " objects in all");
  }

  ReadField readList(const SceneValue& list, Operation operation, double radius,
                     std::size_t depth) {
    std::vector<FieldPtr> parts;
    ReadField all;
    for (const SceneValue& value : list.list()) {
      ReadField part = readObject(value, depth + 1);
      all.nodes += part.nodes;
      all.depth = std::max(all.depth, part.depth + 1);
      count(value, all.nodes);
      parts.push_back(std::move(part.field));
    }
    if (parts.empty()) list.fail("must have one object or more");
    all.field = combine(operation, std::move(parts), radius);
    return all;
  }

  ReadField readObject(const SceneValue& value, std::size_t depth) {
    requireDepth(value, depth);
    SceneObject object(value);
    ReadField read = readType(object, depth);
    if (const auto steps = object.find("transform")) {
      Affine map;
      for (const SceneValue& step : steps->list()) map = map.then(readStep(step));
      const double size = std::cbrt(std::abs(map.determinant()));
      if (!(size >= 1e-9 && size <= 1e9)) steps->fail("scales out of all proportion");
      read.field = transformed(std::move(read.field), map);
      ++read.depth;
    }
    object.requireNoOther();
    // Definitions read before are as deep as they are, wherever they are used.
    requireDepth(value, depth + read.depth);
    return read;
  }

  static void requireDepth(const SceneValue& value, std::size_t depth) {
    if (depth <= kDeepestScene) return;
    value.fail("is one of more than " + std::to_string(kDeepestScene) +
               " objects and transforms in each other");
  }

  ReadField readType(SceneObject& object, std::size_t depth) {
    const SceneValue type = object.at("type");
    const std::string name = type.text();
    if (name == "use") {
      const SceneValue target = object.at("name");
      const auto found = definitions_.find(target.text());
      if (found == definitions_.end()) target.failWith("the name of one of the definitions");
      if (open_.contains(found->first)) target.fail("the definition uses itself");
      ReadField read = resolve(found->first, found->second, depth);
      ++read.depth;
      return read;
    }
    if (name == "union" || name == "intersection" || name == "difference") {
      return readCombination(name, object, depth);
    }
    if (name == "complement" || name == "offset" || name == "shell" || name == "repeat") {
      return readChange(name, object, depth);
    }
    FieldPtr field = readPrimitive(name, object, folder_);
    if (!field) {
      type.failWith(
          "one of union, intersection, difference, complement, offset, shell, repeat, "
          "use, " +
          primitiveNames());
    }
    return {std::move(field)};
  }

  /// A definition: read once, used any number of times.
  ReadField resolve(const std::string& name, const SceneValue& value, std::size_t depth) {
    const auto known = resolved_.find(name);
    if (known != resolved_.end()) return known->second;
    open_.insert(name);
    const ReadField read = readObject(value, depth + 1);
    open_.erase(name);
    resolved_.emplace(name, read);
    return read;
  }

  ReadField readCombination(const std::string& name, SceneObject& object, std::size_t depth) {
    const double radius = object.notBelow0Or("radius", 0);
    const SceneValue objects = object.at("objects");
    if (name == "union") return readList(objects, Operation::Union, radius, depth);
    if (name == "intersection") return readList(objects, Operation::Intersection, radius, depth);
    std::vector<FieldPtr> parts;
    ReadField all;
    for (const SceneValue& value : objects.list()) {
      ReadField part = readObject(value, depth + 1);
      all.nodes += part.nodes;
      all.depth = std::max(all.depth, part.depth + 1);
      count(value, all.nodes);
      parts.push_back(parts.empty() ? std::move(part.field) : makeComplement(part.field));
    }
    if (parts.empty()) objects.fail("must have one object or more");
    all.field = combine(Operation::Intersection, std::move(parts), radius);
    return all;
  }

  ReadField readChange(const std::string& name, SceneObject& object, std::size_t depth) {
    const SceneValue part = object.at("object");
    ReadField read = readObject(part, depth + 1);
    if (name == "complement") {
      read.field = makeComplement(read.field);
    } else if (name == "offset") {
      read.field = makeOffset(read.field, object.at("distance").number());
    } else if (name == "shell") {
      read.field = makeShell(read.field, object.at("thickness").above0());
      read.nodes *= 2;
    } else {
      read.field = readRepeat(object, read.field);
    }
    ++read.nodes;
    ++read.depth;
    count(part, read.nodes);
    return read;
  }

  static FieldPtr readRepeat(SceneObject& object, const FieldPtr& part) {
    const SceneValue step = object.at("step");
    const SceneValue count = object.at("count");
    const Vec3 steps = step.point();
    static_cast<void>(count.numbers(3));
    const Box extent = part->extent();
    if (!isFinite(extent)) object.at("object").fail("may go on for ever: it cannot be repeated");
    std::array<std::int64_t, 3> counts{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      counts[axis] = static_cast<std::int64_t>(count.at(axis).count());
      const double length = 2 * halfOf(extent)[axis];
      if (counts[axis] > 1 && !(steps[axis] >= length * (1 - 1e-9) && steps[axis] > 0)) {
        step.at(axis).failWith("at least the object's length of " + base::numberText(length));
      }
    }
    return repeated(part, steps, counts);
  }

  SceneObject object_;
  std::filesystem::path folder_;
  std::map<std::string, SceneValue> definitions_;
  std::map<std::string, ReadField> resolved_;
  std::set<std::string> open_;  ///< definitions that are being read
};

Scene readScene(const io::InputBytes& input, const std::filesystem::path& folder,
                const std::optional<Box>& bounds) {
  if (bounds) {
    const Vec3 size = Vec3(bounds->greatest) - Vec3(bounds->least);
    if (!(isFinite(*bounds) && size[0] > 0 && size[1] > 0 && size[2] > 0)) {
      throw Error(ErrorCode::InvalidArgument,
                  "bounds must be a corner and the opposite one, each coordinate less than its "
                  "other");
    }
  }
  Json json;
  try {
    json = io::parseJson<Json>(input.view(), input);
  } catch (const Json::exception& error) {
    input.fail(error.what());
  }
  return SceneReader(SceneValue(json, "", input), folder).read(bounds);
}

}  // namespace

Scene readScene(const std::filesystem::path& path, const std::optional<Box>& bounds) {
  return readScene(io::InputBytes(path), path.parent_path(), bounds);
}

Scene readScene(const FileBytes& file, const std::optional<Box>& bounds) {
  return readScene(io::InputBytes(file), {}, bounds);
}

}  // namespace tufa::implicit
