#include "io/grid/raw_slices.h"

#include <tufa/error.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <string>
#include <system_error>

namespace tufa::io {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& why) {
  throw Error(ErrorCode::UnreadableFile, "cannot read " + file.string() + ": " + why);
}

std::uint64_t bytesOf(RawType type) {
  return type == RawType::U8 ? 1 : type == RawType::F32 ? 4 : 2;
}

/// The size of a file without its header.
std::uint64_t contentOf(const std::filesystem::path& file, std::uint64_t header) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) fail(file, "there is no such file");
  if (!std::filesystem::is_regular_file(status)) fail(file, "it is not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) fail(file, error.message());
  if (size < header) {
    fail(file, "it has " + std::to_string(size) + " bytes, fewer than the header's " +
                   std::to_string(header));
  }
  return size - header;
}

}  // namespace

void requireImageSize(const std::array<std::int64_t, 3>& size) {
  constexpr std::int64_t kMost = 1000000;
  for (const std::int64_t side : size) {
    if (side >= 1 && side <= kMost) continue;
    throw Error(ErrorCode::InvalidArgument, "the image must have 1 to " + std::to_string(kMost) +
                                                " voxels along each axis, not " +
                                                std::to_string(side));
  }
}

RawSlices::RawSlices(const std::vector<std::filesystem::path>& files, const RawImport& options)
    : files_(files), options_(options) {
  requireImageSize(options.size);
  if (files.empty()) throw Error(ErrorCode::InvalidArgument, "there is no file to import");
  std::uint64_t due = bytesOf(options.type);
  for (const std::int64_t side : options.size) due *= static_cast<std::uint64_t>(side);
  std::uint64_t found = 0;
  for (const auto& file : files) found += contentOf(file, options.headerBytes);
  if (found != due) {
    fail(files.front(),
         (files.size() > 1 ? "it and the others have " : "it has ") + std::to_string(found) +
             " bytes of values, but " + std::to_string(options.size[0]) + " x " +
             std::to_string(options.size[1]) + " x " + std::to_string(options.size[2]) + " of " +
             std::to_string(bytesOf(options.type)) + " make " + std::to_string(due));
  }
  rewind();
}

void RawSlices::rewind() { open(0); }

void RawSlices::open(std::size_t file) {
  file_ = file;
  stream_ = std::ifstream(files_[file], std::ios::binary);
  stream_.seekg(static_cast<std::streamoff>(options_.headerBytes));
  if (!stream_) fail(files_[file], "it cannot be opened");
  bytesLeft_ = contentOf(files_[file], options_.headerBytes);
}

void RawSlices::readBytes(char* bytes, std::uint64_t count) {
  while (count > 0) {
    if (bytesLeft_ == 0) {
      if (file_ + 1 == files_.size()) fail(files_[file_], "it became shorter while it was read");
      open(file_ + 1);
      continue;
    }
    const std::uint64_t part = std::min(count, bytesLeft_);
    stream_.read(bytes, static_cast<std::streamsize>(part));
    if (!stream_) fail(files_[file_], "it became shorter while it was read");
    bytes += part;
    count -= part;
    bytesLeft_ -= part;
  }
}

float RawSlices::valueAt(const unsigned char* bytes) const {
  const std::uint64_t width = bytesOf(options_.type);
  std::uint32_t bits = 0;
  for (std::uint64_t n = 0; n < width; ++n) {
    const std::uint64_t shift = 8 * (options_.bigEndian ? width - 1 - n : n);
    bits |= static_cast<std::uint32_t>(bytes[n]) << shift;
  }
  if (options_.type == RawType::F32) return std::bit_cast<float>(bits);
  if (options_.type == RawType::I16) {
    return static_cast<float>(static_cast<std::int16_t>(static_cast<std::uint16_t>(bits)));
  }
  return static_cast<float>(bits);
}

void RawSlices::read(std::vector<float>& values) {
  const std::uint64_t width = bytesOf(options_.type);
  bytes_.resize(values.size() * width);
  readBytes(bytes_.data(), bytes_.size());
  const auto* const bytes = reinterpret_cast<const unsigned char*>(bytes_.data());
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = valueAt(bytes + n * width);
}

}  // namespace tufa::io
