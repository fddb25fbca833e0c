#include "unit/reduce/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "base/vec3.h"
#include "intersect/surface.h"

namespace tufa::test {
namespace {

using base::Vec3f;

constexpr double kPi = 3.14159265358979323846;

// Numbers the points between two others, each once.
class Midpoints {
 public:
  explicit Midpoints(std::vector<Vec3f>& positions) : positions_(positions) {}

  VertexIndex of(VertexIndex a, VertexIndex b, float share = 0.5f) {
    const std::pair<VertexIndex, VertexIndex> key = std::minmax(a, b);
    const auto [at, isNew] = numbers_.try_emplace(key, static_cast<VertexIndex>(positions_.size()));
    if (isNew) positions_.push_back(positions_[a] * (1 - share) + positions_[b] * share);
    return at->second;
  }

 private:
  std::vector<Vec3f>& positions_;
  std::map<std::pair<VertexIndex, VertexIndex>, VertexIndex> numbers_;
};

// Six tetrahedra of a cube around its diagonal (Kuhn), by corner numbers with x as the first bit.
constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                   {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

// The distance of p from a triangle: in its plane if p is above it, else from its edges. Written
// without a look at the library's.
double distanceOf(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 corners[3] = {a, b, c};
  const Vec3 n = (b - a).cross(c - a);
  bool isAbove = n.squaredLength() > 0;
  double best = 1e300;
  for (int i = 0; i < 3; ++i) {
    const Vec3& from = corners[i];
    const Vec3 edge = corners[(i + 1) % 3] - from;
    isAbove = isAbove && n.cross(edge).dot(p - from) >= 0;
    const double l2 = edge.squaredLength();
    const double t = l2 > 0 ? std::clamp((p - from).dot(edge) / l2, 0.0, 1.0) : 0;
    best = std::min(best, (p - (from + edge * t)).length());
  }
  return isAbove ? std::min(best, std::abs((p - a).dot(n)) / n.length()) : best;
}

}  // namespace

reduce::Surface surfaceOf(const FineMesh& mesh, base::Job& job) {
  const reduce::InputMesh input = mesh.input();
  return reduce::makeSurface(input.positions, input.triangles, job);
}

Mesh toMesh(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles) {
  Mesh mesh;
  for (const Vec3f& p : positions) mesh.positions.push_back(static_cast<Vec3>(p));
  mesh.triangles = triangles;
  return mesh;
}

FineMesh subdivided(FineMesh mesh, int times) {
  for (int i = 0; i < times; ++i) {
    Midpoints middle(mesh.positions);
    std::vector<Triangle> finer;
    for (const Triangle& t : mesh.triangles) {
      const auto& v = t.vertices;
      const VertexIndex a = middle.of(v[0], v[1]), b = middle.of(v[1], v[2]),
                        c = middle.of(v[2], v[0]);
      finer.insert(finer.end(), {{v[0], a, c}, {a, v[1], b}, {c, b, v[2]}, {a, b, c}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

FineMesh tetrahedron(float size) {
  const float s = size;
  return {{{0, 0, 0}, {s, s, 0}, {s, 0, s}, {0, s, s}},
          {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
}

FineMesh octahedron(float size) {
  const float s = size;
  return {{{s, 0, 0}, {-s, 0, 0}, {0, s, 0}, {0, -s, 0}, {0, 0, s}, {0, 0, -s}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

FineMesh box(float x, float y, float z) {
  FineMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back((i & 1) != 0 ? x : 0, (i & 2) != 0 ? y : 0, (i & 4) != 0 ? z : 0);
  }
  constexpr VertexIndex kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    mesh.triangles.emplace_back(f[0], f[1], f[2]);
    mesh.triangles.emplace_back(f[0], f[2], f[3]);
  }
  return mesh;
}

FineMesh wedge(float length, float degrees, float width) {
  const float h = length * std::tan(degrees * static_cast<float>(kPi) / 360);
  return {{{0, 0, 0},
           {length, 0, -h},
           {length, 0, h},
           {0, width, 0},
           {length, width, -h},
           {length, width, h}},
          {{0, 1, 2}, {3, 5, 4}, {0, 2, 5}, {0, 5, 3}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}}};
}

FineMesh bumpySphere(int times, float radius, float height, unsigned seed) {
  FineMesh mesh = subdivided(octahedron(1), times);
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::array<Vec3f, 6> waves;
  for (Vec3f& w : waves) w = Vec3f(normal(random), normal(random), normal(random)) * 4;
  for (Vec3f& p : mesh.positions) {
    p = unit(p);
    float r = radius;
    for (const Vec3f& w : waves) r += height * std::sin(dot(w, p)) / 2;
    p = p * r;
  }
  return mesh;
}

FineMesh levelSet(int size, const std::function<double(double, double, double)>& f) {
  const int n = size + 1;
  std::vector<double> value;
  std::vector<Vec3f> lattice;
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const bool isBorder = std::min({x, y, z}) == 0 || std::max({x, y, z}) == size;
        value.push_back(isBorder ? 1 : f(x, y, z));
        lattice.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
      }
    }
  }
  const auto lattices = static_cast<VertexIndex>(lattice.size());
  Midpoints points(lattice);
  FineMesh mesh;
  const auto crossing = [&](VertexIndex in, VertexIndex out) {
    const double share = std::clamp(value[in] / (value[in] - value[out]), 0.1, 0.9);
    return points.of(in, out, static_cast<float>(share)) - lattices;
  };
  // A triangle that looks away from the inner corner.
  const auto add = [&](VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex inner) {
    const Vec3f p = lattice[lattices + a];
    const Vec3f n3 = cross(lattice[lattices + b] - p, lattice[lattices + c] - p);
    dot(n3, p - lattice[inner]) > 0 ? mesh.triangles.emplace_back(a, b, c)
                                    : mesh.triangles.emplace_back(a, c, b);
  };
  for (int cell = 0; cell < size * size * size; ++cell) {
    const int x = cell % size, y = cell / size % size, z = cell / size / size;
    for (const auto& tetrahedron : kTetrahedra) {
      std::vector<VertexIndex> in, out;
      for (const int k : tetrahedron) {
        const auto v =
            static_cast<VertexIndex>(((z + (k >> 2)) * n + y + (k >> 1 & 1)) * n + x + (k & 1));
        (value[v] < 0 ? in : out).push_back(v);
      }
      if (in.size() == 1) {
        add(crossing(in[0], out[0]), crossing(in[0], out[1]), crossing(in[0], out[2]), in[0]);
      } else if (in.size() == 3) {
        add(crossing(in[0], out[0]), crossing(in[1], out[0]), crossing(in[2], out[0]), in[0]);
      } else if (in.size() == 2) {
        const VertexIndex a = crossing(in[0], out[0]), b = crossing(in[0], out[1]),
                          c = crossing(in[1], out[1]), d = crossing(in[1], out[0]);
        add(a, b, c, in[0]);
        add(a, c, d, in[0]);
      }
    }
  }
  mesh.positions.assign(lattice.begin() + lattices, lattice.end());
  return mesh;
}

FineMesh noiseSolid(int size, double wavelength, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  struct Wave {
    Vec3 k;
    double phase;
  };
  std::vector<Wave> waves;
  for (int i = 0; i < 12; ++i) {
    Vec3 k(normal(random), normal(random), normal(random));
    k.normalize();
    waves.push_back({k * (2 * kPi / wavelength), normal(random) * kPi});
  }
  return levelSet(size, [&](double x, double y, double z) {
    double sum = 0.5;
    for (const Wave& w : waves) sum += std::sin(w.k.dot(Vec3(x, y, z)) + w.phase);
    return sum;
  });
}

std::size_t intersectingPairs(const Mesh& mesh) {
  Mesh copy = mesh;
  base::Job job(1, {});
  const intersect::Surface surface(copy, job);
  std::vector<base::PolygonIndex> all(surface.size());
  std::iota(all.begin(), all.end(), base::PolygonIndex{0});
  return intersect::findPairs(surface, all, job).size();
}

std::size_t folds(const Mesh& mesh, double degrees, double leastArea) {
  std::map<std::pair<VertexIndex, VertexIndex>, Vec3> normals;  // of the triangle left of an edge
  for (const Triangle& t : mesh.triangles) {
    const auto& v = t.vertices;
    const Vec3 a = mesh.positions[v[0]], b = mesh.positions[v[1]], c = mesh.positions[v[2]];
    for (int i = 0; i < 3; ++i) normals[{v[i], v[(i + 1) % 3]}] = (b - a).cross(c - a) * 0.5;
  }
  std::size_t count = 0;
  for (const auto& [edge, n] : normals) {
    const auto other = normals.find({edge.second, edge.first});
    if (edge.first > edge.second || other == normals.end()) continue;
    const Vec3& m = other->second;
    if (n.length() < leastArea || m.length() < leastArea) continue;
    count += n.dot(m) < std::cos(degrees * kPi / 180) * n.length() * m.length();
  }
  return count;
}

Angles anglesOf(const Mesh& mesh) {
  Angles angles;
  for (const Triangle& t : mesh.triangles) {
    double least = 180;
    for (int i = 0; i < 3; ++i) {
      const Vec3 p = mesh.positions[t.vertices[i]];
      const Vec3 a = Vec3(mesh.positions[t.vertices[(i + 1) % 3]]) - p;
      const Vec3 b = Vec3(mesh.positions[t.vertices[(i + 2) % 3]]) - p;
      least = std::min(least, std::atan2(a.cross(b).length(), a.dot(b)) * 180 / kPi);
    }
    angles.smallest = std::min(angles.smallest, least);
    angles.underTen += least < 10;
  }
  angles.underTen /= static_cast<double>(std::max<std::size_t>(1, mesh.triangles.size()));
  return angles;
}

double sampledDistance(const Mesh& from, const Mesh& to, std::size_t samples) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform;
  std::vector<Vec3> points;
  for (const Position& p : from.positions) points.emplace_back(p);
  std::vector<double> areas;
  for (const Triangle& t : from.triangles) {
    const Vec3 a = from.positions[t.vertices[0]];
    areas.push_back((Vec3(from.positions[t.vertices[1]]) - a)
                        .cross(Vec3(from.positions[t.vertices[2]]) - a)
                        .length());
  }
  std::discrete_distribution<std::size_t> pick(areas.begin(), areas.end());
  for (std::size_t i = 0; i < samples; ++i) {
    const auto& v = from.triangles[pick(random)].vertices;
    const double r = std::sqrt(uniform(random)), s = uniform(random);
    points.push_back(Vec3(from.positions[v[0]]) * (1 - r) +
                     Vec3(from.positions[v[1]]) * (r * (1 - s)) +
                     Vec3(from.positions[v[2]]) * (r * s));
  }
  double largest = 0;
  for (const Vec3& p : points) {
    double least = 1e300;
    for (const Triangle& t : to.triangles) {
      const Vec3 a = to.positions[t.vertices[0]];
      const Vec3 b = to.positions[t.vertices[1]], c = to.positions[t.vertices[2]];
      // A triangle whose corners all lie farther off along an axis cannot be nearer.
      bool isFar = false;
      for (int k = 0; k < 3 && !isFar; ++k) {
        isFar = std::min({a[k], b[k], c[k]}) > p[k] + least ||
                std::max({a[k], b[k], c[k]}) < p[k] - least;
      }
      if (!isFar) least = std::min(least, distanceOf(p, a, b, c));
    }
    largest = std::max(largest, least);
  }
  return largest;
}

}  // namespace tufa::test
