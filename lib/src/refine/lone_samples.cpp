#include "refine/lone_samples.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>

namespace tufa::refine {
namespace {

constexpr std::uint8_t kThree = 3;
constexpr std::size_t kCorners = 8;
constexpr std::size_t kSides = 6;

// The quads of which all vertices have three quads, as the six around a single sample do.
std::vector<std::uint32_t> findCandidates(const Mesh& mesh, base::Job& job) {
  std::vector<std::uint8_t> quadsAt(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
    job.pollCancelled(i);
    for (const VertexIndex vertex : mesh.quads[i].vertices) {
      quadsAt[vertex] = static_cast<std::uint8_t>(std::min<int>(quadsAt[vertex] + 1, kThree + 1));
    }
  }
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t i = 0; i < mesh.quads.size(); ++i) {
    job.pollCancelled(i);
    const auto& v = mesh.quads[i].vertices;
    if (std::all_of(v.begin(), v.end(), [&](VertexIndex at) { return quadsAt[at] == kThree; })) {
      candidates.push_back(i);
    }
  }
  return candidates;
}

// Connected components of six such quads; each lists its quads in the order of the mesh.
std::vector<std::array<std::uint32_t, kSides>> findLoneComponents(const Mesh& mesh,
                                                                  base::Job& job) {
  const std::vector<std::uint32_t> candidates = findCandidates(mesh, job);
  std::unordered_map<VertexIndex, std::vector<std::uint32_t>> around;
  for (const std::uint32_t quad : candidates) {
    for (const VertexIndex vertex : mesh.quads[quad].vertices) around[vertex].push_back(quad);
  }
  std::vector<std::array<std::uint32_t, kSides>> components;
  std::vector<std::uint32_t> component;
  for (const std::uint32_t first : candidates) {
    component = {first};
    for (std::size_t i = 0; i < component.size() && component.size() <= kSides; ++i) {
      for (const VertexIndex vertex : mesh.quads[component[i]].vertices) {
        for (const std::uint32_t next : around[vertex]) {
          if (std::find(component.begin(), component.end(), next) == component.end())
            component.push_back(next);
        }
      }
    }
    if (component.size() != kSides ||
        *std::min_element(component.begin(), component.end()) != first)
      continue;
    std::sort(component.begin(), component.end());
    std::copy(component.begin(), component.end(), components.emplace_back().begin());
  }
  return components;
}

// Six times the volume of quads whose corners are at `at(vertex)`.
template <class At>
double volumeOf(const Mesh& mesh, const std::array<std::uint32_t, kSides>& component,
                const At& at) {
  const Vec3 origin = at(mesh.quads[component[0]].vertices[0]);
  double volume = 0;
  for (const std::uint32_t quad : component) {
    const auto& v = mesh.quads[quad].vertices;
    const Vec3 p = at(v[0]) - origin, q = at(v[2]) - origin;
    volume += p.dot((at(v[1]) - origin).cross(q)) + p.dot(q.cross(at(v[3]) - origin));
  }
  return volume;
}

}  // namespace

std::size_t unfoldLoneComponents(Mesh& mesh, const Source& source, base::Job& job) {
  const auto components = findLoneComponents(mesh, job);
  std::vector<VertexIndex> vertices;
  for (const auto& component : components) {
    for (const std::uint32_t quad : component) {
      const auto& v = mesh.quads[quad].vertices;
      vertices.insert(vertices.end(), v.begin(), v.end());
    }
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  if (vertices.empty()) return 0;
  const std::vector<Position> fallbacks = source.massPoints(vertices);
  const auto fallbackOf = [&](VertexIndex vertex) {
    const auto found = std::lower_bound(vertices.begin(), vertices.end(), vertex);
    return fallbacks[static_cast<std::size_t>(found - vertices.begin())];
  };
  std::size_t moved = 0;
  for (const auto& component : components) {
    const double is =
        volumeOf(mesh, component, [&](VertexIndex v) { return Vec3(mesh.positions[v]); });
    const double box =
        volumeOf(mesh, component, [&](VertexIndex v) { return Vec3(fallbackOf(v)); });
    if (is * box > 0) continue;
    for (const std::uint32_t quad : component) {
      for (const VertexIndex vertex : mesh.quads[quad].vertices) {
        mesh.positions[vertex] = fallbackOf(vertex);
      }
    }
    moved += kCorners;
  }
  return moved;
}

}  // namespace tufa::refine
