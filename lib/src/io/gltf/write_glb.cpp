// .glb: the binary container of glTF 2.0, one mesh of triangles under one node.

#include "io/gltf/glb.h"
#include "io/mesh/mesh_format.h"

namespace tufa::io {
namespace {

using glb::Floats;
using glb::Json;

/// Where the parts of the binary chunk lie.
struct Layout {
  bool shortIndices = false;
  std::uint64_t indexCount = 0;
  std::uint64_t positionBytes = 0;
  std::uint64_t normalBytes = 0;
  std::uint64_t indexBytes = 0;  ///< without padding
  [[nodiscard]] std::uint64_t bufferBytes() const {
    return positionBytes + normalBytes + (indexBytes + 3) / 4 * 4;
  }
};

Layout layOut(const Mesh& mesh) {
  Layout layout;
  layout.shortIndices = mesh.positions.size() <= glb::kMostShortVertices;
  layout.indexCount = 3 * std::uint64_t{mesh.triangleCount()};
  layout.positionBytes = sizeof(Floats) * mesh.positions.size();
  layout.normalBytes = sizeof(Floats) * mesh.normals.size();
  layout.indexBytes = layout.indexCount * (layout.shortIndices ? 2 : 4);
  return layout;
}

/// The middle of the mesh in single precision: what the node's translation gives back exactly. Not
/// inline: GCC 12 at -O3 optimizes a vectorized rounding to float and back to double away, and
/// positions would be relative to another middle than the one written.
[[gnu::noinline]] Floats middleOf(const Bounds& bounds) {
  return {static_cast<float>(0.5 * (bounds.least.x + bounds.greatest.x)),
          static_cast<float>(0.5 * (bounds.least.y + bounds.greatest.y)),
          static_cast<float>(0.5 * (bounds.least.z + bounds.greatest.z))};
}

Floats relativeTo(const Floats& origin, const Position& p) {
  return {static_cast<float>(p.x - origin[0]), static_cast<float>(p.y - origin[1]),
          static_cast<float>(p.z - origin[2])};
}

std::size_t addView(Json& json, std::uint64_t offset, std::uint64_t bytes, int target) {
  return glb::add(
      json, "bufferViews",
      {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}, {"target", target}});
}

Json describe(const Mesh& mesh, const Layout& layout, const Floats& middle,
              const std::string& name) {
  const Bounds bounds = boundsOf(mesh);
  Json json = glb::emptyDocument();
  json["scenes"] = Json::array({{{"nodes", {0}}}});
  json["nodes"] = Json::array({{{"name", name}, {"mesh", 0}, {"translation", middle}}});
  json["buffers"] = Json::array({{{"byteLength", layout.bufferBytes()}}});

  const std::size_t positionView = addView(json, 0, layout.positionBytes, glb::kArrayBuffer);
  Json attributes;
  attributes["POSITION"] = glb::add(json, "accessors",
                                    {{"bufferView", positionView},
                                     {"componentType", glb::kFloat},
                                     {"count", mesh.positions.size()},
                                     {"type", "VEC3"},
                                     {"min", relativeTo(middle, bounds.least)},
                                     {"max", relativeTo(middle, bounds.greatest)}});
  if (!mesh.normals.empty()) {
    const std::size_t view =
        addView(json, layout.positionBytes, layout.normalBytes, glb::kArrayBuffer);
    attributes["NORMAL"] = glb::add(json, "accessors",
                                    {{"bufferView", view},
                                     {"componentType", glb::kFloat},
                                     {"count", mesh.normals.size()},
                                     {"type", "VEC3"}});
  }
  const std::size_t indexView = addView(json, layout.positionBytes + layout.normalBytes,
                                        layout.indexBytes, glb::kElementArrayBuffer);
  const std::size_t indices =
      glb::add(json, "accessors",
               {{"bufferView", indexView},
                {"componentType", layout.shortIndices ? glb::kUnsignedShort : glb::kUnsignedInt},
                {"count", layout.indexCount},
                {"type", "SCALAR"}});
  const Json primitive = {{"attributes", attributes}, {"indices", indices}, {"mode", 4}};
  json["meshes"] = Json::array({{{"name", name}, {"primitives", Json::array({primitive})}}});
  return json;
}

template <class Index>
void writeIndices(const Mesh& mesh, MeshSink& sink) {
  const auto writeTriangle = [&](VertexIndex a, VertexIndex b, VertexIndex c) {
    const std::array<Index, 3> triangle{static_cast<Index>(a), static_cast<Index>(b),
                                        static_cast<Index>(c)};
    sink.write(triangle.data(), sizeof triangle);
  };
  forEachItem(sink, mesh.triangles, [&](const Triangle& t) {
    writeTriangle(t.vertices[0], t.vertices[1], t.vertices[2]);
  });
  forEachItem(sink, mesh.quads, [&](const Quad& q) {
    writeTriangle(q.vertices[0], q.vertices[1], q.vertices[2]);
    writeTriangle(q.vertices[0], q.vertices[2], q.vertices[3]);
  });
}

void writeHead(MeshSink& sink, const Json& document, std::uint64_t binaryBytes) {
  const std::string head = glb::head(document, binaryBytes);
  sink.write(head.data(), head.size());
}

}  // namespace

void writeGlb(const Mesh& mesh, MeshSink& sink, const std::string& name) {
  if (mesh.triangleCount() == 0) {
    writeHead(sink, glb::emptyDocument(), 0);
    return;
  }
  const Layout layout = layOut(mesh);
  const Floats middle = needsDoublePrecision(mesh) ? middleOf(boundsOf(mesh)) : Floats{};
  writeHead(sink, describe(mesh, layout, middle, name), layout.bufferBytes());
  forEachItem(sink, mesh.positions, [&](const Position& p) {
    const Floats relative = relativeTo(middle, p);
    sink.write(relative.data(), sizeof relative);
  });
  forEachItem(sink, mesh.normals, [&](const Normal& n) {
    const Floats unit = glb::unitNormal(n);
    sink.write(unit.data(), sizeof unit);
  });
  if (layout.shortIndices) {
    writeIndices<std::uint16_t>(mesh, sink);
  } else {
    writeIndices<std::uint32_t>(mesh, sink);
  }
  const std::uint32_t padding = 0;
  sink.write(&padding,
             layout.bufferBytes() - layout.positionBytes - layout.normalBytes - layout.indexBytes);
}

}  // namespace tufa::io
