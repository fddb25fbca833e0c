// .usda: OpenUSD as text. Arrays are on one line each, as OpenUSD itself writes them and as readers
// that go by lines need them.

#include <tufa/io.h>
#include <array>
#include <charconv>
#include <set>
#include <string>

#include "io/gltf/glb.h"
#include "io/mesh/file_attributes.h"
#include "io/mesh/float_precision.h"
#include "io/mesh/mesh_format.h"
#include "io/mesh/text_line.h"

namespace tufa::io {
namespace {

using Floats = std::array<float, 3>;

/// Names of prims and primvars are identifiers, each once among its neighbours.
class Identifiers {
 public:
  std::string of(const std::string& name) {
    std::string identifier = plainName(name);
    if (identifier.empty() || (identifier[0] >= '0' && identifier[0] <= '9')) {
      identifier.insert(identifier.begin(), '_');
    }
    std::string unique = identifier;
    for (int n = 2; !taken_.insert(unique).second; ++n) {
      unique = identifier;
      unique.append(1, '_').append(std::to_string(n));
    }
    return unique;
  }

 private:
  std::set<std::string> taken_;
};

/// Writes prims into one another.
class Writer {
 public:
  explicit Writer(MeshSink& sink) : sink_(sink), line_(sink) {}

  void text(const std::string& line) {
    const std::string whole = std::string(depth_, ' ').append(line).append(1, '\n');
    sink_.write(whole.data(), whole.size());
  }
  /// What stands between braces.
  template <class Body>
  void block(Body&& body) {
    depth_ += kStep;
    body();
    depth_ -= kStep;
    text("}");
  }
  /// A prim.
  template <class Body>
  void block(const std::string& head, Body&& body) {
    text(head);
    text("{");
    block(body);
  }
  /// A set of variants, or a variant, whose brace must stand in the line of its name.
  template <class Body>
  void variant(const std::string& head, Body&& body) {
    text(std::string(head).append(" {"));
    block(body);
  }

  /// An array of `count` elements, each of which element(i, line) adds.
  template <class Element>
  void array(const std::string& type, const std::string& name, std::size_t count,
             const std::string& metadata, Element&& element) {
    const std::string head =
        std::string(depth_, ' ').append(type).append("[] ").append(name).append(" = [");
    sink_.write(head.data(), head.size());
    for (std::size_t i = 0; i < count; ++i) {
      if (i > 0) line_.text(", ");
      element(i, line_);
      line_.flush();
      if ((i + 1) % MeshSink::kStride == 0) sink_.advance(MeshSink::kStride);
    }
    sink_.advance(count % MeshSink::kStride);
    std::string tail(1, ']');
    if (!metadata.empty()) tail.append(" (").append(metadata).append(1, ')');
    tail.append(1, '\n');
    sink_.write(tail.data(), tail.size());
  }

 private:
  static constexpr std::size_t kStep = 4;
  MeshSink& sink_;
  Line line_;
  std::size_t depth_ = 0;
};

void addTriple(Line& line, const Floats& v) {
  line.text("(").number(v[0]).text(", ").number(v[1]).text(", ").number(v[2]).text(")");
}

std::string textOf(double number) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  return {digits.data(), end};
}

Floats relativeTo(const Position& origin, const Position& p) {
  return {static_cast<float>(p.x - origin.x), static_cast<float>(p.y - origin.y),
          static_cast<float>(p.z - origin.z)};
}

void writeFaces(Writer& writer, const MeshPart& part) {
  const Mesh& mesh = *part.mesh;
  if (part.shaded) {
    const std::vector<VertexIndex>& indices = part.shaded->indices;
    writer.array("int", "faceVertexCounts", indices.size() / 3, "",
                 [](std::size_t, Line& line) { line.text("3"); });
    writer.array("int", "faceVertexIndices", indices.size(), "",
                 [&](std::size_t i, Line& line) { line.number(part.shaded->sources[indices[i]]); });
    return;
  }
  const std::size_t quads = mesh.quads.size();
  const std::size_t faces = quads + mesh.triangles.size();
  writer.array("int", "faceVertexCounts", faces, "",
               [&](std::size_t i, Line& line) { line.text(i < quads ? "4" : "3"); });
  writer.array("int", "faceVertexIndices", faces, "", [&](std::size_t i, Line& line) {
    const auto add = [&](const auto& face) {
      for (std::size_t k = 0; k < face.vertices.size(); ++k) {
        line.text(k > 0 ? ", " : "").number(face.vertices[k]);
      }
    };
    if (i < quads) {
      add(mesh.quads[i]);
    } else {
      add(mesh.triangles[i - quads]);
    }
  });
}

void writeNormals(Writer& writer, const MeshPart& part) {
  const auto write = [&](std::size_t count, const char* interpolation, auto&& normalAt) {
    writer.array("normal3f", "normals", count,
                 std::string("interpolation = \"") + interpolation + "\"",
                 [&](std::size_t i, Line& line) { addTriple(line, glb::unitNormal(normalAt(i))); });
  };
  if (part.shaded) {
    const auto& [sources, normals, indices] = *part.shaded;
    write(indices.size(), "faceVarying",
          [&normals = normals, &indices = indices](std::size_t i) { return normals[indices[i]]; });
  } else if (!part.mesh->normals.empty()) {
    write(part.mesh->normals.size(), "vertex",
          [&](std::size_t i) { return part.mesh->normals[i]; });
  }
}

/// The type and the name of an attribute's primvar.
std::string typeOf(const Attribute& attribute) {
  if (attribute.role == AttributeRole::Colour) return "color3f";
  constexpr std::array kTypes = {"float", "float2", "float3", "float4"};
  return kTypes[static_cast<std::size_t>(attribute.width - 1)];
}

void writeAttributes(Writer& writer, const Mesh& mesh) {
  Identifiers names;
  for (const Attribute& attribute : mesh.attributes) {
    const bool colour = attribute.role == AttributeRole::Colour;
    const std::string name =
        std::string("primvars:").append(names.of(colour ? "displayColor" : attribute.name));
    const auto width = static_cast<std::size_t>(attribute.width);
    writer.array(typeOf(attribute), name, mesh.positions.size(), "interpolation = \"vertex\"",
                 [&](std::size_t v, Line& line) {
                   if (width > 1) line.text("(");
                   for (std::size_t i = 0; i < width; ++i) {
                     if (i > 0) line.text(", ");
                     line.number(attribute.values[v * width + i]);
                   }
                   if (width > 1) line.text(")");
                 });
  }
}

/// How a prim begins.
std::string headOf(const char* type, const std::string& name) {
  return std::string("def ").append(type).append(" \"").append(name).append(1, '"');
}

/// One prim of type Mesh.
void writePrim(Writer& writer, const MeshPart& part, const std::string& name) {
  const Mesh& mesh = *part.mesh;
  const Position origin = floatOrigin(mesh);
  const Bounds bounds = boundsOf(mesh);
  writer.block(headOf("Mesh", name), [&] {
    writer.array("float3", "extent", 2, "", [&](std::size_t i, Line& line) {
      addTriple(line, relativeTo(origin, i == 0 ? bounds.least : bounds.greatest));
    });
    writeFaces(writer, part);
    writer.array("point3f", "points", mesh.positions.size(), "", [&](std::size_t v, Line& line) {
      addTriple(line, relativeTo(origin, mesh.positions[v]));
    });
    writeNormals(writer, part);
    writeAttributes(writer, mesh);
    // Else USD takes it for the cage of a smooth surface.
    writer.text("uniform token subdivisionScheme = \"none\"");
    if (origin == Position(0, 0, 0)) return;
    writer.text(std::string("double3 xformOp:translate = (")
                    .append(textOf(origin.x) + ", " + textOf(origin.y) + ", " + textOf(origin.z))
                    .append(1, ')'));
    writer.text("uniform token[] xformOpOrder = [\"xformOp:translate\"]");
  });
}

std::string rootName(const FileFrame& frame) { return Identifiers().of(frame.name); }

void writeHead(Writer& writer, const FileFrame& frame) {
  writer.text("#usda 1.0");
  writer.text("(");
  writer.text(std::string("    defaultPrim = \"").append(rootName(frame)).append(1, '"'));
  writer.text("    doc = \"written by tufa\"");
  writer.text(std::string("    metersPerUnit = ").append(textOf(frame.scale)));
  writer.text(std::string("    upAxis = \"") + (frame.up == UpAxis::Z ? "Z" : "Y") + "\"");
  writer.text(")");
  writer.text("");
}

}  // namespace

std::size_t usdaItems(const MeshPart& part) {
  const Mesh& mesh = *part.mesh;
  const std::size_t points = (1 + mesh.attributes.size()) * mesh.positions.size();
  if (part.shaded) {
    const std::size_t corners = part.shaded->indices.size();
    return corners / 3 + 2 * corners + points;
  }
  const std::size_t faces = mesh.quads.size() + mesh.triangles.size();
  return 2 * faces + mesh.normals.size() + points;
}

void writeUsda(std::span<const MeshPart> parts, const FileFrame& frame, MeshSink& sink) {
  Writer writer(sink);
  writeHead(writer, frame);
  writer.block(headOf("Xform", rootName(frame)), [&] {
    Identifiers names;
    for (const MeshPart& part : parts) writePrim(writer, part, names.of(part.name));
  });
}

void writeUsdaLods(std::span<const MeshPart> levels, const FileFrame& frame, MeshSink& sink) {
  Writer writer(sink);
  writeHead(writer, frame);
  writer.text(headOf("Xform", rootName(frame)).append(" ("));
  if (!levels.empty()) {
    writer.text("    variants = {");
    writer.text("        string LOD = \"LOD0\"");
    writer.text("    }");
    writer.text("    prepend variantSets = \"LOD\"");
  }
  writer.block(")", [&] {
    if (levels.empty()) return;
    writer.variant("variantSet \"LOD\" =", [&] {
      for (std::size_t level = 0; level < levels.size(); ++level) {
        writer.variant(std::string("\"LOD").append(std::to_string(level)).append(1, '"'),
                       [&] { writePrim(writer, levels[level], "surface"); });
      }
    });
  });
}

}  // namespace tufa::io
