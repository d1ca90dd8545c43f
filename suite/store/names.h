/// What names in files may look like, so that they name what they should.
#pragma once

#include <string_view>

namespace physinv {

/// [a-z0-9_-] and `extra`, at least one.
bool is_word(std::string_view text, std::string_view extra = "");

/// Words with single slashes between them.
bool is_path(std::string_view text, std::string_view extra = "");

/// jpo/billiards/jpo/n=64/seed=3: a path that fits into the name of a file.
bool is_case_name(std::string_view text);

/// A content key: 32 hexadecimal digits.
bool is_key(std::string_view text);

}  // namespace physinv
