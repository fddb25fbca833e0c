// Meshes of labels that fit each other.

#include <openvdb/openvdb.h>
#include <tufa/labels.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "base/require_mesh.h"
#include "base/single_precision.h"
#include "base/vec3.h"
#include "filter/integer_grid.h"

namespace tufa {
namespace {

/// The labels of a cell's corners: bits 0, 1 and 2 of a corner are its place along x, y and z.
using CellLabels = std::array<std::int64_t, 8>;

/// Reads the labels that are asked for; all others are 0, as what is not active.
template <class GridT>
class LabelReader {
 public:
  LabelReader(const GridT& grid, const std::vector<std::int64_t>& labels)
      : accessor_(grid.getConstAccessor()), labels_(labels) {
    std::sort(labels_.begin(), labels_.end());
  }

  CellLabels cell(const Coord& at) {
    CellLabels all{};
    for (int corner = 0; corner < 8; ++corner) {
      const openvdb::Coord place(at[0] + (corner & 1), at[1] + (corner >> 1 & 1),
                                 at[2] + (corner >> 2));
      typename GridT::ValueType value{};
      const bool isLabel = accessor_.probeValue(place, value) &&
                           std::binary_search(labels_.begin(), labels_.end(), value);
      all[static_cast<std::size_t>(corner)] = isLabel ? std::int64_t{value} : 0;
    }
    return all;
  }

 private:
  typename GridT::ConstAccessor accessor_;
  std::vector<std::int64_t> labels_;
};

/// The mean of the middles of those edges of a cell whose ends have different labels, from the
/// cell's first corner on in voxels. Such edges lie around corners, so that it is in the inside.
Vec3 meanOfChanges(const CellLabels& labels) {
  Vec3 sum(0.0);
  int count = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      const unsigned other = corner | 1U << axis;
      if (other == corner || labels[corner] == labels[other]) continue;
      Vec3 middle(corner & 1U, corner >> 1 & 1U, corner >> 2);
      middle[axis] = 0.5;
      sum += middle;
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

/// Throws Error(InvalidArgument) where a cell has one label: the mesh is of another grid.
void requireChange(const CellLabels& corners, std::int64_t label, std::size_t vertex) {
  const bool hasOne = std::all_of(corners.begin(), corners.end(),
                                  [&](std::int64_t other) { return other == corners.front(); });
  if (!hasOne) return;
  throw Error(ErrorCode::InvalidArgument, "the mesh of label " + std::to_string(label) +
                                              " is not of this grid and these "
                                              "labels: no surface passes the cell of its vertex " +
                                              std::to_string(vertex));
}

std::size_t labelsIn(const CellLabels& labels) {
  CellLabels sorted = labels;
  std::sort(sorted.begin(), sorted.end());
  const auto end = std::unique(sorted.begin(), sorted.end());
  return static_cast<std::size_t>(end - sorted.begin()) - (sorted.front() == 0 ? 1 : 0);
}

bool isBefore(const Position& a, const Position& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// Turns a quad so that the diagonal from its first vertex is the shorter one; of two of one length
/// that with the first of the four positions. So do both labels of an interface.
void chooseDiagonal(const std::vector<Position>& positions, Quad& quad) {
  const auto at = [&](std::size_t n) { return positions[quad.vertices[n]]; };
  const double one = (Vec3(at(2)) - Vec3(at(0))).squaredLength();
  const double other = (Vec3(at(3)) - Vec3(at(1))).squaredLength();
  const auto first = [&](std::size_t n) { return std::min(at(n), at(n + 2), isBefore); };
  if (one < other || (one == other && !isBefore(first(1), first(0)))) return;
  std::rotate(quad.vertices.begin(), quad.vertices.begin() + 1, quad.vertices.end());
}

/// Of the faces, by their areas.
void setNormals(Mesh& mesh) {
  std::vector<Vec3> sums(mesh.positions.size(), Vec3(0.0));
  for (const Quad& quad : mesh.quads) {
    const auto at = [&](std::size_t n) { return Vec3(mesh.positions[quad.vertices[n]]); };
    const Vec3 area = (at(2) - at(0)).cross(at(3) - at(1));
    for (const VertexIndex vertex : quad.vertices) sums[vertex] += area;
  }
  for (std::size_t v = 0; v < sums.size(); ++v) {
    mesh.normals[v] = static_cast<Normal>(sums[v].unitOrX());
  }
}

void requireNets(const std::vector<Mesh>& meshes, const std::vector<std::int64_t>& labels) {
  if (meshes.size() != labels.size()) {
    throw Error(ErrorCode::InvalidArgument,
                std::to_string(meshes.size()) + " meshes are given of " +
                    std::to_string(labels.size()) + " labels; one for each is needed");
  }
  for (const Mesh& mesh : meshes) {
    base::requireFaces(mesh);
    base::requireNormals(mesh);
    if (mesh.cells.size() == mesh.positions.size() && mesh.triangles.empty()) continue;
    throw Error(ErrorCode::InvalidArgument,
                "interfaces can be shared by meshes of surface nets alone that have the cell of "
                "each vertex (ContourOptions::keepCells)");
  }
}

/// The world length of the shortest step of the lattice.
double shortestStep(const openvdb::math::Transform& transform) {
  const auto origin = transform.indexToWorld(openvdb::Vec3d(0.0));
  double least = (transform.indexToWorld(openvdb::Vec3d(1, 0, 0)) - origin).length();
  least = std::min(least, (transform.indexToWorld(openvdb::Vec3d(0, 1, 0)) - origin).length());
  return std::min(least, (transform.indexToWorld(openvdb::Vec3d(0, 0, 1)) - origin).length());
}

/// To single precision, all of them or none, so that files hold the same numbers.
void roundAll(std::vector<Mesh>& meshes, double most) {
  for (const Mesh& mesh : meshes) {
    for (const Position& p : mesh.positions) {
      if (!((Vec3(base::toSingle(p)) - Vec3(p)).length() <= most)) return;
    }
  }
  for (Mesh& mesh : meshes) {
    for (Position& p : mesh.positions) p = base::toSingle(p);
  }
}

}  // namespace

std::vector<InterfaceReport> shareInterfaces(const openvdb::GridBase& grid,
                                             const std::vector<std::int64_t>& labels,
                                             std::vector<Mesh>& meshes) {
  requireNets(meshes, labels);
  std::vector<InterfaceReport> reports(meshes.size());
  const openvdb::math::Transform& transform = grid.transform();
  filter::withIntegers(grid, [&](const auto& typed) {
    LabelReader reader(typed, labels);
    for (std::size_t n = 0; n < meshes.size(); ++n) {
      Mesh& mesh = meshes[n];
      const Coord* last = nullptr;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const Coord& cell = mesh.cells[v];
        const CellLabels corners = reader.cell(cell);
        requireChange(corners, labels[n], v);
        const Vec3 place = Vec3(cell) + meanOfChanges(corners);
        const auto world = transform.indexToWorld(openvdb::Vec3d(place[0], place[1], place[2]));
        mesh.positions[v] = {world[0], world[1], world[2]};
        reports[n].sharedVertices += labelsIn(corners) > 1 ? 1 : 0;
        // Those of one cell follow each other.
        reports[n].touchingVertices += last != nullptr && *last == cell ? 1 : 0;
        last = &cell;
      }
    }
  });
  constexpr double kMostRounding = 1e-4;
  roundAll(meshes, kMostRounding * shortestStep(transform));
  for (Mesh& mesh : meshes) {
    for (Quad& quad : mesh.quads) chooseDiagonal(mesh.positions, quad);
    if (!mesh.normals.empty()) setNormals(mesh);
  }
  return reports;
}

}  // namespace tufa
