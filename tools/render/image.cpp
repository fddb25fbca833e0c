#include "image.h"

#include <png.h>

#include <tufa/io.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace tufa::render {
namespace {

std::uint8_t toSrgb(float linear) {
  const float c = std::clamp(linear, 0.0F, 1.0F);
  const float s = c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1 / 2.4F) - 0.055F;
  return static_cast<std::uint8_t>(std::lround(255 * s));
}

}  // namespace

Image shrink(const Image& image, int factor) {
  Image small(image.width / factor, image.height / factor, {});
  const float share = 1.0F / static_cast<float>(factor * factor);
  for (int y = 0; y < small.height * factor; ++y) {
    for (int x = 0; x < small.width * factor; ++x) {
      Color& sum = small.pixels[small.index(x / factor, y / factor)];
      for (int i = 0; i < 3; ++i) sum[i] += share * image.pixels[image.index(x, y)][i];
    }
  }
  return small;
}

Image sideBySide(const std::vector<Image>& images, int gap, const Color& fill) {
  int width = -gap, height = 0;
  for (const Image& image : images) {
    width += image.width + gap;
    height = std::max(height, image.height);
  }
  Image all(width, height, fill);
  int left = 0;
  for (const Image& image : images) {
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        all.pixels[all.index(left + x, y)] = image.pixels[image.index(x, y)];
      }
    }
    left += image.width + gap;
  }
  return all;
}

std::string pngOf(const Image& image) {
  std::vector<std::uint8_t> samples;
  samples.reserve(3 * image.pixels.size());
  for (const Color& pixel : image.pixels) {
    for (const float channel : pixel) samples.push_back(toSrgb(channel));
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  // libpng's own bound: PNG can grow over the samples by little.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, samples.data(), 0, nullptr) == 0) {
    throw std::runtime_error(std::string("cannot make a .png: ") + png.message);
  }
  bytes.resize(size);
  return bytes;
}

void writePng(const Image& image, const std::filesystem::path& path) {
  writeFile(pngOf(image), path);
}

}  // namespace tufa::render
