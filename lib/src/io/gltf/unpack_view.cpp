#include "io/gltf/unpack_view.h"

#include <meshoptimizer.h>

#include <nlohmann/json.hpp>

#include "io/json_input.h"

namespace tufa::io {
namespace {

// A packed byte stands for at most this many, up to a block: a group of 16 numbers takes 2 bits at
// least, and a triangle one byte.
constexpr std::size_t kMostRatio = 64;
constexpr std::size_t kSlack = 65536;

}  // namespace

std::string unpackView(const nlohmann::json& description, std::string_view packed,
                       const InputBytes& input) {
  const std::size_t count = countIn(description.at("count"), input);
  const std::size_t stride = countIn(description.at("byteStride"), input);
  const auto mode = description.at("mode").get<std::string>();
  if (description.value("filter", "NONE") != "NONE") {
    input.fail("a buffer view is packed with a filter, not supported");
  }
  const bool vertices = mode == "ATTRIBUTES";
  const bool strideFits =
      vertices ? stride > 0 && stride <= 256 && stride % 4 == 0 : stride == 2 || stride == 4;
  if (!strideFits || (mode == "TRIANGLES" && count % 3 != 0) ||
      count > (packed.size() * kMostRatio + kSlack) / stride) {
    input.fail("the size of a packed buffer view is not possible: damaged");
  }
  std::string bytes(count * stride, '\0');
  const auto* const data = reinterpret_cast<const unsigned char*>(packed.data());
  int failed = 1;
  if (vertices) {
    failed = meshopt_decodeVertexBuffer(bytes.data(), count, stride, data, packed.size());
  } else if (mode == "TRIANGLES") {
    failed = meshopt_decodeIndexBuffer(bytes.data(), count, stride, data, packed.size());
  } else if (mode == "INDICES") {
    failed = meshopt_decodeIndexSequence(bytes.data(), count, stride, data, packed.size());
  }
  if (failed != 0) input.fail("a packed buffer view cannot be unpacked: damaged");
  return bytes;
}

}  // namespace tufa::io
