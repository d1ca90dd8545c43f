#include "reports/results_page.h"
#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void digest(std::string_view bytes) {
  auto json = nlohmann::ordered_json::parse(bytes, nullptr, false);
  if (json.is_discarded()) return;
  try {
    results_markdown({{"campaign", json}, {"campaign again", json}});
    experiment_pages({{"campaign", json}, {"campaign again", json}});
  } catch (const std::runtime_error&) {  // the header says so
  }
}

}  // namespace physinv::fuzz
