/// The one source that takes a parser of TOML.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "suite/app/campaign_file.h"

namespace physinv {

inline constexpr std::string_view kNoValue =
    "is neither text, number, yes or no, nor a list of them";

/// Flags of a document in UTF-8; `path` is for errors. UsageError with the line
/// if it is no TOML 1.0 or holds a table, a date or a list in a list.
std::vector<FileFlag> flags_of_toml(const std::string& path,
                                    std::string_view text);

}  // namespace physinv
