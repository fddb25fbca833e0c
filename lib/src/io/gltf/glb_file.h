#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec3.h"
#include "io/input_bytes.h"

namespace tufa::io::glb {

/// Elements of the binary chunk, `stride` bytes apart.
struct View {
  const char* data = nullptr;
  std::size_t count = 0;
  std::size_t stride = 0;
  std::size_t componentType = 0;
  bool normalized = false;  ///< integers stand for -1 to 1 or 0 to 1
};

/// A .glb as it is read: its document, and the elements of its accessors. All members throw
/// Error(UnreadableFile), or what nlohmann::json throws where something is missing.
class File {
 public:
  explicit File(const InputBytes& input);

  [[nodiscard]] const nlohmann::json& document() const { return document_; }

  /// To be called before memory is taken for what the file says. A few bytes can name one accessor
  /// many times, or unpack to many: throws Error(LimitExceeded) where all that was taken is more
  /// than 100 times the size of the file, and more than 64 MB.
  void takeMemory(std::size_t count, std::size_t elementBytes);

  /// The elements of an accessor, all of them inside its buffer view.
  [[nodiscard]] View viewOf(const nlohmann::json& accessorIndex, const std::string& type,
                            std::size_t components);

  /// Element n of a view of points: floats, or integers as KHR_mesh_quantization allows them.
  [[nodiscard]] Vec3 pointAt(const View& view, std::size_t n) const;

  /// The numbers of an accessor of indices, all below `positionCount`.
  [[nodiscard]] std::vector<std::uint32_t> indicesOf(const nlohmann::json& accessorIndex,
                                                     std::size_t positionCount);

 private:
  [[nodiscard]] std::uint32_t word(std::size_t offset) const;
  [[nodiscard]] std::size_t sizeOf(std::size_t componentType) const;
  [[nodiscard]] std::string_view bytesOf(std::size_t view);
  [[nodiscard]] std::string_view partOfBinary(const nlohmann::json& range) const;
  [[noreturn]] void failOutside() const;

  const InputBytes& input_;
  nlohmann::json document_;
  std::string_view binary_;
  std::uint64_t takenBytes_ = 0;
  std::map<std::size_t, std::string> unpacked_;  ///< packed buffer views
};

}  // namespace tufa::io::glb
