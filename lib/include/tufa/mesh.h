#pragma once

#include <tufa/coord.h>
#include <tufa/export.h>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tufa {

/// A point in the grid's world space. Double, so that a volume far from the origin keeps its
/// detail. Default construction leaves the coordinates unset: large arrays are filled in parallel.
struct Position {
  double x;      ///< world units
  double y;      ///< world units
  double z;      ///< world units
  Position() {}  // NOLINT(modernize-use-equals-default): "= default" would zero every array
  /// From three coordinates.
  Position(double px, double py, double pz) : x(px), y(py), z(pz) {}
  /// Equal in every coordinate.
  friend bool operator==(const Position&, const Position&) = default;
};

/// A unit vector in world space, pointing outward.
struct Normal {
  float x;     ///< of a vector of length 1
  float y;     ///< of a vector of length 1
  float z;     ///< of a vector of length 1
  Normal() {}  // NOLINT(modernize-use-equals-default)
  /// From three components.
  Normal(float nx, float ny, float nz) : x(nx), y(ny), z(nz) {}
  /// Equal in every component.
  friend bool operator==(const Normal&, const Normal&) = default;
};

/// Index into Mesh::positions.
using VertexIndex = std::uint32_t;

/// Three vertices, counter-clockwise seen from outside.
struct Triangle {
  std::array<VertexIndex, 3> vertices;  ///< the corners
  Triangle() {}                         // NOLINT(modernize-use-equals-default)
  /// From its corners in order.
  Triangle(VertexIndex a, VertexIndex b, VertexIndex c) : vertices{a, b, c} {}
  /// The same corners, and the same one first.
  friend bool operator==(const Triangle&, const Triangle&) = default;
};

/// Four vertices, counter-clockwise seen from outside. The better of the two ways to split it is
/// always the diagonal from vertices[0] to vertices[2], so a program that fans polygons from their
/// first vertex shows the surface as intended.
struct Quad {
  std::array<VertexIndex, 4> vertices;  ///< the corners
  Quad() {}                             // NOLINT(modernize-use-equals-default)
  /// From its corners in order.
  Quad(VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d) : vertices{a, b, c, d} {}
  /// The same corners, and the same one first.
  friend bool operator==(const Quad&, const Quad&) = default;
};

/// What an attribute is to programs that read a file.
enum class AttributeRole {
  Value,   ///< a number or a vector: a property of its own name in .ply, `_NAME` in .glb
  Colour,  ///< linear red, green and blue from 0 to 1: `COLOR_0` in .glb, in bytes in .ply
  /// How far a position moves, a vector in world units: a morph target in .glb; no other format
  /// holds it.
  Motion,
};

/// Values at the vertices of a mesh, such as a temperature or a velocity.
struct Attribute {
  std::string name;  ///< "temperature"
  int width = 1;     ///< values for each vertex, 1 to 4; a colour and a motion have 3
  AttributeRole role = AttributeRole::Value;  ///< for files
  std::vector<float> values = {};             ///< those of one position after the other
};

/// An indexed polygon mesh. Plain data, no hidden state.
struct Mesh {
  std::vector<Position> positions;  ///< world space
  std::vector<Normal> normals;      ///< empty, or one for each position
  std::vector<Quad> quads;          ///< faces of four corners
  std::vector<Triangle> triangles;  ///< faces of three corners
  /// Values at the positions; what makes meshes leaves them empty, see <tufa/attributes.h>.
  std::vector<Attribute> attributes = {};
  /// Empty, or for each position the cell of the grid that it lies in, by the cell's least lattice
  /// point: for hosts that look up more of the grid there. See ContourOptions::keepCells.
  std::vector<Coord> cells = {};

  /// Triangles once every quad is split in two.
  [[nodiscard]] std::size_t triangleCount() const { return triangles.size() + 2 * quads.size(); }
};

/// All faces as triangles: the mesh's own first, then two for each quad, split from vertices[0] to
/// vertices[2].
[[nodiscard]] TUFA_API std::vector<Triangle> triangulate(const Mesh& mesh);

}  // namespace tufa
