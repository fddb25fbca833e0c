#include "implicit/shell_layers.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "base/bvh.h"
#include "base/connected.h"
#include "base/count_odd.h"
#include "base/sheared_ray.h"
#include "base/vec3.h"
#include "base/vertex_welder.h"

namespace tufa::implicit {
namespace {

constexpr std::size_t kMostRays = 5;  // odd, so that there is a majority
// Along no axis and no diagonal, where the edges of meshes are.
const Vec3 kRayDirection(0.3574, 0.4831, 0.7993);

class Layering {
 public:
  Layering(const Mesh& mesh, base::Job& job) : job_(job) {
    base::VertexWelder welder(positions_);
    std::vector<VertexIndex> place;
    place.reserve(mesh.positions.size());
    for (const Position& p : mesh.positions) {
      job_.pollCancelled(place.size());
      place.push_back(welder.indexOf(p));
    }
    for (const Triangle& t : triangulate(mesh)) {
      job_.pollCancelled(triangles_.size());
      const VertexIndex a = place[t.vertices[0]], b = place[t.vertices[1]];
      const VertexIndex c = place[t.vertices[2]];
      if (a != b && b != c && c != a) triangles_.emplace_back(a, b, c);
    }
    partOf_ = base::connectedItems(positions_.size(), [&](const auto& connect) {
      std::size_t done = 0;
      for (const Triangle& t : triangles_) {
        job_.pollCancelled(done++);
        connect(t.vertices[0], t.vertices[1]);
        connect(t.vertices[0], t.vertices[2]);
      }
    });
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      job_.pollCancelled(t);
      parts_[partAt(t)].triangles.push_back(t);
    }
  }

  Shells run(bool asksForSolid) {
    bool isAnyInward = false, isAnyOpen = false;
    for (auto& [vertex, part] : parts_) {
      part.facesInward = volumeOf(part) < 0;
      isAnyInward |= part.facesInward;
    }
    Shells shells;
    const bool mayHaveCavities = isAnyInward && parts_.size() > 1;
    if (!mayHaveCavities && !asksForSolid) return shells;
    for (auto& [vertex, part] : parts_) {
      part.isClosed = isClosed(part);
      isAnyOpen |= !part.isClosed;
    }
    if (mayHaveCavities || (parts_.size() > 1 && !isAnyOpen)) findDepths();
    const auto holdsFor = [](bool (Part::*property)() const) {
      return [property](const auto& part) { return (part.second.*property)(); };
    };
    shells.boundSolid =
        asksForSolid && std::all_of(parts_.begin(), parts_.end(), holdsFor(&Part::boundsSolid));
    if (std::any_of(parts_.begin(), parts_.end(), holdsFor(&Part::isCavity))) {
      shells.layers = layers();
    }
    return shells;
  }

 private:
  struct Part {
    std::vector<std::uint32_t> triangles;
    bool facesInward = false;
    bool isClosed = false;
    std::size_t depth = 0;  // number of closed parts that it lies in
    [[nodiscard]] bool isCavity() const { return isClosed && facesInward && depth % 2 == 1; }
    [[nodiscard]] bool boundsSolid() const { return isClosed && facesInward == (depth % 2 == 1); }
  };

  [[nodiscard]] std::uint32_t partAt(std::uint32_t triangle) const {
    return partOf_[triangles_[triangle].vertices[0]];
  }

  [[nodiscard]] std::array<Vec3, 3> cornersOf(std::uint32_t triangle) const {
    const auto& v = triangles_[triangle].vertices;
    return {Vec3(positions_[v[0]]), Vec3(positions_[v[1]]), Vec3(positions_[v[2]])};
  }

  // Six times the volume, about a corner of its own.
  [[nodiscard]] double volumeOf(const Part& part) const {
    const Vec3 origin = cornersOf(part.triangles.front())[0];
    double volume = 0;
    for (const std::uint32_t t : part.triangles) {
      const auto [a, b, c] = cornersOf(t);
      volume += (a - origin).dot((b - origin).cross(c - origin));
    }
    return volume;
  }

  // Whether each edge has as many faces one way as the other.
  [[nodiscard]] bool isClosed(const Part& part) const {
    std::unordered_map<std::uint64_t, int> sums;
    for (const std::uint32_t t : part.triangles) {
      job_.pollCancelled(t);
      const auto& v = triangles_[t].vertices;
      for (std::size_t i = 0; i < 3; ++i) {
        const VertexIndex a = v[i], b = v[(i + 1) % 3];
        sums[std::uint64_t{std::min(a, b)} << 32 | std::max(a, b)] += a < b ? 1 : -1;
      }
    }
    return std::all_of(sums.begin(), sums.end(), [](const auto& sum) { return sum.second == 0; });
  }

  void findDepths() {
    std::vector<base::Box> boxes;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      base::Box& box = boxes.emplace_back(base::Box::empty());
      for (const Vec3& p : cornersOf(t)) box.add(p);
    }
    const base::Bvh tree(std::move(boxes), job_);
    for (auto& [vertex, part] : parts_) {
      job_.pollCancelled(vertex);
      const std::size_t count = part.triangles.size();
      const std::size_t rays = std::min(kMostRays, (count - 1) | 1);
      std::vector<std::size_t> depths;
      for (std::size_t ray = 0; ray < rays; ++ray) {
        depths.push_back(depthOf(part.triangles[ray * count / rays], tree));
      }
      std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(rays / 2),
                       depths.end());
      part.depth = depths[rays / 2];
    }
  }

  // In how many closed parts a triangle lies, but its own: those whose faces a ray passes an odd
  // number of times.
  [[nodiscard]] std::size_t depthOf(std::uint32_t triangle, const base::Bvh& tree) const {
    const auto [a, b, c] = cornersOf(triangle);
    const Vec3 from = (a + b + c) / 3;
    const base::ShearedRay ray(from, kRayDirection);
    std::vector<std::uint32_t> passed;
    double to = std::numeric_limits<double>::max();
    tree.itemsAlong(base::BoxRay(from, kRayDirection, 0), to, [&](std::uint32_t t) {
      const std::uint32_t part = partAt(t);
      if (part == partAt(triangle) || !parts_.at(part).isClosed) return;
      const auto at = ray.passes(cornersOf(t));
      if (at && *at > 0) passed.push_back(part);
    });
    return base::countOdd(passed);
  }

  [[nodiscard]] std::vector<ShellLayer> layers() const {
    std::map<std::pair<std::size_t, bool>, std::size_t> places;
    for (const auto& [vertex, part] : parts_) places[{part.depth, part.isCavity()}] = 0;
    std::vector<ShellLayer> layers;
    for (auto& [kind, place] : places) {
      place = layers.size();
      layers.push_back({{}, kind.second});
      layers.back().mesh.positions = positions_;
    }
    for (const auto& [vertex, part] : parts_) {
      std::vector<Triangle>& to = layers[places[{part.depth, part.isCavity()}]].mesh.triangles;
      for (const std::uint32_t t : part.triangles) to.push_back(triangles_[t]);
    }
    return layers;
  }

  base::Job& job_;
  std::vector<Position> positions_;  // equal ones once
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> partOf_;    // of each vertex, by its lowest vertex
  std::map<std::uint32_t, Part> parts_;  // by their lowest vertices
};

}  // namespace

Shells findShells(const Mesh& mesh, bool asksForSolid, base::Job& job) {
  return Layering(mesh, job).run(asksForSolid);
}

}  // namespace tufa::implicit
