#include "shapes/bracket_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tufa::shapes::bracket {
namespace {

Face makeFace(std::vector<Vec3> corners, std::vector<Cylinder> holes = {}) {
  Face face;
  face.u = (corners[1] - corners[0]).unit();
  face.normal = face.u.cross((corners[2] - corners[1]).unit()).unit();
  face.v = face.normal.cross(face.u);
  face.corners = std::move(corners);
  face.holes = std::move(holes);
  return face;
}

std::vector<Cylinder> baseHoles() {
  const Vec3 up(0, 0, 1);
  const double height = kBaseTop - kLow;
  return {{Vec3(0.5, 0.27, kLow), up, 0.12, height}, {Vec3(0.5, -0.27, kLow), up, 0.12, height}};
}

std::vector<Cylinder> uprightHoles() {
  const Vec3 along(1, 0, 0);
  const double height = kUprightFront - kBack;
  return {{Vec3(kBack, 0.28, 0.1), along, 0.11, height},
          {Vec3(kBack, -0.28, 0.1), along, 0.11, height},
          {Vec3(kBack, 0, 0.53), along, 0.1, height}};
}

std::vector<Cylinder> ribHoles() {
  return {{Vec3(-0.4, -kHalfRib, -0.2), Vec3(0, 1, 0), 0.1, 2 * kHalfRib}};
}

Face atX(double x, const std::vector<std::array<double, 2>>& yz, std::vector<Cylinder> holes = {}) {
  std::vector<Vec3> corners;
  for (const auto& [y, z] : yz) corners.emplace_back(x, y, z);
  return makeFace(std::move(corners), std::move(holes));
}

Face atY(double y, const std::vector<std::array<double, 2>>& xz, std::vector<Cylinder> holes = {}) {
  std::vector<Vec3> corners;
  for (const auto& [x, z] : xz) corners.emplace_back(x, y, z);
  return makeFace(std::move(corners), std::move(holes));
}

Face atZ(double z, const std::vector<std::array<double, 2>>& xy, std::vector<Cylinder> holes = {}) {
  std::vector<Vec3> corners;
  for (const auto& [x, y] : xy) corners.emplace_back(x, y, z);
  return makeFace(std::move(corners), std::move(holes));
}

std::vector<Face> makeFaces() {
  constexpr double d = kHalfDepth;
  constexpr double r = kHalfRib;
  std::vector<Face> faces;
  faces.push_back(atZ(kLow, {{kBack, -d}, {kFront, -d}, {kFront, d}, {kBack, d}}, baseHoles()));
  faces.push_back(atX(kBack, {{-d, kLow}, {d, kLow}, {d, kHigh}, {-d, kHigh}}, uprightHoles()));
  faces.push_back(atX(kFront, {{-d, kLow}, {d, kLow}, {d, kBaseTop}, {-d, kBaseTop}}));
  faces.push_back(atZ(kHigh, {{kBack, -d}, {kUprightFront, -d}, {kUprightFront, d}, {kBack, d}}));
  for (const double y : {-d, d}) {
    faces.push_back(atY(y, {{kBack, kLow},
                            {kFront, kLow},
                            {kFront, kBaseTop},
                            {kUprightFront, kBaseTop},
                            {kUprightFront, kHigh},
                            {kBack, kHigh}}));
  }
  // The top of the base plate and the front of the upright go around the foot of the rib.
  faces.push_back(atZ(kBaseTop,
                      {{kUprightFront, -d},
                       {kFront, -d},
                       {kFront, d},
                       {kUprightFront, d},
                       {kUprightFront, r},
                       {kRibEnd, r},
                       {kRibEnd, -r},
                       {kUprightFront, -r}},
                      baseHoles()));
  faces.push_back(atX(kUprightFront,
                      {{d, kBaseTop},
                       {d, kHigh},
                       {-d, kHigh},
                       {-d, kBaseTop},
                       {-r, kBaseTop},
                       {-r, kRibTop},
                       {r, kRibTop},
                       {r, kBaseTop}},
                      uprightHoles()));
  for (const double y : {-r, r}) {
    faces.push_back(atY(
        y, {{kUprightFront, kBaseTop}, {kRibEnd, kBaseTop}, {kUprightFront, kRibTop}}, ribHoles()));
  }
  faces.push_back(makeFace({Vec3(kRibEnd, -r, kBaseTop), Vec3(kRibEnd, r, kBaseTop),
                            Vec3(kUprightFront, r, kRibTop), Vec3(kUprightFront, -r, kRibTop)}));
  return faces;
}

/// The outlines of all faces, each edge once.
std::vector<Segment> makeEdges(const std::vector<Face>& faces) {
  std::vector<Segment> edges;
  for (const Face& face : faces) {
    for (std::size_t n = 0; n < face.corners.size(); ++n) {
      const Vec3& a = face.corners[n];
      const Vec3& b = face.corners[(n + 1) % face.corners.size()];
      const bool known = std::any_of(edges.begin(), edges.end(), [&](const Segment& edge) {
        return (edge.a == a && edge.b == b) || (edge.a == b && edge.b == a);
      });
      if (!known) edges.push_back({a, b});
    }
  }
  return edges;
}

}  // namespace

double Segment::distance(const Vec3& p) const {
  const Vec3 along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.lengthSqr(), 0.0, 1.0);
  return (p - a - along * t).length();
}

double Cylinder::axisDistance(const Vec3& p) const {
  const Vec3 offset = p - start;
  return (offset - axis * offset.dot(axis)).length();
}

double Cylinder::distance(const Vec3& p) const {
  const double along = (p - start).dot(axis);
  return std::hypot(axisDistance(p) - radius, along - std::clamp(along, 0.0, height));
}

double Face::planeDistance(const Vec3& p) const { return std::abs((p - corners[0]).dot(normal)); }

bool Face::covers(const Vec3& p) const {
  const double pu = (p - corners[0]).dot(u);
  const double pv = (p - corners[0]).dot(v);
  bool inside = false;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const Vec3 a = corners[n] - corners[0];
    const Vec3 b = corners[(n + 1) % corners.size()] - corners[0];
    const double av = a.dot(v);
    const double bv = b.dot(v);
    if ((av > pv) == (bv > pv)) continue;
    const double crossing = a.dot(u) + (pv - av) / (bv - av) * (b.dot(u) - a.dot(u));
    if (pu < crossing) inside = !inside;
  }
  return inside && std::none_of(holes.begin(), holes.end(), [&](const Cylinder& hole) {
           return hole.axisDistance(p) < hole.radius;
         });
}

const Parts& Parts::get() {
  static const Parts parts = [] {
    Parts all;
    all.faces = makeFaces();
    all.edges = makeEdges(all.faces);
    for (const auto& group : {baseHoles(), uprightHoles(), ribHoles()}) {
      all.holes.insert(all.holes.end(), group.begin(), group.end());
    }
    return all;
  }();
  return parts;
}

double Parts::boundaryDistance(const Vec3& p) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Segment& edge : edges) least = std::min(least, edge.distance(p));
  for (const Cylinder& hole : holes) least = std::min(least, hole.distance(p));
  for (const Face& face : faces) {
    const double distance = face.planeDistance(p);
    if (distance < least && face.covers(p)) least = distance;
  }
  return least;
}

Parts Parts::near(const Vec3& center, double radius) const {
  // Whatever is nearest to a point of the ball is at most this far from the ball's centre.
  const double reach = boundaryDistance(center) + 2 * radius;
  Parts part;
  std::copy_if(edges.begin(), edges.end(), std::back_inserter(part.edges),
               [&](const Segment& edge) { return edge.distance(center) <= reach; });
  std::copy_if(holes.begin(), holes.end(), std::back_inserter(part.holes),
               [&](const Cylinder& hole) { return hole.distance(center) <= reach; });
  std::copy_if(faces.begin(), faces.end(), std::back_inserter(part.faces),
               [&](const Face& face) { return face.planeDistance(center) <= reach; });
  return part;
}

}  // namespace tufa::shapes::bracket
