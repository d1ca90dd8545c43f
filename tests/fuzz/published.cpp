#include "suite/results/published.h"

#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void published(std::string_view bytes) {
  const auto path = put("published/paper.json", bytes);
  documented([&] {
    const Published all(path.parent_path());
    for (const Publication& p : all.publications()) p.text();
    all.find("jpo/billiards", "table4/jpo/better");
  });
}

}  // namespace physinv::fuzz
