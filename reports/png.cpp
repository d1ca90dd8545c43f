#include "reports/png.h"

#include <fmt/format.h>
#include <png.h>

#include <stdexcept>

namespace physinv {
namespace {

/// libpng's state of one picture.
class Image {
 public:
  Image() { image_.version = PNG_IMAGE_VERSION; }
  ~Image() { png_image_free(&image_); }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;
  png_image* operator->() { return &image_; }

  /// Size of the file, which goes to `memory` unless that is null.
  std::size_t write(const Raster& raster,
                    const std::vector<std::uint8_t>& colors,
                    std::size_t size,
                    void* memory) {
    png_alloc_size_t bytes = size;
    if (png_image_write_to_memory(&image_,
                                  memory,
                                  &bytes,
                                  0,
                                  raster.pixels.data(),
                                  0,
                                  colors.data()) == 0)
      throw std::runtime_error(fmt::format("PNG: {}", image_.message));
    return bytes;
  }

 private:
  png_image image_ = {};
};

/// Red, green, blue, opacity of each number.
std::vector<std::uint8_t> entries(std::span<const std::string> palette) {
  std::vector<std::uint8_t> colors(4, 0);
  for (const std::string& color : palette) {
    const auto rgb = std::stoul(color.substr(1), nullptr, 16);
    for (const unsigned shift : {16U, 8U, 0U})
      colors.push_back(static_cast<std::uint8_t>(rgb >> shift));
    colors.push_back(255);
  }
  return colors;
}

}  // namespace

std::string png_of(const Raster& raster, std::span<const std::string> palette) {
  const auto colors = entries(palette);
  Image image;
  image->width = static_cast<png_uint_32>(raster.width);
  image->height = static_cast<png_uint_32>(raster.height);
  image->format = PNG_FORMAT_RGBA_COLORMAP;
  image->colormap_entries = static_cast<png_uint_32>(colors.size() / 4);
  std::string bytes(image.write(raster, colors, 0, nullptr), '\0');
  bytes.resize(image.write(raster, colors, bytes.size(), bytes.data()));
  return bytes;
}

std::string data_url(const std::string& bytes, std::string_view kind) {
  constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string url = "data:" + std::string(kind) + ";base64,";
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits =
          bits << 8U |
          (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      url += i + k <= bytes.size() ? kDigits[bits >> (18 - 6 * k) & 63U] : '=';
  }
  return url;
}

}  // namespace physinv
