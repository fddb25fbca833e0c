#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace tufa::render {

/// Linear red, green and blue, 0 to 1.
using Color = std::array<float, 3>;

/// A picture, row by row from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Color> pixels;

  Image() = default;
  Image(int w, int h, const Color& fill)
      : width(w),
        height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// The mean of each square of `factor` times `factor` pixels.
[[nodiscard]] Image shrink(const Image& image, int factor);

/// Pictures of one height beside each other.
[[nodiscard]] Image sideBySide(const std::vector<Image>& images, int gap, const Color& fill);

/// The bytes of an 8-bit sRGB .png. Throws std::runtime_error.
[[nodiscard]] std::string pngOf(const Image& image);

/// Writes that. Throws std::runtime_error, of which Error is one.
void writePng(const Image& image, const std::filesystem::path& path);

}  // namespace tufa::render
