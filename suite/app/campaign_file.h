/// Flags from the file of --config.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace physinv {

/// A flag without its dashes.
struct FileFlag {
  std::string name;
  std::vector<std::string> values;
  std::string where;  ///< "campaign.toml:3", from 1
};

/// In the order of the file: JSON if its name ends with .json or its first
/// character is a brace, else TOML 1.0. Numbers, booleans and lists are as the
/// command line has them. UsageError with file and line if the file does not
/// parse, a name is repeated, or a value is empty or no text, number, boolean
/// or list of them.
std::vector<FileFlag> read_campaign_file(const std::string& path);

/// What such a file may hold at most, in bytes.
inline constexpr std::size_t kLongestFile = 1 << 16;

}  // namespace physinv
