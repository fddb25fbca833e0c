// .obj and .off: text. Numbers are the shortest that read back to the same value.

#include <array>
#include <charconv>
#include <string_view>

#include "io/mesh/mesh_format.h"

namespace tufa::io {
namespace {

/// A line of text while it is built.
class Line {
 public:
  explicit Line(MeshSink& sink) : sink_(sink) {}

  Line& text(std::string_view part) {
    end_ = std::copy(part.begin(), part.end(), end_);
    return *this;
  }
  template <class Number>
  Line& number(Number value) {
    end_ = std::to_chars(end_, buffer_.data() + buffer_.size(), value).ptr;
    return *this;
  }
  void finish() {
    *end_++ = '\n';
    sink_.write(buffer_.data(), static_cast<std::size_t>(end_ - buffer_.data()));
    end_ = buffer_.data();
  }

 private:
  MeshSink& sink_;
  std::array<char, 256> buffer_;  // the longest line has seven numbers of at most 24 characters
  char* end_ = buffer_.data();
};

template <class Vector>
void writeVector(Line& line, std::string_view keyword, const Vector& v) {
  line.text(keyword).number(v.x).text(" ").number(v.y).text(" ").number(v.z).finish();
}

void writePositions(const Mesh& mesh, MeshSink& sink, std::string_view keyword) {
  Line line(sink);
  const bool precise = needsDoublePrecision(mesh);
  forEachItem(sink, mesh.positions, [&](const Position& p) {
    if (precise) {
      writeVector(line, keyword, p);
    } else {
      writeVector(
          line, keyword,
          Normal(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)));
    }
  });
}

/// Object names end with the line, so no line break may be part of one.
std::string withoutBreaks(std::string name) {
  for (char& c : name) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return name;
}

}  // namespace

void writeObj(const Mesh& mesh, MeshSink& sink, const std::string& name) {
  const std::string head = "o " + withoutBreaks(name) + "\n";
  sink.write(head.data(), head.size());
  writePositions(mesh, sink, "v ");
  Line line(sink);
  forEachItem(sink, mesh.normals, [&](const Normal& n) { writeVector(line, "vn ", n); });
  const bool normals = !mesh.normals.empty();
  const auto writeFace = [&](const auto& face) {
    line.text("f");
    for (const VertexIndex vertex : face.vertices) {
      const std::uint64_t number = std::uint64_t{vertex} + 1;
      line.text(" ").number(number);
      if (normals) line.text("//").number(number);
    }
    line.finish();
  };
  forEachItem(sink, mesh.quads, writeFace);
  forEachItem(sink, mesh.triangles, writeFace);
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
