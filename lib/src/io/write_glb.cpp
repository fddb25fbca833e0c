// .glb: the binary container of glTF 2.0, one mesh of triangles under one node.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "io/mesh_format.h"

namespace tufa::io {
namespace {

using Json = nlohmann::ordered_json;
using Floats = std::array<float, 3>;

// Constants of the glTF 2.0 specification.
constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004E4942;
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;

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
  // 65535 itself restarts primitives, so the largest short index is one less.
  layout.shortIndices = mesh.positions.size() <= 65535;
  layout.indexCount = 3 * std::uint64_t{mesh.triangleCount()};
  layout.positionBytes = sizeof(Floats) * mesh.positions.size();
  layout.normalBytes = sizeof(Floats) * mesh.normals.size();
  layout.indexBytes = layout.indexCount * (layout.shortIndices ? 2 : 4);
  return layout;
}

/// The middle of the mesh in single precision: what the node's translation gives back exactly. Not
/// inline: GCC 12 at -O3 takes a vectorized rounding to float and back to double for nothing to do,
/// and positions would be relative to another middle than the one written.
[[gnu::noinline]] Floats middleOf(const Bounds& bounds) {
  return {static_cast<float>(0.5 * (bounds.least.x + bounds.greatest.x)),
          static_cast<float>(0.5 * (bounds.least.y + bounds.greatest.y)),
          static_cast<float>(0.5 * (bounds.least.z + bounds.greatest.z))};
}

Floats relativeTo(const Floats& origin, const Position& p) {
  return {static_cast<float>(p.x - origin[0]), static_cast<float>(p.y - origin[1]),
          static_cast<float>(p.z - origin[2])};
}

Json addView(Json& json, std::uint64_t offset, std::uint64_t bytes, int target) {
  json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}, {"target", target}});
  return json["bufferViews"].size() - 1;
}

/// glTF has no empty buffers, accessors or meshes: an empty mesh is an empty scene.
Json emptyScene() {
  return {{"asset", {{"version", "2.0"}, {"generator", "tufa"}}},
          {"scene", 0},
          {"scenes", Json::array({Json::object()})}};
}

Json describe(const Mesh& mesh, const Layout& layout, const Floats& middle,
              const std::string& name) {
  const Bounds bounds = boundsOf(mesh);
  Json json;
  json["asset"] = {{"version", "2.0"}, {"generator", "tufa"}};
  json["scene"] = 0;
  json["scenes"] = Json::array({{{"nodes", {0}}}});
  json["nodes"] = Json::array({{{"name", name}, {"mesh", 0}, {"translation", middle}}});
  json["buffers"] = Json::array({{{"byteLength", layout.bufferBytes()}}});

  const Json positionView = addView(json, 0, layout.positionBytes, kArrayBuffer);
  json["accessors"].push_back({{"bufferView", positionView},
                               {"componentType", kFloat},
                               {"count", mesh.positions.size()},
                               {"type", "VEC3"},
                               {"min", relativeTo(middle, bounds.least)},
                               {"max", relativeTo(middle, bounds.greatest)}});
  Json attributes = {{"POSITION", 0}};
  if (!mesh.normals.empty()) {
    const Json view = addView(json, layout.positionBytes, layout.normalBytes, kArrayBuffer);
    attributes["NORMAL"] = json["accessors"].size();
    json["accessors"].push_back({{"bufferView", view},
                                 {"componentType", kFloat},
                                 {"count", mesh.normals.size()},
                                 {"type", "VEC3"}});
  }
  const Json indexView = addView(json, layout.positionBytes + layout.normalBytes, layout.indexBytes,
                                 kElementArrayBuffer);
  Json primitive = {{"attributes", attributes}, {"indices", json["accessors"].size()}, {"mode", 4}};
  json["accessors"].push_back(
      {{"bufferView", indexView},
       {"componentType", layout.shortIndices ? kUnsignedShort : kUnsignedInt},
       {"count", layout.indexCount},
       {"type", "SCALAR"}});
  json["meshes"] = Json::array({{{"name", name}, {"primitives", Json::array({primitive})}}});
  return json;
}

void writeWord(MeshSink& sink, std::uint32_t word) { sink.write(&word, sizeof word); }

/// Header and JSON chunk.
void writeHead(MeshSink& sink, std::string text, std::uint64_t bufferBytes) {
  while (text.size() % 4 != 0) text += ' ';
  const std::uint64_t binary = bufferBytes > 0 ? 8 + bufferBytes : 0;
  const std::uint64_t total = 12 + 8 + text.size() + binary;
  requireAtMost(std::numeric_limits<std::uint32_t>::max(), total, "bytes", ".glb");
  writeWord(sink, kMagic);
  writeWord(sink, 2);
  writeWord(sink, static_cast<std::uint32_t>(total));
  writeWord(sink, static_cast<std::uint32_t>(text.size()));
  writeWord(sink, kJsonChunk);
  sink.write(text.data(), text.size());
}

/// A normal of unit length, which glTF demands; one that cannot be scaled points up.
Floats unitNormal(const Normal& n) {
  const double length = std::hypot(double{n.x}, double{n.y}, double{n.z});
  if (!(length > 0) || !std::isfinite(length)) return {0, 0, 1};
  return {static_cast<float>(n.x / length), static_cast<float>(n.y / length),
          static_cast<float>(n.z / length)};
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

}  // namespace

void writeGlb(const Mesh& mesh, MeshSink& sink, const std::string& name) {
  if (mesh.triangleCount() == 0) {
    writeHead(sink, emptyScene().dump(), 0);
    return;
  }
  const Layout layout = layOut(mesh);
  const Floats middle = needsDoublePrecision(mesh) ? middleOf(boundsOf(mesh)) : Floats{};
  const Json json = describe(mesh, layout, middle, name);
  // A name may hold bytes that are not UTF-8; JSON may not.
  writeHead(sink, json.dump(-1, ' ', false, Json::error_handler_t::replace), layout.bufferBytes());
  writeWord(sink, static_cast<std::uint32_t>(layout.bufferBytes()));
  writeWord(sink, kBinaryChunk);
  forEachItem(sink, mesh.positions, [&](const Position& p) {
    const Floats relative = relativeTo(middle, p);
    sink.write(relative.data(), sizeof relative);
  });
  forEachItem(sink, mesh.normals, [&](const Normal& n) {
    const Floats unit = unitNormal(n);
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
