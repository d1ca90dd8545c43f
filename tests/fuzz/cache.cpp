#include "suite/planning/trials.h"
#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void cache(std::string_view bytes) {
  const auto path = put("speeds.json", bytes);
  documented([&] { const Trials trials(path); });
}

}  // namespace physinv::fuzz
