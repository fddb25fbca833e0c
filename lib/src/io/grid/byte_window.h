#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <istream>
#include <stdexcept>
#include <string>
#include <vector>

namespace tufa::io {

/// What a file says cannot be so. The text says what, as "it claims ..."; who catches it knows the
/// file and the grid.
class DamagedGrid : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Goes over the bytes of a stream once, forwards. Bytes that are skipped far enough are not read:
/// seeking the stream itself would empty its buffer each time. Throws std::ios_base::failure behind
/// the end. The stream is left anywhere.
class ByteWindow {
 public:
  /// Begins where the stream stands; `end` is the place behind the last byte.
  ByteWindow(std::istream& stream, std::uint64_t end)
      : stream_(stream), end_(end), place_(static_cast<std::uint64_t>(stream.tellg())) {}

  [[nodiscard]] std::uint64_t place() const { return place_; }
  [[nodiscard]] std::uint64_t left() const { return end_ - std::min(end_, place_); }

  void skip(std::uint64_t count) {
    require(count);
    place_ += count;
  }

  void take(void* to, std::size_t count) {
    look(to, count);
    place_ += count;
  }

  template <class T>
  [[nodiscard]] T take() {
    T value;
    take(&value, sizeof value);
    return value;
  }

  /// The next bytes, which stay the next.
  void look(void* to, std::size_t count) {
    require(count);
    if (place_ < start_ || place_ + count > start_ + bytes_.size()) fill(count);
    std::memcpy(to, bytes_.data() + (place_ - start_), count);
  }

 private:
  void require(std::uint64_t count) const {
    if (count > left()) throw std::ios_base::failure("the file ends");
  }

  void fill(std::size_t count) {
    constexpr std::size_t kBytes = std::size_t{1} << 16;
    const std::uint64_t size = std::min<std::uint64_t>(left(), std::max(count, kBytes));
    bytes_.resize(size);
    start_ = place_;
    stream_.seekg(static_cast<std::streamoff>(start_));
    stream_.read(bytes_.data(), static_cast<std::streamsize>(size));
  }

  std::istream& stream_;
  std::uint64_t end_;
  std::uint64_t place_;
  std::uint64_t start_ = 0;  ///< place of bytes_ in the file
  std::vector<char> bytes_;
};

}  // namespace tufa::io
