/// Text that has to fit.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace physinv {

/// At most so many characters of UTF-8, a longer text without its middle.
std::string shortened(std::string_view text, std::size_t width);

}  // namespace physinv
