#include "implicit/scene_objects.h"

#include <tufa/error.h>
#include <tufa/io.h>
#include <cmath>
#include <map>

#include "base/job.h"
#include "implicit/mesh_distance.h"
#include "implicit/scene_skeletons.h"
#include "implicit/solid_mesh.h"

namespace tufa::implicit {
namespace {

const Vec3 kOrigin(0.0);
const Vec3 kUp(0, 0, 1);

FieldPtr readSphere(SceneObject& object) {
  return makeSphere(object.pointOr("center", kOrigin), object.at("radius").above0());
}

FieldPtr readSegment(SceneObject& object) {
  const Vec3 from = object.at("from").point();
  return makeSegment(from, object.at("to").point(), object.at("radius").above0());
}

FieldPtr readPolyline(SceneObject& object) {
  const SceneValue points = object.at("points");
  std::vector<Vec3> all;
  for (const SceneValue& point : points.list()) all.push_back(point.point());
  if (all.size() < 2) points.fail("must have two points or more");
  return makePolyline(all, object.at("radius").above0());
}

FieldPtr readCircle(SceneObject& object) {
  const auto normal = object.find("normal");
  return makeCircle(object.pointOr("center", kOrigin), normal ? normal->direction() : kUp,
                    object.at("radius").above0(), object.at("tube").above0());
}

FieldPtr readBox(SceneObject& object) {
  const SceneValue size = object.at("size");
  Vec3 half = size.point() * 0.5;
  for (std::size_t axis = 0; axis < 3; ++axis) half[axis] = size.at(axis).above0() / 2;
  const double rounding = object.notBelow0Or("rounding", 0);
  if (rounding > std::min({half[0], half[1], half[2]})) {
    object.at("rounding").failWith("at most half the shortest side");
  }
  return makeBox(object.pointOr("center", kOrigin), half, rounding);
}

FieldPtr readPlane(SceneObject& object) {
  const auto normal = object.find("normal");
  return makePlane(object.pointOr("point", kOrigin), normal ? normal->direction() : kUp);
}

FieldPtr readCylinder(SceneObject& object) {
  const Vec3 from = object.at("from").point();
  const SceneValue to = object.at("to");
  if (!((to.point() - from).length() >= 1e-12)) to.fail("is the same point as \"from\"");
  return makeCylinder(from, to.point(), object.at("radius").above0());
}

/// In units of the radii around the centre: coefficients of u², v², w², w and 1.
struct UnitQuadric {
  double u, v, w, linear, constant;
};

FieldPtr readNamedQuadric(SceneObject& object) {
  static const std::map<std::string, UnitQuadric> kNames = {
      {"sphere", {1, 1, 1, 0, -1}},     {"ellipsoid", {1, 1, 1, 0, -1}},
      {"cylinder", {1, 1, 0, 0, -1}},   {"cone", {1, 1, -1, 0, 0}},
      {"paraboloid", {1, 1, 0, -1, 0}}, {"hyperboloid", {1, 1, -1, 0, -1}},
      {"two_sheets", {1, 1, -1, 0, 1}}};
  const SceneValue shape = object.at("shape");
  const auto found = kNames.find(shape.text());
  if (found == kNames.end()) {
    std::string names;
    for (const auto& [name, quadric] : kNames) names += (names.empty() ? "" : ", ") + name;
    shape.failWith("one of " + names);
  }
  const UnitQuadric& q = found->second;
  const Vec3 c = object.pointOr("center", kOrigin);
  Vec3 r(1.0);
  if (const auto radii = object.find("radii")) {
    r = radii->point();
    for (std::size_t axis = 0; axis < 3; ++axis) r[axis] = radii->at(axis).above0();
  }
  const Vec3 s(q.u / (r[0] * r[0]), q.v / (r[1] * r[1]), q.w / (r[2] * r[2]));
  const double l = q.linear / r[2];
  return makeQuadric(
      {s[0], s[1], s[2], 0, 0, 0, -2 * s[0] * c[0], -2 * s[1] * c[1], -2 * s[2] * c[2] + l,
       s[0] * c[0] * c[0] + s[1] * c[1] * c[1] + s[2] * c[2] * c[2] - l * c[2] + q.constant});
}

FieldPtr readQuadric(SceneObject& object) {
  const auto coefficients = object.find("coefficients");
  if (!coefficients) return readNamedQuadric(object);
  QuadricCoefficients all{};
  const std::vector<double> numbers = coefficients->numbers(all.size());
  std::copy(numbers.begin(), numbers.end(), all.begin());
  return makeQuadric(all);
}

Ramp readThickness(const SceneValue& value) {
  Ramp ramp;
  if (value.isNumber()) {
    ramp.from = ramp.to = value.above0();
    return ramp;
  }
  SceneObject object(value);
  ramp.from = object.at("from").above0();
  ramp.to = object.at("to").above0();
  ramp.start = object.at("start").point();
  const SceneValue end = object.at("end");
  ramp.end = end.point();
  if (!((ramp.end - ramp.start).length() >= 1e-12)) end.fail("is the same point as \"start\"");
  object.requireNoOther();
  return ramp;
}

FieldPtr readLattice(Lattice lattice, SceneObject& object) {
  const double period = object.at("period").above0();
  if (const auto thickness = object.find("thickness")) {
    return makeSheet(lattice, period, readThickness(*thickness));
  }
  return makeLattice(lattice, period, object.numberOr("level", 0));
}

FieldPtr readExpression(SceneObject& object) {
  const SceneValue text = object.at("text");
  try {
    return makeExpression(text.text());
  } catch (const Error& error) {
    if (error.code() != ErrorCode::InvalidArgument) throw;
    text.fail(error.what());
  }
}

FieldPtr readMeshObject(SceneObject& object, const std::filesystem::path& folder) {
  const SceneValue file = object.at("file");
  std::optional<double> thickness;
  if (const auto sheet = object.find("thickness")) thickness = sheet->above0();
  const std::filesystem::path path = folder / std::filesystem::path(file.text());
  try {
    const Mesh mesh = readMesh(path);
    if (thickness) return makeMeshSheet(mesh, *thickness);
    base::Job job(0, {});
    job.run([&] { requireSolid(mesh, job); });
    return makeMeshSolid(mesh);
  } catch (const Error& error) {
    const ErrorCode code = error.code();
    if (code != ErrorCode::UnreadableFile && code != ErrorCode::InvalidArgument) throw;
    file.fail(error.what());
  }
}

/// Those that read another file, from the scene's folder.
using FileReader = FieldPtr (*)(SceneObject&, const std::filesystem::path&);

const std::map<std::string, FileReader>& fileReaders() {
  static const std::map<std::string, FileReader> kReaders = {{"mesh", readMeshObject},
                                                             {"metaballs", readMetaballs}};
  return kReaders;
}

using Reader = FieldPtr (*)(SceneObject&);

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> kReaders = {
      {"sphere", readSphere},
      {"segment", readSegment},
      {"polyline", readPolyline},
      {"circle", readCircle},
      {"box", readBox},
      {"plane", readPlane},
      {"cylinder", readCylinder},
      {"quadric", readQuadric},
      {"gyroid", [](SceneObject& o) { return readLattice(Lattice::Gyroid, o); }},
      {"schwarz_p", [](SceneObject& o) { return readLattice(Lattice::Primitive, o); }},
      {"schwarz_d", [](SceneObject& o) { return readLattice(Lattice::Diamond, o); }},
      {"expression", readExpression},
      {"convolution", readConvolution},
  };
  return kReaders;
}

}  // namespace

FieldPtr readPrimitive(const std::string& type, SceneObject& object,
                       const std::filesystem::path& folder) {
  if (const auto reader = fileReaders().find(type); reader != fileReaders().end()) {
    return reader->second(object, folder);
  }
  const auto reader = readers().find(type);
  return reader == readers().end() ? nullptr : reader->second(object);
}

std::string primitiveNames() {
  std::string names;
  for (const auto& [name, reader] : fileReaders()) names += (names.empty() ? "" : ", ") + name;
  for (const auto& [name, reader] : readers()) names += ", " + name;
  return names;
}

}  // namespace tufa::implicit
