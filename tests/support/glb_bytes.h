#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace tufa::test {

/// The bytes of a number, as they are in memory.
template <class Number>
std::string bytesOf(Number value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

/// A .glb of a document and a binary chunk, whatever they hold.
inline std::string glbOf(const std::string& json, const std::string& binary = "") {
  std::string text = json;
  while (text.size() % 4 != 0) text += ' ';
  std::string bytes = "glTF" + bytesOf(std::uint32_t{2});
  bytes += bytesOf(static_cast<std::uint32_t>(28 + text.size() + binary.size()));
  bytes += bytesOf(static_cast<std::uint32_t>(text.size())) + "JSON" + text;
  bytes += bytesOf(static_cast<std::uint32_t>(binary.size()));
  return bytes + std::string("BIN\0", 4) + binary;
}

/// What a .glb of one triangle in the xy plane says, in JSON.
struct GlbTriangle {
  std::string scene = "0";
  std::string nodes = R"([{"mesh":0}])";
  std::string primitives = R"([{"attributes":{"POSITION":0},"indices":1}])";
  std::string vertexCount = "3";
  std::string indexCount = "3";
  std::string indexType = "5121";
  std::string more = "";  ///< further keys of the document, each with a comma before it
};

/// A .glb of one triangle.
inline std::string glbTriangle(const GlbTriangle& says) {
  std::string binary;
  for (const float x : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) binary += bytesOf(x);
  binary += std::string("\0\1\2\0", 4);
  return glbOf(R"({"asset":{"version":"2.0"},"scene":)" + says.scene +
                   R"(,"scenes":[{"nodes":[0]}],"nodes":)" + says.nodes +
                   R"(,"meshes":[{"primitives":)" + says.primitives + R"(}],
              "buffers":[{"byteLength":40}],
              "bufferViews":[{"buffer":0,"byteLength":36},
                             {"buffer":0,"byteOffset":36,"byteLength":4}],
              "accessors":[{"bufferView":0,"componentType":5126,"count":)" +
                   says.vertexCount + R"(,"type":"VEC3"},
                           {"bufferView":1,"componentType":)" +
                   says.indexType + R"(,"count":)" + says.indexCount + R"(,"type":"SCALAR"}])" +
                   says.more + "}",
               binary);
}

}  // namespace tufa::test
