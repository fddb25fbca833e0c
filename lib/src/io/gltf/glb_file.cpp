#include "io/gltf/glb_file.h"

#include <tufa/error.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "io/gltf/glb.h"
#include "io/gltf/unpack_view.h"
#include "io/json_input.h"

namespace tufa::io::glb {
namespace {

template <class Number>
Vec3 readPoint(const char* data) {
  std::array<Number, 3> p;
  std::memcpy(p.data(), data, sizeof p);
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

}  // namespace

File::File(const InputBytes& input) : input_(input) {
  if (input_.size() < 12 || word(0) != kMagic) input_.fail("it is not a .glb file");
  if (word(4) != 2) input_.fail("it is glTF version " + std::to_string(word(4)) + ", not 2");
  if (word(8) > input_.size()) {
    input_.fail("it should have " + std::to_string(word(8)) + " bytes but has " +
                std::to_string(input_.size()) + ": truncated");
  }
  for (std::size_t at = 12; at + 8 <= word(8);) {
    const std::size_t length = word(at);
    const std::uint32_t type = word(at + 4);
    if (length > word(8) - at - 8) input_.failAtByte(at, "a chunk is longer than the file");
    const std::string_view chunk = input_.view().substr(at + 8, length);
    if (type == kJsonChunk && document_.is_null()) {
      document_ = parseJson<nlohmann::json>(chunk, input_);
    }
    if (type == kBinaryChunk && binary_.data() == nullptr) binary_ = chunk;
    at += 8 + length;
  }
  if (!document_.is_object()) input_.fail("it has no JSON chunk");
}

void File::takeMemory(std::size_t count, std::size_t elementBytes) {
  constexpr std::uint64_t kMostRatio = 100;
  constexpr std::uint64_t kAlways = std::uint64_t{64} << 20;
  const std::uint64_t most = std::max(kAlways, kMostRatio * input_.size());
  // Not their product, which may overflow.
  if (count <= (most - takenBytes_) / elementBytes) {
    takenBytes_ += count * elementBytes;
    return;
  }
  throw Error(ErrorCode::LimitExceeded,
              "cannot read " + input_.name() + ": its meshes take more than " +
                  std::to_string(most) + " bytes, " + std::to_string(kMostRatio) +
                  " times as many as the file has: too many nodes or parts share them");
}

std::uint32_t File::word(std::size_t offset) const {
  if (offset + 4 > input_.size()) input_.failAtByte(offset, "the file ends too early: truncated");
  std::uint32_t value = 0;
  std::memcpy(&value, input_.view().data() + offset, sizeof value);
  return value;
}

Vec3 File::pointAt(const View& view, std::size_t n) const {
  const char* const data = view.data + n * view.stride;
  const auto scaled = [&](const Vec3& p, double most) {
    if (!view.normalized) return p;
    return Vec3(std::max(-1.0, p[0] / most), std::max(-1.0, p[1] / most),
                std::max(-1.0, p[2] / most));
  };
  switch (view.componentType) {
    case kFloat:
      return readPoint<float>(data);
    case kByte:
      return scaled(readPoint<std::int8_t>(data), 127);
    case kUnsignedByte:
      return scaled(readPoint<std::uint8_t>(data), 255);
    case kShort:
      return scaled(readPoint<std::int16_t>(data), 32767);
    case kUnsignedShort:
      return scaled(readPoint<std::uint16_t>(data), 65535);
    default:
      input_.fail("its positions are of component type " + std::to_string(view.componentType) +
                  ", not supported");
  }
}

std::vector<std::uint32_t> File::indicesOf(const nlohmann::json& accessorIndex,
                                           std::size_t positionCount) {
  const View view = viewOf(accessorIndex, "SCALAR", 1);
  const bool isUnsigned = view.componentType == kUnsignedByte ||
                          view.componentType == kUnsignedShort ||
                          view.componentType == kUnsignedInt;
  if (!isUnsigned) {
    input_.fail("its indices are of component type " + std::to_string(view.componentType) +
                ", and must be unsigned integers");
  }
  takeMemory(view.count, sizeof(std::uint32_t));
  std::vector<std::uint32_t> indices;
  indices.reserve(view.count);
  for (std::size_t n = 0; n < view.count; ++n) {
    std::uint32_t index = 0;  // little-endian: a shorter number fills the lower bytes
    std::memcpy(&index, view.data + n * view.stride, sizeOf(view.componentType));
    if (index >= positionCount) {
      input_.fail("index " + std::to_string(n) + " names vertex " + std::to_string(index) + " of " +
                  std::to_string(positionCount));
    }
    indices.push_back(index);
  }
  return indices;
}

std::size_t File::sizeOf(std::size_t componentType) const {
  switch (componentType) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      input_.fail("component type " + std::to_string(componentType) + " is not supported");
  }
}

/// The bytes of a buffer view: a part of the binary chunk, or unpacked from one.
std::string_view File::bytesOf(std::size_t index) {
  const nlohmann::json& view = document_.at("bufferViews").at(index);
  const char* const name = "EXT_meshopt_compression";
  if (!view.contains("extensions") || !view["extensions"].contains(name)) return partOfBinary(view);
  const nlohmann::json& packed = view["extensions"][name];
  const auto [found, isNew] = unpacked_.try_emplace(index);
  if (isNew) {
    found->second = unpackView(packed, partOfBinary(packed), input_);
    takeMemory(found->second.size(), 1);
  }
  return found->second;
}

std::string_view File::partOfBinary(const nlohmann::json& range) const {
  if (range.at("buffer") != 0 || document_.at("buffers").at(0).contains("uri")) {
    input_.fail("its data lies outside the file, not supported");
  }
  const std::size_t start = countAt(range, "byteOffset", 0, input_);
  const std::size_t length = countIn(range.at("byteLength"), input_);
  if (start > binary_.size() || length > binary_.size() - start) failOutside();
  return binary_.substr(start, length);
}

void File::failOutside() const {
  input_.fail("an accessor reaches beyond the binary chunk: damaged");
}

View File::viewOf(const nlohmann::json& accessorIndex, const std::string& type,
                  std::size_t components) {
  const nlohmann::json& accessor = document_.at("accessors").at(countIn(accessorIndex, input_));
  if (accessor.contains("sparse")) input_.fail("sparse accessors are not supported");
  if (accessor.at("type") != type) input_.fail("an accessor is not of type " + type);
  const std::size_t viewIndex = countIn(accessor.at("bufferView"), input_);
  const std::string_view bytes = bytesOf(viewIndex);
  const nlohmann::json& bufferView = document_.at("bufferViews").at(viewIndex);
  View view;
  view.componentType = countIn(accessor.at("componentType"), input_);
  view.count = countIn(accessor.at("count"), input_);
  const std::size_t element = components * sizeOf(view.componentType);
  view.stride = countAt(bufferView, "byteStride", element, input_);
  view.normalized = accessor.value("normalized", false);
  const std::size_t offset = countAt(accessor, "byteOffset", 0, input_);
  const bool inside =
      view.stride >= element && offset <= bytes.size() &&
      (view.count == 0 || (element <= bytes.size() - offset &&
                           view.count - 1 <= (bytes.size() - offset - element) / view.stride));
  if (!inside) failOutside();
  view.data = bytes.data() + offset;
  return view;
}

}  // namespace tufa::io::glb
