#include "suite/app/load.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "suite/app/options.h"
#include "suite/store/results_file.h"
#include "suite/store/results_json.h"

namespace physinv {

Loaded load(const std::string& directory, std::FILE* warnings) {
  Loaded loaded{.catalog = Catalog::read(results_directory(directory))};
  auto cases = checked_cases(loaded.catalog);
  loaded.lacks = missing_work(loaded.catalog, cases);
  // What is missing is printed at the end, in the one line of an error.
  if (warnings == stdout || !loaded.lacks.any())
    for (const auto& warning : loaded.catalog.warnings())
      fmt::print(warnings, "warning: {}\n", warning);
  loaded.results = Results(std::move(cases));
  return loaded;
}

nlohmann::ordered_json results_of(const Loaded& loaded) {
  const auto& plan = loaded.catalog.plan;
  const auto none = nlohmann::json::object();
  return results_json(loaded.results.cases(),
                      loaded.catalog.order(),
                      plan.is_object() ? plan.value("context", none) : none);
}

void require_complete(const MissingWork& lacks, std::string_view advice) {
  if (lacks.any())
    throw ExitError(ExitCode::incomplete,
                    fmt::format("incomplete: {}; {}", to_text(lacks), advice));
}

}  // namespace physinv
