// A directory of journal and plan, divided by a line "--", without arrays.
#include <nlohmann/json.hpp>

#include "suite/store/catalog.h"
#include "suite/store/missing_work.h"
#include "suite/store/results_json.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/sealed.h"

namespace physinv::fuzz {

void store(std::string_view bytes) {
  const auto [lines, asked] = halves(bytes, "\n--\n");
  put("store/journal.jsonl", sealed_lines(std::string(lines) + '\n'));
  put("store/plan.json", sealed_plan(asked));
  documented([&] {
    const Catalog catalog = Catalog::read(folder() / "store");
    const auto context = catalog.plan.value("context", nlohmann::json());
    results_text(results_json(catalog.summaries(), catalog.order(), context));
    to_text(missing_work(catalog, catalog.cases()));
    for (const auto& entry : catalog.entries()) catalog.find(entry.stage.key);
  });
}

}  // namespace physinv::fuzz
