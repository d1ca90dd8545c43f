/// SUITE_CHECK(condition, message): a broken contract throws, also in release.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string_view>

namespace physinv {

/// A caller broke a documented contract: a bug, not a numerical outcome.
class ContractError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] void fail_check(const char* file,
                             int line,
                             const char* condition,
                             std::string_view message);

}  // namespace physinv

#define SUITE_CHECK(condition, message)                                 \
  do {                                                                  \
    if (!(condition)) [[unlikely]]                                      \
      ::physinv::fail_check(__FILE__, __LINE__, #condition, (message)); \
  } while (false)

namespace physinv {

/// A batch has so many rows and columns.
template <class M>
void check_size(const M& batch, std::ptrdiff_t rows, std::ptrdiff_t cols) {
  SUITE_CHECK(batch.rows() == rows && batch.cols() == cols,
              "batch has the wrong size");
}

}  // namespace physinv
