#pragma once

// Random cells, and the topology of their surfaces by mc33 and by the trilinear interpolant itself.

#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <ostream>
#include <random>
#include <set>
#include <utility>

#include "extract/mc33.h"
#include "unit/extract/trilinear_oracle.h"
#include "unit/uniform/cell_oracle.h"

namespace tufa::extraction::cells {

struct Topology {
  int components = 0;
  int euler = 0;
  friend bool operator==(const Topology&, const Topology&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Topology& t) {
    return out << t.components << " components, Euler characteristic " << t.euler;
  }
};

/// Of the triangles of a case, as they are.
inline Topology topologyOf(const CubeCase& cell) {
  std::array<int, kEdges + kMostCentres> root;
  std::iota(root.begin(), root.end(), 0);
  std::set<int> vertices;
  std::set<std::pair<int, int>> edges;
  for (int i = 0; i < cell.count; ++i) {
    for (int k = 0; k < 3; ++k) {
      const int a = cell.triangles[i][k], b = cell.triangles[i][(k + 1) % 3];
      vertices.insert(a);
      edges.emplace(std::min(a, b), std::max(a, b));
      const int keep = root[a], drop = root[b];
      for (int& r : root) r = r == drop ? keep : r;
    }
  }
  std::set<int> roots;
  for (const int vertex : vertices) roots.insert(root[vertex]);
  return {static_cast<int>(roots.size()),
          static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + cell.count};
}

inline CornerMask maskOf(const CornerValues& values) {
  unsigned mask = 0;
  for (int i = 0; i < 8; ++i) mask |= values[i] < 0 ? 1u << i : 0;
  return static_cast<CornerMask>(mask);
}

inline CubeCase chosenFor(const CornerValues& values) {
  static const CubeRule rule = mc33Rule();
  const CornerMask mask = maskOf(values);
  return caseOf(rule.asks[mask] ? rule.decide(mask, values) : rule.codes[mask]);
}

/// Of the trilinear surface: its Euler characteristic by the critical points of the field, which
/// counts disks, as tubes add 0; its rims by the test's own walk around the cell.
inline Topology trilinear(const CornerValues& values, bool& certain) {
  const TrilinearCell cell(values);
  const CornerMask mask = maskOf(values);
  unsigned joined = 0;
  for (int face = 0; face < kFaces; ++face) {
    std::array<double, 4> c;
    for (int i = 0; i < 4; ++i) c[i] = static_cast<double>(values[uniform::kFaceCorners[face][i]]);
    const double saddle = (c[0] * c[2] - c[1] * c[3]) / (c[0] + c[2] - c[1] - c[3]);
    joined |= saddle < 0 ? 1u << face : 0;
  }
  const auto rims = uniform::cells::partitionOf(mask, static_cast<FaceBits>(joined), 0);
  if (mask == 0 || mask == 255) return {};
  const int euler = cell.eulerOfSide(1, certain) + cell.eulerOfSide(-1, certain) - 1;
  return {(static_cast<int>(rims.size()) + euler) / 2, euler};
}

class Cells {
 public:
  explicit Cells(std::uint32_t seed) : random_(seed) {}
  /// Values of even spread, or of magnitudes of an even spread of logarithms.
  CornerValues next() {
    CornerValues values;
    const bool even = random_() % 2 == 0;
    for (float& value : values) {
      const double size = even ? uniform_(random_) : std::pow(10, -3 * uniform_(random_));
      value = static_cast<float>(random_() % 2 == 0 ? size : -size);
    }
    return values;
  }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> uniform_{0, 1};
};

}  // namespace tufa::extraction::cells
