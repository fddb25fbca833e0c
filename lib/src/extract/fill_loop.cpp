#include "extract/fill_loop.h"

#include <array>
#include <limits>

#include "base/vec3.h"

namespace tufa::extraction {
namespace {

// More are filled by a fan: it takes time in the third power to find chords, and with many corners
// most triangles are slivers either way.
constexpr int kMostCorners = 12;

// The best way to fill the part of a loop from one corner to a later one, by dynamic programming
// (Klincsek 1980).
class Chords {
 public:
  Chords(const std::vector<LoopCorner>& loop, const Mesh& mesh) : loop_(loop), mesh_(mesh) {
    const int count = static_cast<int>(loop.size());
    for (int span = 2; span < count; ++span) {
      for (int from = 0; from + span < count; ++from) find(from, from + span);
    }
  }

  [[nodiscard]] bool found() const { return costs_[0][loop_.size() - 1] < kNone; }

  void emit(int from, int to, BlockTriangles& out) const {
    if (to - from < 2) return;
    const int middle = middles_[from][to];
    out.triangles.emplace_back(loop_[from].vertex, loop_[middle].vertex, loop_[to].vertex);
    emit(from, middle, out);
    emit(middle, to, out);
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  void find(int from, int to) {
    const bool isChord = from > 0 || to + 1 < static_cast<int>(loop_.size());
    double& best = costs_[from][to];
    best = kNone;
    if (isChord && (loop_[from].faces & loop_[to].faces) != 0) return;
    for (int middle = from + 1; middle < to; ++middle) {
      const double cost = costs_[from][middle] + costs_[middle][to];
      if (!(cost < best)) continue;
      best = cost;
      middles_[from][to] = middle;
    }
    if (!isChord) return;
    best += (Vec3(mesh_.positions[loop_[to].vertex]) - Vec3(mesh_.positions[loop_[from].vertex]))
                .squaredLength();
  }

  const std::vector<LoopCorner>& loop_;
  const Mesh& mesh_;
  std::array<std::array<double, kMostCorners>, kMostCorners> costs_{};
  std::array<std::array<int, kMostCorners>, kMostCorners> middles_{};
};

}  // namespace

void fillLoop(const std::vector<LoopCorner>& loop, const Mesh& mesh, BlockTriangles& to) {
  if (loop.size() <= kMostCorners) {
    const Chords chords(loop, mesh);
    if (chords.found()) {
      chords.emit(0, static_cast<int>(loop.size()) - 1, to);
      return;
    }
  }
  const auto middle = static_cast<VertexIndex>(mesh.positions.size() + to.positions.size());
  Vec3 sum(0), normal(0);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const VertexIndex from = loop[i].vertex, next = loop[(i + 1) % loop.size()].vertex;
    sum += Vec3(mesh.positions[from]);
    normal += Vec3(mesh.normals[from]);
    to.triangles.emplace_back(from, next, middle);
  }
  if (!normal.normalize()) normal = Vec3(mesh.normals[loop.front().vertex]);
  to.positions.push_back(sum / static_cast<double>(loop.size()));
  to.normals.push_back(Normal(normal));
}

}  // namespace tufa::extraction
