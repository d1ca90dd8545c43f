#include "suite/core/check.h"

#include <fmt/format.h>

namespace physinv {
namespace {

/// The path of a source file from the root of the sources, wherever they were
/// built.
std::string_view from_root(std::string_view file) {
  constexpr std::string_view kHere = __FILE__, kOwn = "suite/core/check.cpp";
  static_assert(kHere.ends_with(kOwn));
  constexpr std::string_view kRoot =
      kHere.substr(0, kHere.size() - kOwn.size());
  return file.starts_with(kRoot) ? file.substr(kRoot.size()) : file;
}

}  // namespace

void fail_check(const char* file,
                int line,
                const char* condition,
                std::string_view message) {
  throw ContractError(
      fmt::format("{}:{}: {} ({})", from_root(file), line, message, condition));
}

}  // namespace physinv
