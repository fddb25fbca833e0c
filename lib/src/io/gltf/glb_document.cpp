#include "io/gltf/glb_document.h"

#include <array>
#include <utility>

#include "io/mesh/file_attributes.h"

namespace tufa::io {

using glb::Json;

// A packed view names a buffer without data, which tells the unpacked size; its bytes come from the
// packed data.
std::size_t GlbDocument::addView(GlbStream& stream, bool vertices) {
  const std::uint64_t plain = stream.stride * stream.count;
  Json view = {{"buffer", packs() ? 1 : 0},
               {"byteOffset", packs() ? plainBytes_ : binaryBytes_},
               {"byteLength", plain}};
  if (vertices) view["byteStride"] = stream.stride;
  view["target"] = vertices ? glb::kArrayBuffer : glb::kElementArrayBuffer;
  if (packs()) {
    view["extensions"]["EXT_meshopt_compression"] = {
        {"buffer", 0},
        {"byteOffset", binaryBytes_},
        {"byteLength", stream.bytes.size()},
        {"byteStride", stream.stride},
        {"count", stream.count},
        {"mode", vertices ? "ATTRIBUTES" : "TRIANGLES"}};
  }
  binaryBytes_ += padded(stream.bytes.size());
  plainBytes_ += padded(plain);
  blobs_.push_back(std::move(stream.bytes));
  return glb::add(json_, "bufferViews", std::move(view));
}

std::size_t GlbDocument::addVertices(GlbStream& stream) {
  Json accessor = {{"bufferView", addView(stream, true)},
                   {"componentType", stream.componentType},
                   {"count", stream.count},
                   {"type", stream.type}};
  if (stream.normalized) accessor["normalized"] = true;
  if (stream.range) {
    accessor["min"] = stream.range->front();
    accessor["max"] = stream.range->back();
  }
  return glb::add(json_, "accessors", std::move(accessor));
}

Json GlbDocument::addVertices(GlbStreams& streams, const std::vector<Attribute>& attributes) {
  Json names = {{"POSITION", addVertices(streams.positions)}};
  if (streams.normals.count > 0) names["NORMAL"] = addVertices(streams.normals);
  Json targets = Json::array();
  const std::vector<std::string> attributeNames = gltfNames(attributes);
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    const std::size_t accessor = addVertices(streams.attributes[i]);
    if (attributes[i].role == AttributeRole::Motion) {
      targets.push_back({{"POSITION", accessor}});
    } else {
      names[attributeNames[i]] = accessor;
    }
  }
  Json vertices = {{"attributes", std::move(names)}};
  if (!targets.empty()) vertices["targets"] = std::move(targets);
  return vertices;
}

Json GlbDocument::addParts(const Json& vertices, GlbStream& indices,
                           std::span<const std::size_t> parts) {
  const std::size_t view = addView(indices, false);
  Json primitives = Json::array();
  std::size_t begin = 0;
  for (const std::size_t count : parts) {
    if (count == 0) continue;
    Json accessor = {{"bufferView", view},
                     {"componentType", indices.componentType},
                     {"count", count},
                     {"type", indices.type}};
    if (begin > 0) accessor["byteOffset"] = begin * indices.stride;
    begin += count;
    Json primitive = vertices;
    primitive["indices"] = glb::add(json_, "accessors", std::move(accessor));
    primitive["mode"] = 4;
    primitives.push_back(std::move(primitive));
  }
  return primitives;
}

std::size_t GlbDocument::addMesh(GlbMesh made, const GlbFrame& frame, const Json& extras) {
  Json mesh = {{"name", made.name}, {"primitives", std::move(made.primitives)}};
  if (!extras.is_null()) mesh["extras"] = extras;
  glb::addMotions(mesh, made.attributes);
  Json node = {{"name", made.name}, {"mesh", glb::add(json_, "meshes", std::move(mesh))}};
  if (frame.translation != std::array<double, 3>{0, 0, 0}) {
    node["translation"] = frame.translation;
  }
  if (frame.nodeScale != 1) node["scale"] = {frame.nodeScale, frame.nodeScale, frame.nodeScale};
  if (!extras.is_null()) node["extras"] = extras;
  return glb::add(json_, "nodes", std::move(node));
}

void GlbDocument::require(const char* extension) {
  json_["extensionsUsed"].push_back(extension);
  json_["extensionsRequired"].push_back(extension);
}

// The bytes before the binary data.
std::string GlbDocument::finish() {
  if (!blobs_.empty()) {
    json_["buffers"] = Json::array({{{"byteLength", binaryBytes_}}});
    if (compression_ != GlbCompression::None) require("KHR_mesh_quantization");
    if (packs()) {
      require("EXT_meshopt_compression");
      json_["buffers"].push_back(
          {{"byteLength", plainBytes_},
           {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
    }
  }
  return glb::head(json_, binaryBytes_);
}

}  // namespace tufa::io
