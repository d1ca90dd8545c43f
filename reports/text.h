/// Words and numbers as they are shown; never depends on the locale.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace physinv {

/// Characters of UTF-8 text, which is its width in a terminal for the Latin
/// letters, digits and signs used here.
std::size_t display_width(std::string_view text);

/// Padded to `width` characters; longer text is left alone.
std::string pad_left(std::string_view text, std::size_t width);
std::string pad_right(std::string_view text, std::size_t width);

/// Lines of at most `width` characters, broken at spaces.
std::vector<std::string> wrap(std::string_view text, std::size_t width);

/// Fixed point with `digits` after it; powers of ten where that would read 0
/// or be very long; "–" if not finite.
std::string show_number(double value, int digits);

/// Exponent in superscript digits: -6 -> "⁻⁶".
std::string superscript(int exponent);

}  // namespace physinv
