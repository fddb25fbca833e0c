// .obj and .off: text. Numbers are the shortest that read back to the same value, positions as
// doubles even if they are floats: the shortest digits of a float are another double, and sheets
// may be no farther apart than that.

#include <array>
#include <string_view>

#include "io/mesh/mesh_format.h"
#include "io/mesh/text_line.h"

namespace tufa::io {
namespace {

template <class Vector>
void writeVector(Line& line, std::string_view keyword, const Vector& v) {
  line.text(keyword).number(v.x).text(" ").number(v.y).text(" ").number(v.z).finish();
}

void writePositions(const Mesh& mesh, MeshSink& sink, std::string_view keyword) {
  Line line(sink);
  forEachItem(sink, mesh.positions, [&](const Position& p) { writeVector(line, keyword, p); });
}

/// Object names end with the line, so no line break may be part of one, and no backslash at the
/// end, which would join the next line to it.
std::string withoutBreaks(std::string name) {
  for (char& c : name) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  if (name.ends_with('\\')) name.back() = '_';
  return name;
}

}  // namespace

namespace {

/// The numbers of normals at the corners of faces, in the order that faces are written.
class CornerNormals {
 public:
  explicit CornerNormals(const MeshPart& part)
      : shaded_(part.shaded ? &*part.shaded : nullptr),
        triangle_(0),
        quad_(3 * part.mesh->triangles.size()) {}

  [[nodiscard]] std::array<std::uint64_t, 4> next(const Quad& q) {
    // The two triangles of a quad: 0 1 2 and 0 2 3. Should a crease run along its diagonal, the
    // first one tells the normals at both ends.
    const std::size_t at = quad_;
    quad_ += 6;
    if (shaded_ == nullptr) return {q.vertices[0], q.vertices[1], q.vertices[2], q.vertices[3]};
    const auto& indices = shaded_->indices;
    return {indices[at], indices[at + 1], indices[at + 2], indices[at + 5]};
  }
  [[nodiscard]] std::array<std::uint64_t, 3> next(const Triangle& t) {
    const std::size_t at = triangle_;
    triangle_ += 3;
    if (shaded_ == nullptr) return {t.vertices[0], t.vertices[1], t.vertices[2]};
    const auto& indices = shaded_->indices;
    return {indices[at], indices[at + 1], indices[at + 2]};
  }

 private:
  const ShadedMesh* shaded_;
  std::size_t triangle_;  ///< place in ShadedMesh::indices
  std::size_t quad_;      ///< the same
};

/// Adds one object; positions and normals are counted over the whole file.
void addObject(const MeshPart& part, std::uint64_t& positionsBefore, std::uint64_t& normalsBefore,
               MeshSink& sink) {
  const Mesh& mesh = *part.mesh;
  const std::string head = "o " + withoutBreaks(part.name) + "\n";
  sink.write(head.data(), head.size());
  writePositions(mesh, sink, "v ");
  Line line(sink);
  const std::vector<Normal>& normals = part.shaded ? part.shaded->normals : mesh.normals;
  forEachItem(sink, normals, [&](const Normal& n) { writeVector(line, "vn ", n); });
  CornerNormals corners(part);
  const auto writeFace = [&](const auto& face) {
    const auto normalOf = corners.next(face);
    line.text("f");
    for (std::size_t i = 0; i < face.vertices.size(); ++i) {
      line.text(" ").number(positionsBefore + face.vertices[i] + 1);
      if (!normals.empty()) line.text("//").number(normalsBefore + normalOf[i] + 1);
    }
    line.finish();
  };
  forEachItem(sink, mesh.quads, writeFace);
  forEachItem(sink, mesh.triangles, writeFace);
  positionsBefore += mesh.positions.size();
  normalsBefore += normals.size();
}

}  // namespace

void writeObj(std::span<const MeshPart> parts, MeshSink& sink) {
  std::uint64_t positions = 0, normals = 0;
  for (const MeshPart& part : parts) addObject(part, positions, normals, sink);
}

void writeOff(const Mesh& mesh, MeshSink& sink) {
  const std::string head = "OFF\n" + std::to_string(mesh.positions.size()) + " " +
                           std::to_string(mesh.quads.size() + mesh.triangles.size()) + " 0\n";
  sink.write(head.data(), head.size());
  writePositions(mesh, sink, "");
  Line line(sink);
  const auto writeFace = [&](const auto& face) {
    line.number(face.vertices.size());
    for (const VertexIndex vertex : face.vertices) line.text(" ").number(vertex);
    line.finish();
  };
  forEachItem(sink, mesh.quads, writeFace);
  forEachItem(sink, mesh.triangles, writeFace);
}

}  // namespace tufa::io
