#include "io/gltf/glb.h"

#include <cmath>
#include <limits>

#include "base/require_at_most.h"

namespace tufa::io::glb {
namespace {

void appendWord(std::string& bytes, std::uint64_t word) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes += static_cast<char>(static_cast<unsigned char>(word >> shift));
  }
}

}  // namespace

Json emptyDocument() {
  return {{"asset", {{"version", "2.0"}, {"generator", "tufa"}}},
          {"scene", 0},
          {"scenes", Json::array({Json::object()})}};
}

std::size_t add(Json& document, const char* array, Json element) {
  Json& elements = document[array];
  elements.push_back(std::move(element));
  return elements.size() - 1;
}

void addMotions(Json& mesh, const std::vector<Attribute>& attributes) {
  for (const Attribute& attribute : attributes) {
    if (attribute.role != AttributeRole::Motion) continue;
    mesh["weights"].push_back(0);
    mesh["extras"]["targetNames"].push_back(attribute.name);
  }
}

std::string head(const Json& document, std::uint64_t binaryBytes) {
  // A name may hold bytes that are not UTF-8; JSON may not.
  std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  while (text.size() % 4 != 0) text += ' ';
  const std::uint64_t total = 12 + 8 + text.size() + (binaryBytes > 0 ? 8 + binaryBytes : 0);
  base::requireAtMost(std::numeric_limits<std::uint32_t>::max(), total, "bytes", ".glb");
  std::string bytes;
  for (const std::uint64_t word : {std::uint64_t{kMagic}, std::uint64_t{2}, total,
                                   std::uint64_t{text.size()}, std::uint64_t{kJsonChunk}}) {
    appendWord(bytes, word);
  }
  bytes += text;
  if (binaryBytes == 0) return bytes;
  appendWord(bytes, binaryBytes);
  appendWord(bytes, kBinaryChunk);
  return bytes;
}

Floats unitNormal(const Normal& n) {
  const double length = std::hypot(double{n.x}, double{n.y}, double{n.z});
  if (!(length > 0) || !std::isfinite(length)) return {0, 0, 1};
  return {static_cast<float>(n.x / length), static_cast<float>(n.y / length),
          static_cast<float>(n.z / length)};
}

}  // namespace tufa::io::glb
