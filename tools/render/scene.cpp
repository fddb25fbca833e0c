#include "scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/view_frame.h"

namespace tufa::render {
namespace {

constexpr int kSupersampling = 3;
constexpr double kPi = 3.14159265358979323846;
const double kSmoothCosine = std::cos(kPi / 6);
constexpr Color kGround = {0.93F, 0.94F, 0.955F};
constexpr Color kSurface = {0.27F, 0.40F, 0.56F};
constexpr Color kBare = {0.75F, 0.75F, 0.75F};  // where colours come later
constexpr Color kBackFace = {0.80F, 0.30F, 0.20F};
constexpr Color kLine = {0.03F, 0.05F, 0.09F};
// Half width of a drawn edge, in pixels of the final picture, and how dark it is.
constexpr double kLineHalfWidth = 0.75;
constexpr float kEdgeInk = 0.85F;
constexpr float kDiagonalInk = 0.22F;

/// A triangle and which of its edges (i to i + 1) are edges of the mesh, not a quad's diagonal.
struct Facet {
  Triangle triangle;
  std::array<bool, 3> real{true, true, true};
};

std::vector<Facet> facetsOf(const Mesh& mesh) {
  std::vector<Facet> facets;
  facets.reserve(mesh.triangleCount());
  for (const Triangle& t : mesh.triangles) facets.push_back({t});
  for (const Quad& q : mesh.quads) {
    const auto& v = q.vertices;
    facets.push_back({{v[0], v[1], v[2]}, {true, true, false}});
    facets.push_back({{v[0], v[2], v[3]}, {false, true, true}});
  }
  return facets;
}

/// For each facet corner the mean normal of the facets around its vertex that face nearly its way.
class CornerNormals {
 public:
  CornerNormals(const Mesh& mesh, const std::vector<Facet>& facets)
      : normals_(facets.size()), begin_(mesh.positions.size() + 1) {
    for (std::size_t i = 0; i < facets.size(); ++i) {
      const auto& v = facets[i].triangle.vertices;
      normals_[i] =
          (point(mesh, v[1]) - point(mesh, v[0])).cross(point(mesh, v[2]) - point(mesh, v[0]));
      for (const VertexIndex vertex : v) ++begin_[vertex + 1];
    }
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    around_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < facets.size(); ++i) {
      for (const VertexIndex vertex : facets[i].triangle.vertices) around_[next[vertex]++] = i;
    }
  }

  [[nodiscard]] Vec3 flat(std::size_t facet) const { return normals_[facet].unitOrX(); }

  [[nodiscard]] Vec3 smooth(std::size_t facet, VertexIndex vertex) const {
    const Vec3 own = flat(facet);
    Vec3 sum(0);
    for (std::size_t i = begin_[vertex]; i < begin_[vertex + 1]; ++i) {
      if (flat(around_[i]).dot(own) > kSmoothCosine) sum += normals_[around_[i]];
    }
    return sum.unitOrX();
  }

  static Vec3 point(const Mesh& mesh, VertexIndex vertex) { return mesh.positions[vertex]; }

 private:
  std::vector<Vec3> normals_;  ///< twice the area long
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> around_;
};

Camera aim(const Mesh& mesh, const View& view, int width, int height) {
  Camera camera = Camera::looking(view.azimuth, view.elevation, view.yUp);
  camera.halfWidth = 0.5 * width;
  camera.halfHeight = 0.5 * height;
  if (view.width > 0) {
    camera.centre = view.centre;
    camera.pixels = width / view.width;
    return camera;
  }
  const double infinity = std::numeric_limits<double>::infinity();
  Vec3 low(infinity), high(-infinity);
  for (const Position& p : mesh.positions) {
    const Vec3 seen(camera.right.dot(p), camera.up.dot(p), camera.toEye.dot(p));
    low = minVec3(low, seen);
    high = maxVec3(high, seen);
  }
  if (mesh.positions.empty()) return camera;
  const Vec3 middle = 0.5 * (low + high);
  camera.centre = middle[0] * camera.right + middle[1] * camera.up + middle[2] * camera.toEye;
  const Vec3 size = high - low;
  camera.pixels =
      0.9 * std::min(width / std::max(size[0], 1e-12), height / std::max(size[1], 1e-12));
  return camera;
}

/// The nearest surface seen through each pixel.
struct Layer {
  Image color;
  std::vector<float> depth;
};

class Painter {
 public:
  Painter(const Mesh& mesh, const View& view, int width, int height)
      : mesh_(mesh), view_(view), camera_(aim(mesh, view, width, height)), layer_() {
    layer_.color = Image(width, height, kGround);
    layer_.depth.assign(layer_.color.pixels.size(), std::numeric_limits<float>::infinity());
    key_ = (0.75 * camera_.toEye + 0.8 * camera_.up - 0.75 * camera_.right).unitOrX();
    fill_ = (camera_.toEye + 0.1 * camera_.up + 1.1 * camera_.right).unitOrX();
  }

  Layer paint() {
    const std::vector<Facet> facets = facetsOf(mesh_);
    const CornerNormals normals(mesh_, facets);
    for (std::size_t i = 0; i < facets.size(); ++i) fillFacet(facets[i], i, normals);
    if (view_.colors) dye();
    return std::move(layer_);
  }

  [[nodiscard]] double pixelsPerUnit() const { return camera_.pixels; }

 private:
  void fillFacet(const Facet& facet, std::size_t index, const CornerNormals& normals) {
    const auto& v = facet.triangle.vertices;
    std::array<Vec3, 3> p, n;
    for (int i = 0; i < 3; ++i) p[i] = camera_.project(CornerNormals::point(mesh_, v[i]));
    const double area = cross(p[0], p[1], p[2]);
    if (area == 0) return;
    const bool back = area > 0;
    for (int i = 0; i < 3; ++i) {
      n[i] = view_.smooth ? normals.smooth(index, v[i]) : normals.flat(index);
    }
    const auto [left, right] = std::minmax({p[0][0], p[1][0], p[2][0]});
    const auto [top, bottom] = std::minmax({p[0][1], p[1][1], p[2][1]});
    const int lastX = std::min(layer_.color.width - 1, static_cast<int>(std::floor(right)));
    const int lastY = std::min(layer_.color.height - 1, static_cast<int>(std::floor(bottom)));
    for (int y = std::max(0, static_cast<int>(std::floor(top))); y <= lastY; ++y) {
      for (int x = std::max(0, static_cast<int>(std::floor(left))); x <= lastX; ++x) {
        const Vec3 at(x + 0.5, y + 0.5, 0);
        const std::array<double, 3> share = {cross(p[1], p[2], at) / area,
                                             cross(p[2], p[0], at) / area,
                                             cross(p[0], p[1], at) / area};
        if (share[0] < 0 || share[1] < 0 || share[2] < 0) continue;
        const auto depth =
            static_cast<float>(share[0] * p[0][2] + share[1] * p[1][2] + share[2] * p[2][2]);
        const std::size_t pixel = layer_.color.index(x, y);
        if (depth >= layer_.depth[pixel]) continue;
        layer_.depth[pixel] = depth;
        Color color = shade((share[0] * n[0] + share[1] * n[1] + share[2] * n[2]).unitOrX(), back);
        if (view_.edges) drawEdges(facet, p, share, area, color);
        layer_.color.pixels[pixel] = color;
      }
    }
  }

  /// Gives the surface its colours: one for all samples of a pixel of the final picture.
  void dye() {
    std::vector<Position> points;
    std::vector<std::pair<std::size_t, std::size_t>> dyed;  // a sample and its place in `points`
    Image& image = layer_.color;
    for (int y = 0; y < image.height; y += kSupersampling) {
      for (int x = 0; x < image.width; x += kSupersampling) {
        bool first = true;
        for (int i = 0; i < kSupersampling * kSupersampling; ++i) {
          const int atX = x + i % kSupersampling, atY = y + i / kSupersampling;
          const std::size_t sample = image.index(atX, atY);
          if (!std::isfinite(layer_.depth[sample])) continue;
          if (first) {
            const Vec3 p = camera_.unproject({atX + 0.5, atY + 0.5, double{layer_.depth[sample]}});
            points.emplace_back(p[0], p[1], p[2]);
            first = false;
          }
          dyed.emplace_back(sample, points.size() - 1);
        }
      }
    }
    const std::vector<Color> colors = view_.colors(points);
    for (const auto& [sample, point] : dyed) {
      for (std::size_t i = 0; i < 3; ++i) image.pixels[sample][i] *= colors[point][i];
    }
  }

  static double cross(const Vec3& a, const Vec3& b, const Vec3& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  }

  // Two lamps, one from the upper left, and light from above.
  [[nodiscard]] Color shade(const Vec3& normal, bool back) const {
    const double sky = 0.5 + 0.5 * normal.dot(camera_.up);
    const double key = std::max(0.0, normal.dot(key_)), fill = std::max(0.0, normal.dot(fill_));
    const auto light = static_cast<float>(0.14 + 0.34 * sky + 0.62 * key + 0.22 * fill);
    const double gloss = std::pow(std::max(0.0, normal.dot((key_ + camera_.toEye).unitOrX())), 40);
    Color color = view_.colors ? kBare : back ? kBackFace : kSurface;
    for (float& c : color) c = c * light + 0.07F * static_cast<float>(gloss);
    return color;
  }

  // Darkens a pixel near an edge of the facet; edges of facets seen at a slant stay as wide.
  static void drawEdges(const Facet& facet, const std::array<Vec3, 3>& p,
                        const std::array<double, 3>& share, double area, Color& color) {
    float ink = 0;
    for (int i = 0; i < 3; ++i) {
      // Edge i is opposite corner i + 2.
      const Vec3 edge = p[(i + 1) % 3] - p[i];
      const double length = std::hypot(edge[0], edge[1]);
      const double away = share[(i + 2) % 3] * std::abs(area) / std::max(length, 1e-9);
      if (away > kLineHalfWidth * kSupersampling) continue;
      ink = std::max(ink, facet.real[i] ? kEdgeInk : kDiagonalInk);
    }
    for (int i = 0; i < 3; ++i) color[i] += ink * (kLine[i] - color[i]);
  }

  const Mesh& mesh_;
  const View& view_;
  Camera camera_;
  Layer layer_;
  Vec3 key_, fill_;
};

// Darkens places that much of their surroundings stand in front of.
void occlude(Layer& layer, int radius) {
  constexpr int kDirections = 12, kRings = 3;
  struct Offset {
    int dx, dy;
    float reach;
  };
  std::vector<Offset> offsets;
  for (int i = 0; i < kDirections * kRings; ++i) {
    const int ring = i / kDirections;
    const double reach = radius * (ring + 1.0) / kRings;
    const double angle = 2 * kPi * (i + 0.5 * ring) / kDirections;
    offsets.push_back({static_cast<int>(std::lround(reach * std::cos(angle))),
                       static_cast<int>(std::lround(reach * std::sin(angle))),
                       static_cast<float>(reach)});
  }
  Image& image = layer.color;
  const float farthest = 4.0F * static_cast<float>(radius);
  for (int y = radius; y < image.height - radius; ++y) {
    for (int x = radius; x < image.width - radius; ++x) {
      const std::size_t pixel = image.index(x, y);
      const float here = layer.depth[pixel];
      if (!std::isfinite(here)) continue;
      float hidden = 0;
      for (const Offset& o : offsets) {
        // Against the point opposite, so that a slanted plane does not darken itself.
        const float front = here - layer.depth[image.index(x + o.dx, y + o.dy)];
        const float opposite = here - layer.depth[image.index(x - o.dx, y - o.dy)];
        const float rise = front + std::max(opposite, -2 * o.reach);
        if (rise > 0.15F * o.reach && rise < farthest) hidden += std::min(1.0F, rise / o.reach);
      }
      const float light = 1 - 0.75F * std::min(1.0F, hidden / (kDirections * kRings));
      for (float& c : image.pixels[pixel]) c *= light;
    }
  }
}

}  // namespace

Camera Camera::looking(double azimuth, double elevation, bool yUp) {
  const base::ViewFrame frame = base::viewFrame(azimuth, elevation, yUp);
  Camera camera;
  camera.right = frame.right;
  camera.up = frame.up;
  camera.toEye = frame.toEye;
  camera.centre = Vec3(0);
  return camera;
}

View fitted(const Mesh& mesh, const View& view, int width, int height) {
  View fit = view;
  fit.width = 0;
  const Camera camera = aim(mesh, fit, width, height);
  fit.width = width / camera.pixels;
  fit.centre = camera.centre;
  return fit;
}

Image render(const Mesh& mesh, const View& view, int width, int height) {
  Painter painter(mesh, view, width * kSupersampling, height * kSupersampling);
  Layer layer = painter.paint();
  occlude(layer, width * kSupersampling / 50);
  return shrink(layer.color, kSupersampling);
}

}  // namespace tufa::render
