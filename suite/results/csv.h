/// Cells of CSV (RFC 4180).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace physinv {

/// In quotes where it must be.
std::string csv_text(std::string_view text);
/// Every digit; empty where it is absent or not finite.
std::string csv_number(std::optional<double> value);

}  // namespace physinv
