#include "suite/app/export.h"
#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void results(std::string_view bytes) {
  const auto path = put("results/results.json", bytes);
  for (const char* format : {"json", "csv", "github", "bencher"})
    documented([&] { exported(path.parent_path().string(), format); });
}

}  // namespace physinv::fuzz
