#include "suite/store/plain_text.h"

#include <string_view>

namespace physinv {

std::string read_plain_text(const std::filesystem::path& path,
                            std::uint64_t limit) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  std::string text = read_file(path, limit);
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

}  // namespace physinv
