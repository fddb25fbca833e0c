#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "io/mesh/mesh_format.h"

namespace tufa::io {

/// A piece of text while it is built, of 256 bytes at most. Numbers are the shortest that read back
/// to the same value.
class Line {
 public:
  explicit Line(MeshSink& sink) : sink_(sink) {}

  Line& text(std::string_view part) {
    end_ = std::copy(part.begin(), part.end(), end_);
    return *this;
  }
  template <class Number>
  Line& number(Number value) {
    end_ = std::to_chars(end_, buffer_.data() + buffer_.size(), value).ptr;
    return *this;
  }
  /// Writes it, and begins anew.
  void flush() {
    sink_.write(buffer_.data(), static_cast<std::size_t>(end_ - buffer_.data()));
    end_ = buffer_.data();
  }
  /// Writes it with the end of a line.
  void finish() {
    text("\n");
    flush();
  }

 private:
  MeshSink& sink_;
  std::array<char, 256> buffer_;  // the longest piece has seven numbers of at most 24 characters
  char* end_ = buffer_.data();
};

}  // namespace tufa::io
