#include "suite/core/check.h"

#include <fmt/format.h>

namespace physinv {

void fail_check(const char* file,
                int line,
                const char* condition,
                std::string_view message) {
  throw ContractError(
      fmt::format("{}:{}: {} ({})", file, line, message, condition));
}

}  // namespace physinv
