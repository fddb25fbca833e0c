#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tufa::io::glb {

// What the writers of .glb and its reader share: glTF 2.0 in its binary container.

using Json = nlohmann::ordered_json;
using Floats = std::array<float, 3>;

// Constants of the glTF 2.0 specification.
inline constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
inline constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
inline constexpr std::uint32_t kBinaryChunk = 0x004E4942;
inline constexpr int kByte = 5120;
inline constexpr int kUnsignedByte = 5121;
inline constexpr int kShort = 5122;
inline constexpr int kUnsignedShort = 5123;
inline constexpr int kUnsignedInt = 5125;
inline constexpr int kFloat = 5126;
inline constexpr int kArrayBuffer = 34962;
inline constexpr int kElementArrayBuffer = 34963;

/// Most vertices that 16-bit indices name: 65535 itself restarts primitives.
inline constexpr std::size_t kMostShortVertices = 65535;

/// A document with nothing but its asset and an empty scene. glTF has no empty buffers, accessors
/// or meshes, so that this is the file of an empty mesh.
[[nodiscard]] Json emptyDocument();

/// Adds an element to one of the document's arrays; gives its index.
std::size_t add(Json& document, const char* array, Json element);

/// Adds to a mesh of the document what it says of its morph targets, one for each motion among its
/// attributes: weights of 0, and their names where programs look for them.
void addMotions(Json& mesh, const std::vector<Attribute>& attributes);

/// The bytes of a file up to its binary data, of which there are `binaryBytes`, a multiple of 4.
/// Throws Error(LimitExceeded) if the file would be too large.
[[nodiscard]] std::string head(const Json& document, std::uint64_t binaryBytes);

/// A normal of unit length, which glTF demands; one that cannot be scaled points up.
[[nodiscard]] Floats unitNormal(const Normal& n);

}  // namespace tufa::io::glb
