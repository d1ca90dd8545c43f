/// Small pictures as PNG files.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace physinv {

/// Colours by number, row by row from the top; 0 is transparent, k the k-th of
/// the palette.
struct Raster {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

/// The file's bytes, by libpng. `palette`: at most 255 colours "#rrggbb".
/// Throws std::runtime_error with libpng's words.
std::string png_of(const Raster& raster, std::span<const std::string> palette);

/// As a URL that holds the bytes themselves; of a picture of this kind.
std::string data_url(const std::string& bytes,
                     std::string_view kind = "image/png");

}  // namespace physinv
