#include "suite/app/load.h"

#include <fmt/format.h>

#include "suite/app/options.h"

namespace physinv {

Loaded load(const std::string& directory) {
  Loaded loaded{.catalog = Catalog::read(results_directory(directory))};
  for (const auto& warning : loaded.catalog.warnings())
    fmt::print("warning: {}\n", warning);
  auto cases = loaded.catalog.cases();
  loaded.lacks = shortfall(loaded.catalog, cases);
  loaded.results = Results(std::move(cases));
  return loaded;
}

void require_complete(const Shortfall& lacks, std::string_view advice) {
  if (lacks.any())
    throw ExitError(ExitCode::incomplete,
                    fmt::format("incomplete: {}; {}", to_text(lacks), advice));
}

}  // namespace physinv
