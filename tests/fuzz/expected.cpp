#include "suite/harness/expected.h"

#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void expected(std::string_view bytes) {
  const auto path = put("expected_failures.json", bytes);
  documented([&] { read_expected(path); });
}

}  // namespace physinv::fuzz
