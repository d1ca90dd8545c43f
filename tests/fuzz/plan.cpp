#include "suite/store/plan.h"

#include <nlohmann/json.hpp>

#include "tests/fuzz/readers.h"
#include "tests/fuzz/sealed.h"

namespace physinv::fuzz {

void plan(std::string_view bytes) {
  const auto path = put("plan.json", sealed_plan(bytes));
  documented([&] {
    std::string warning;
    const auto asked = read_plan(path, &warning);
    for (const auto& name : asked.at("cases"))
      planned_keys(asked, name.get<std::string>(), {});
    auto now = make_plan({}, asked.at("context"), {{"a/case", "its recipe"}});
    for (const char* same : {"profile", "fingerprint"})
      now[same] = asked.at(same);
    plan_text(extend_plan(asked, now));
  });
}

}  // namespace physinv::fuzz
