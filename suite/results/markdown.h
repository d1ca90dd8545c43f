/// Text as Markdown that shows it as it is: names from files and command lines
/// are words of a table, never its structure.
#pragma once

#include <string>
#include <string_view>

namespace physinv {

/// In a paragraph, a heading or a cell. Ends of lines become spaces.
std::string markdown(std::string_view text);

/// As code, with its backticks; not in a cell.
std::string markdown_code(std::string_view text);

}  // namespace physinv
