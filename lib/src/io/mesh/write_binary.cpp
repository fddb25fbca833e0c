// .ply and .stl: little-endian binary.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "base/require_at_most.h"
#include "io/mesh/file_attributes.h"
#include "io/mesh/float_precision.h"
#include "io/mesh/mesh_format.h"

namespace tufa::io {
namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers are written as they lie in memory");

/// A record of fixed layout, packed without padding.
template <std::size_t kCapacity>
class Record {
 public:
  template <class Number>
  Record& add(Number value) {
    std::memcpy(bytes_.data() + size_, &value, sizeof value);
    size_ += sizeof value;
    return *this;
  }
  void writeTo(MeshSink& sink) {
    sink.write(bytes_.data(), size_);
    size_ = 0;
  }

 private:
  std::array<char, kCapacity> bytes_;
  std::size_t size_ = 0;
};

std::string plyHeader(const Mesh& mesh, bool precise) {
  const std::string scalar = precise ? "double" : "float";
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment written by tufa\n";
  header += "element vertex " + std::to_string(mesh.positions.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) header += "property " + scalar + " " + axis + "\n";
  if (!mesh.normals.empty()) {
    for (const char* axis : {"nx", "ny", "nz"}) {
      header += std::string("property float ") + axis + "\n";
    }
  }
  header += plyProperties(mesh.attributes);
  header += "element face " + std::to_string(mesh.quads.size() + mesh.triangles.size()) + "\n";
  // int rather than uint wherever it will do: some readers know no other type.
  const bool small = mesh.positions.size() <= std::size_t{std::numeric_limits<std::int32_t>::max()};
  header += std::string("property list uchar ") + (small ? "int" : "uint") + " vertex_indices\n";
  return header + "end_header\n";
}

void writePlyAttributes(const Mesh& mesh, std::size_t vertex, MeshSink& sink) {
  Record<4 * sizeof(float)> record;
  for (const Attribute& attribute : mesh.attributes) {
    forPlyValues(attribute, vertex, [&](auto value) { record.add(value); });
    record.writeTo(sink);
  }
}

template <class Scalar>
void writePlyVertices(const Mesh& mesh, MeshSink& sink) {
  Record<3 * sizeof(double) + 3 * sizeof(float)> record;
  std::size_t n = 0;
  forEachItem(sink, mesh.positions, [&](const Position& p) {
    record.add(static_cast<Scalar>(p.x))
        .add(static_cast<Scalar>(p.y))
        .add(static_cast<Scalar>(p.z));
    if (!mesh.normals.empty()) {
      const Normal& normal = mesh.normals[n];
      record.add(normal.x).add(normal.y).add(normal.z);
    }
    record.writeTo(sink);
    if (!mesh.attributes.empty()) writePlyAttributes(mesh, n, sink);
    ++n;
  });
}

std::array<float, 3> toFloats(const Position& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// The unit normal of a triangle, or zero where it has none.
std::array<float, 3> faceNormal(const Position& a, const Position& b, const Position& c) {
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
  const double vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
  const double length = std::sqrt(nx * nx + ny * ny + nz * nz);
  if (!(length > 0)) return {0, 0, 0};
  return toFloats({nx / length, ny / length, nz / length});
}

}  // namespace

void writePly(const Mesh& mesh, MeshSink& sink) {
  const bool precise = needsDoublePrecision(mesh);
  const std::string header = plyHeader(mesh, precise);
  sink.write(header.data(), header.size());
  if (precise) {
    writePlyVertices<double>(mesh, sink);
  } else {
    writePlyVertices<float>(mesh, sink);
  }
  Record<1 + 4 * sizeof(VertexIndex)> record;
  const auto writeFace = [&](const auto& face) {
    record.add(static_cast<std::uint8_t>(face.vertices.size()));
    for (const VertexIndex vertex : face.vertices) record.add(vertex);
    record.writeTo(sink);
  };
  forEachItem(sink, mesh.quads, writeFace);
  forEachItem(sink, mesh.triangles, writeFace);
}

void writeStl(const Mesh& mesh, MeshSink& sink) {
  base::requireAtMost(std::numeric_limits<std::uint32_t>::max(), mesh.triangleCount(), "triangles",
                      ".stl");
  // Not "solid": readers take files that begin so for text.
  std::array<char, 80> header{};
  const std::string_view title = "binary STL written by tufa";
  std::copy(title.begin(), title.end(), header.begin());
  sink.write(header.data(), header.size());
  const std::uint32_t count = static_cast<std::uint32_t>(mesh.triangleCount());
  sink.write(&count, sizeof count);

  Record<50> record;
  const auto writeTriangle = [&](VertexIndex a, VertexIndex b, VertexIndex c) {
    const std::array<Position, 3> corners{mesh.positions.at(a), mesh.positions.at(b),
                                          mesh.positions.at(c)};
    for (const float x : faceNormal(corners[0], corners[1], corners[2])) record.add(x);
    for (const Position& corner : corners) {
      for (const float x : toFloats(corner)) record.add(x);
    }
    record.add(std::uint16_t{0}).writeTo(sink);
  };
  forEachItem(sink, mesh.quads, [&](const Quad& quad) {
    const auto& v = quad.vertices;
    writeTriangle(v[0], v[1], v[2]);
    writeTriangle(v[0], v[2], v[3]);
  });
  forEachItem(sink, mesh.triangles, [&](const Triangle& triangle) {
    writeTriangle(triangle.vertices[0], triangle.vertices[1], triangle.vertices[2]);
  });
}

}  // namespace tufa::io
