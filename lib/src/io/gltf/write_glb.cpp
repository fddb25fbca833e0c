// .glb: the binary container of glTF 2.0, meshes of triangles under a node each.

#include <algorithm>
#include <cmath>

#include "io/gltf/glb.h"
#include "io/mesh/file_attributes.h"
#include "io/mesh/float_precision.h"
#include "io/mesh/mesh_format.h"

namespace tufa::io {
namespace {

using glb::Floats;
using glb::Json;

/// A part, and where its arrays lie in the binary chunk.
struct Layout {
  const Mesh* mesh = nullptr;
  const ShadedMesh* shaded = nullptr;  ///< null: one vertex for each position
  Floats middle{};                     ///< what the node's translation gives back
  bool shortIndices = false;
  std::uint64_t begin = 0;
  std::uint64_t vertexCount = 0;
  std::uint64_t normalCount = 0;
  std::uint64_t indexCount = 0;
  /// The position of a written vertex.
  [[nodiscard]] std::size_t sourceOf(std::size_t vertex) const {
    return shaded != nullptr ? shaded->sources[vertex] : vertex;
  }
  [[nodiscard]] std::uint64_t positionBytes() const { return sizeof(Floats) * vertexCount; }
  [[nodiscard]] std::uint64_t normalBytes() const { return sizeof(Floats) * normalCount; }
  [[nodiscard]] std::uint64_t bytesOf(const Attribute& attribute) const {
    return sizeof(float) * static_cast<std::uint64_t>(attribute.width) * vertexCount;
  }
  [[nodiscard]] std::uint64_t attributeBytes() const {
    std::uint64_t bytes = 0;
    for (const Attribute& attribute : mesh->attributes) bytes += bytesOf(attribute);
    return bytes;
  }
  /// Without padding.
  [[nodiscard]] std::uint64_t indexBytes() const { return indexCount * (shortIndices ? 2 : 4); }
  [[nodiscard]] std::uint64_t padding() const { return (4 - indexBytes() % 4) % 4; }
  [[nodiscard]] std::uint64_t end() const {
    return begin + positionBytes() + normalBytes() + attributeBytes() + indexBytes() + padding();
  }
};

Layout layOut(const MeshPart& part, std::uint64_t begin) {
  const Mesh& mesh = *part.mesh;
  Layout layout;
  layout.mesh = &mesh;
  layout.shaded = part.shaded ? &*part.shaded : nullptr;
  const Position middle = floatOrigin(mesh);  // the node's translation gives it back exactly
  layout.middle = {static_cast<float>(middle.x), static_cast<float>(middle.y),
                   static_cast<float>(middle.z)};
  layout.begin = begin;
  layout.vertexCount = part.shaded ? part.shaded->sources.size() : mesh.positions.size();
  layout.normalCount = part.shaded ? part.shaded->normals.size() : mesh.normals.size();
  layout.indexCount = 3 * std::uint64_t{mesh.triangleCount()};
  layout.shortIndices = layout.vertexCount <= glb::kMostShortVertices;
  return layout;
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

/// The node of a mesh: it turns the volume's axis that points up to y, and world units to metres.
Json nodeOf(const Layout& layout, const FileFrame& frame, const std::string& name,
            std::size_t mesh) {
  Json node = {{"name", name}, {"mesh", mesh}, {"translation", layout.middle}};
  if (frame.up == UpAxis::Y && frame.scale == 1) return node;
  const auto& [x, y, z] = layout.middle;
  std::array<double, 3> middle{x, y, z};
  if (frame.up == UpAxis::Z) {
    middle = {x, z, -double{y}};
    const double half = std::sqrt(0.5);
    node["rotation"] = {-half, 0.0, 0.0, half};
  }
  // Without + 0 there would be -0 too.
  for (double& coordinate : middle) coordinate = frame.scale * coordinate + 0.0;
  node["translation"] = middle;
  if (frame.scale != 1) node["scale"] = {frame.scale, frame.scale, frame.scale};
  return node;
}

/// The least and the greatest of the written values of a motion.
std::array<Floats, 2> rangeOf(const Layout& layout, const Attribute& motion) {
  std::array<Floats, 2> range{};
  for (std::size_t vertex = 0; vertex < layout.vertexCount; ++vertex) {
    const float* const value = motion.values.data() + 3 * layout.sourceOf(vertex);
    for (std::size_t i = 0; i < 3; ++i) {
      range[0][i] = vertex == 0 ? value[i] : std::min(range[0][i], value[i]);
      range[1][i] = vertex == 0 ? value[i] : std::max(range[1][i], value[i]);
    }
  }
  return range;
}

/// Adds accessors of floats for the attributes of a part, whose first lies at `begin`, and names
/// them in a primitive.
void describeAttributes(Json& json, const Layout& layout, std::uint64_t begin, Json& primitive) {
  const std::vector<Attribute>& all = layout.mesh->attributes;
  const std::vector<std::string> names = gltfNames(all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t view = addView(json, begin, layout.bytesOf(all[i]), glb::kArrayBuffer);
    begin += layout.bytesOf(all[i]);
    Json accessor = {{"bufferView", view},
                     {"componentType", glb::kFloat},
                     {"count", layout.vertexCount},
                     {"type", gltfType(all[i])}};
    if (all[i].role != AttributeRole::Motion) {
      primitive["attributes"][names[i]] = glb::add(json, "accessors", std::move(accessor));
      continue;
    }
    const auto [least, greatest] = rangeOf(layout, all[i]);
    accessor["min"] = least;
    accessor["max"] = greatest;
    primitive["targets"].push_back(
        {{"POSITION", glb::add(json, "accessors", std::move(accessor))}});
  }
}

/// Adds the mesh of a part and its node.
void describe(Json& json, const Layout& layout, const std::string& name, const FileFrame& frame) {
  const Bounds bounds = boundsOf(*layout.mesh);
  const std::size_t positionView =
      addView(json, layout.begin, layout.positionBytes(), glb::kArrayBuffer);
  Json primitive;
  Json& attributes = primitive["attributes"];
  attributes["POSITION"] = glb::add(json, "accessors",
                                    {{"bufferView", positionView},
                                     {"componentType", glb::kFloat},
                                     {"count", layout.vertexCount},
                                     {"type", "VEC3"},
                                     {"min", relativeTo(layout.middle, bounds.least)},
                                     {"max", relativeTo(layout.middle, bounds.greatest)}});
  const std::uint64_t normalBegin = layout.begin + layout.positionBytes();
  if (layout.normalCount > 0) {
    const std::size_t view = addView(json, normalBegin, layout.normalBytes(), glb::kArrayBuffer);
    attributes["NORMAL"] = glb::add(json, "accessors",
                                    {{"bufferView", view},
                                     {"componentType", glb::kFloat},
                                     {"count", layout.normalCount},
                                     {"type", "VEC3"}});
  }
  const std::uint64_t attributeBegin = normalBegin + layout.normalBytes();
  describeAttributes(json, layout, attributeBegin, primitive);
  const std::size_t indexView = addView(json, attributeBegin + layout.attributeBytes(),
                                        layout.indexBytes(), glb::kElementArrayBuffer);
  const std::size_t indices =
      glb::add(json, "accessors",
               {{"bufferView", indexView},
                {"componentType", layout.shortIndices ? glb::kUnsignedShort : glb::kUnsignedInt},
                {"count", layout.indexCount},
                {"type", "SCALAR"}});
  primitive["indices"] = indices;
  primitive["mode"] = 4;
  Json mesh = {{"name", name}, {"primitives", Json::array({std::move(primitive)})}};
  glb::addMotions(mesh, layout.mesh->attributes);
  const std::size_t number = glb::add(json, "meshes", std::move(mesh));
  glb::add(json, "nodes", nodeOf(layout, frame, name, number));
}

template <class Index>
void writeIndices(const Layout& layout, MeshSink& sink) {
  const auto writeTriangle = [&](VertexIndex a, VertexIndex b, VertexIndex c) {
    const std::array<Index, 3> triangle{static_cast<Index>(a), static_cast<Index>(b),
                                        static_cast<Index>(c)};
    sink.write(triangle.data(), sizeof triangle);
  };
  if (layout.shaded != nullptr) {
    forEachItem(sink, layout.shaded->indices, [&](VertexIndex vertex) {
      const auto index = static_cast<Index>(vertex);
      sink.write(&index, sizeof index);
    });
    return;
  }
  forEachItem(sink, layout.mesh->triangles, [&](const Triangle& t) {
    writeTriangle(t.vertices[0], t.vertices[1], t.vertices[2]);
  });
  forEachItem(sink, layout.mesh->quads, [&](const Quad& q) {
    writeTriangle(q.vertices[0], q.vertices[1], q.vertices[2]);
    writeTriangle(q.vertices[0], q.vertices[2], q.vertices[3]);
  });
}

void writeAttribute(const Layout& layout, const Attribute& attribute, MeshSink& sink) {
  const auto width = static_cast<std::size_t>(attribute.width);
  for (std::size_t vertex = 0; vertex < layout.vertexCount; ++vertex) {
    const std::size_t source = layout.sourceOf(vertex);
    for (std::size_t i = source * width; i < (source + 1) * width; ++i) {
      const float value = gltfValue(attribute, i);
      sink.write(&value, sizeof value);
    }
    if (vertex % MeshSink::kStride == 0) sink.advance(0);
  }
}

void writeArrays(const Layout& layout, MeshSink& sink) {
  const std::vector<Position>& positions = layout.mesh->positions;
  const auto writePosition = [&](const Position& p) {
    const Floats relative = relativeTo(layout.middle, p);
    sink.write(relative.data(), sizeof relative);
  };
  if (layout.shaded != nullptr) {
    forEachItem(sink, layout.shaded->sources,
                [&](VertexIndex source) { writePosition(positions[source]); });
  } else {
    forEachItem(sink, positions, writePosition);
  }
  forEachItem(sink, layout.shaded != nullptr ? layout.shaded->normals : layout.mesh->normals,
              [&](const Normal& n) {
                const Floats unit = glb::unitNormal(n);
                sink.write(unit.data(), sizeof unit);
              });
  for (const Attribute& attribute : layout.mesh->attributes) {
    writeAttribute(layout, attribute, sink);
  }
  if (layout.shortIndices) {
    writeIndices<std::uint16_t>(layout, sink);
  } else {
    writeIndices<std::uint32_t>(layout, sink);
  }
  const std::uint32_t zero = 0;
  sink.write(&zero, layout.padding());
}

}  // namespace

void writeGlb(std::span<const MeshPart> parts, const FileFrame& frame, MeshSink& sink) {
  Json document = glb::emptyDocument();
  std::vector<Layout> layouts;
  std::uint64_t bytes = 0;
  for (const MeshPart& part : parts) {
    if (part.mesh->triangleCount() == 0) continue;
    layouts.push_back(layOut(part, bytes));
    bytes = layouts.back().end();
    describe(document, layouts.back(), part.name, frame);
    document["scenes"][0]["nodes"].push_back(layouts.size() - 1);
  }
  if (bytes > 0) document["buffers"] = Json::array({{{"byteLength", bytes}}});
  const std::string head = glb::head(document, bytes);
  sink.write(head.data(), head.size());
  for (const Layout& layout : layouts) writeArrays(layout, sink);
}

}  // namespace tufa::io
