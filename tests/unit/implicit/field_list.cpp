#include "unit/implicit/field_list.h"

#include <utility>

#include "implicit/convolution.h"
#include "implicit/fields.h"
#include "implicit/mesh_distance.h"
#include "implicit/metaballs.h"

namespace tufa::test {

using namespace implicit;  // NOLINT: all of it is about them

Mesh spikes() {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const int x : {0, 1}) {
    for (const int y : {0, 1}) {
      for (const int z : {0, 1}) {
        const auto a = static_cast<VertexIndex>(x);
        const auto b = static_cast<VertexIndex>(2 + y);
        const auto c = static_cast<VertexIndex>(4 + z);
        const auto tip = static_cast<VertexIndex>(mesh.positions.size());
        const double height = (x + y + z) % 2 == 0 ? 0.9 : 0.2;
        mesh.positions.emplace_back(height * (1 - 2 * x), height * (1 - 2 * y),
                                    height * (1 - 2 * z));
        const bool turned = (x + y + z) % 2 != 0;
        for (auto [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
          if (turned) std::swap(p, q);
          mesh.triangles.emplace_back(p, q, tip);
        }
      }
    }
  }
  return mesh;
}

std::vector<NamedField> allFields() {
  const FieldPtr sphere = makeSphere({0.1, 0.2, -0.1}, 0.9);
  const FieldPtr box = makeBox({0.2, 0, 0.1}, {0.8, 0.6, 0.5}, 0);
  const FieldPtr ball = makeQuadric({1, 1.5, 2, 0.3, -0.2, 0.1, 0.2, 0, -0.1, -1});
  Affine turn;
  turn.rows = {Vec3(0.36, 0.48, -0.8), Vec3(-0.8, 0.6, 0), Vec3(0.48, 0.64, 0.6)};
  turn.shift = {0.1, -0.2, 0.3};
  Affine stretch = turn;
  stretch.rows[0] *= 2;
  stretch.rows[2] *= -0.5;
  std::vector<FieldPtr> many;
  for (int n = 0; n < 40; ++n) {
    many.push_back(makeSphere({0.05 * n - 1, 0.3 * (n % 5) - 0.6, 0.2 * (n % 7) - 0.6}, 0.15));
  }
  std::vector<NamedField> all = {
      {"sphere", sphere},
      {"segment", makeSegment({-0.5, 0, 0.2}, {0.7, 0.4, -0.3}, 0.3)},
      {"polyline", makePolyline({{-1, 0, 0}, {0, 0.5, 0}, {0.2, -0.8, 0.4}, {1, 1, 0.1}}, 0.2)},
      {"circle", makeCircle({0, 0.1, 0.2}, {1, 2, 2}, 0.8, 0.3)},
      {"circle of a thick tube", makeCircle({0, 0.1, 0.2}, {1, 2, 2}, 0.4, 0.9)},
      {"box", box},
      {"round box", makeBox({0.2, 0, 0.1}, {0.8, 0.6, 0.5}, 0.25)},
      {"plane", makePlane({0.1, 0.2, 0.3}, {1, -2, 0.5})},
      {"cylinder", makeCylinder({-0.4, -0.3, -0.6}, {0.5, 0.1, 0.7}, 0.5)},
      {"quadric", ball},
      {"cone", makeQuadric({1, 1, -1, 0, 0, 0, 0, 0, 0, 0})},
      {"union", combine(Operation::Union, {sphere, box, ball}, 0)},
      {"intersection", combine(Operation::Intersection, {sphere, box, ball}, 0)},
      {"difference", combine(Operation::Intersection, {box, makeComplement(sphere)}, 0)},
      {"smooth union", combine(Operation::Union, {box, sphere, ball}, 0.4)},
      {"smooth intersection", combine(Operation::Intersection, {box, sphere, ball}, 0.3)},
      {"many spheres", combine(Operation::Union, many, 0)},
      {"many spheres, smooth", combine(Operation::Union, many, 0.1)},
      {"offset", makeOffset(box, 0.2)},
      {"shell", makeShell(sphere, 0.2)},
      {"turned", transformed(box, turn)},
      {"stretched", transformed(box, stretch)},
      {"repeated", repeated(makeBox({0, 0, 0}, {0.2, 0.1, 0.15}, 0), {0.5, 0.4, 0.6}, {4, 3, 2})},
  };
  constexpr Lattice kLattices[] = {Lattice::Gyroid, Lattice::Primitive, Lattice::Diamond};
  for (const Lattice lattice : kLattices) {
    const std::string name = "lattice " + std::to_string(static_cast<int>(lattice));
    all.push_back({name, makeLattice(lattice, 1.3, 0.2)});
    all.push_back({name + " sheet", makeSheet(lattice, 1.3, {0.1, 0.3, {0, 0, -1}, {0, 0.5, 1}})});
  }
  for (const char* const text :
       {"(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3",
        "sin(3*x)*cos(2*y) + tan(0.2*z) - 0.3", "exp(-x^2 - y^2) * abs(z) - 0.2 + 0.1*x",
        "sqrt(x^2 + y^2) - atan(2*z) + ln(2 + x)", "min(x, y*z) + max(x - y, 0.5*z)^3 - 0.1",
        "(x^2 + y^2 + 0.5)^0.7 - 2^z/2", "abs(x)^2.5 + y^1.5 + z^66 - 0.3",
        "1/(x^2 + y^2 + z^2 + 0.1) - 2"}) {
    all.push_back({text, makeExpression(text)});
  }
  for (const BallKernel kernel : {BallKernel::Blinn, BallKernel::Nishimura, BallKernel::Wyvill}) {
    const std::string name = "metaballs " + std::to_string(static_cast<int>(kernel));
    std::vector<Metaball> balls = {
        {{-0.4, 0, 0.1}, 0.9, 1}, {{0.5, 0.2, 0}, 0.8, 1.2}, {{0, 0.6, 0.3}, 0.5, -0.7}};
    all.push_back({name, makeMetaballs(balls, {kernel, 0.4, 3})});
    for (int n = 0; n < 60; ++n) {
      balls.push_back({{0.04 * n - 1.2, 0.3 * (n % 7) - 1, 0.25 * (n % 9) - 1}, 0.3, 0.6});
    }
    all.push_back({name + ", many", makeMetaballs(balls, {kernel, 0.4, 3})});
  }
  const SkeletonSegment bone{{-0.7, 0.1, 0}, {0.8, -0.2, 0.4}};
  const SkeletonSegment rib{{0.1, -0.7, 0.2}, {0.2, 0.6, -0.3}};
  for (const ConvolutionKernel kernel :
       {ConvolutionKernel::Cauchy, ConvolutionKernel::Gaussian, ConvolutionKernel::Polynomial}) {
    const std::string name = "segments " + std::to_string(static_cast<int>(kernel));
    all.push_back({name, makeConvolution({{bone, 1}, {rib, -0.4}}, {kernel, 0.6, 0.3})});
  }
  const SkeletonTriangle sail{{-0.6, -0.5, 0.1}, {0.8, -0.3, 0.2}, {0.1, 0.9, -0.4}};
  const SkeletonArc bow{{0.1, 0, -0.1}, Vec3(2, 1, 2) / 3.0, Vec3(1, -2, 0) * 0.3, 4};
  all.push_back({"triangle", makeConvolution({{sail, 1}}, {ConvolutionKernel::Cauchy, 0.4, 0.3})});
  all.push_back({"arc", makeConvolution({{bow, 1}}, {ConvolutionKernel::Cauchy, 0.3, 0.4})});
  all.push_back({"mesh", makeMeshSolid(spikes())});
  all.push_back({"mesh sheet", makeMeshSheet(spikes(), 0.2)});
  return all;
}

}  // namespace tufa::test
