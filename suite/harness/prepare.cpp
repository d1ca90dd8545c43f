#include "suite/harness/prepare.h"

#include <exception>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "suite/core/clock.h"
#include "suite/core/disturbance.h"
#include "suite/harness/keys.h"
#include "suite/harness/run_case.h"

namespace physinv {

Prepared prepare(std::vector<Case> cases, bool disturb) {
  Prepared p;
  p.cases = std::move(cases);
  std::map<
      std::tuple<std::string, Index, std::uint64_t, std::optional<Precision>>,
      CaseData>
      drawn;
  const Numerics numerics = remembered_numerics();
  for (Case& c : p.cases) {
    std::string error;
    CaseData data;
    const auto& info = c.info;
    const auto ulp =
        disturb ? std::optional(working_precision(c)) : std::nullopt;
    const auto id = std::tuple(info.experiment, info.n, info.seed, ulp);
    disturb_data(ulp);
    const double begin = now().cpu;
    try {
      auto at = drawn.find(id);
      if (at == drawn.end()) at = drawn.emplace(id, draw_data(c)).first;
      data = at->second;
    } catch (const std::exception& e) {
      error = e.what();
    }
    p.data_cpu += now().cpu - begin;
    c.info.keys = content_keys(c, data.hash, numerics);
    p.data.push_back(std::move(data));
    p.errors.push_back(std::move(error));
  }
  disturb_data({});
  return p;
}

}  // namespace physinv
