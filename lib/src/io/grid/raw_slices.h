#pragma once

#include <tufa/import.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

namespace tufa::io {

/// Throws Error(InvalidArgument) unless an image may have so many voxels along its axes.
void requireImageSize(const std::array<std::int64_t, 3>& size);

/// The values of a raw stack, slice by slice from the first.
class RawSlices {
 public:
  /// Throws Error: InvalidArgument (the size), UnreadableFile unless the files hold just the values
  /// of the image.
  RawSlices(const std::vector<std::filesystem::path>& files, const RawImport& options);

  /// The next slices, as many as the vector has room for.
  void read(std::vector<float>& values);

  /// From the first slice again.
  void rewind();

 private:
  void open(std::size_t file);
  void readBytes(char* bytes, std::uint64_t count);
  [[nodiscard]] float valueAt(const unsigned char* bytes) const;

  std::vector<std::filesystem::path> files_;
  RawImport options_;
  std::vector<char> bytes_;
  std::ifstream stream_;
  std::size_t file_ = 0;         ///< the one that is open
  std::uint64_t bytesLeft_ = 0;  ///< in it
};

}  // namespace tufa::io
