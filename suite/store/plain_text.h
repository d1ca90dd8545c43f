/// Text that people write with any editor.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "suite/store/file.h"

namespace physinv {

/// The file without the mark that some editors put before UTF-8 (EF BB BF).
/// Errors as of `read_file`.
std::string read_plain_text(const std::filesystem::path& path,
                            std::uint64_t limit = kLargestText);

}  // namespace physinv
