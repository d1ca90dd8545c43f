#include "suite/gate/baseline.h"

#include "suite/harness/select.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/sealed.h"

namespace physinv::fuzz {

void baseline(std::string_view bytes) {
  documented([&] {
    const Baseline read = parse_baseline(sealed_end(bytes), "baseline.txt");
    const NameFilter filter(read.chosen.filters);
    for (const StageLine& line : read.stages) filter.matches(line.name);
    // What is read can be written, and is the same once more.
    const std::string text = to_text(read);
    if (to_text(parse_baseline(text, "baseline.txt")) != text)
      throw std::logic_error("a baseline does not come back");
  });
}

}  // namespace physinv::fuzz
