#include "ends.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "suite/evidence/guests.h"
#include "suite/evidence/method_table.h"
#include "suite/harness/registry.h"

namespace libraries {
namespace {

using physinv::Batch;
using physinv::Evidence;
using physinv::Index;
using physinv::Run;
using physinv::Select;

/// How many problems of a run; empty where that is not recorded.
using Count = std::function<std::optional<Index>(const Run&)>;

const Batch<double>* array(const Run& run, const char* name) {
  const auto& arrays = run.stage->arrays;
  const auto at = arrays.find(physinv::ArrayKey::own(name));
  return at == arrays.end() ? nullptr : &at->second;
}

Count flagged(const char* name) {
  return [=](const Run& run) -> std::optional<Index> {
    const auto* flags = array(run, name);
    if (flags == nullptr) return {};
    return (flags->array() > 0).count();
  };
}

/// The suite's own claim it by their status.
std::optional<Index> claims(const Run& run) {
  if (const auto own = flagged("claims_success")(run)) return own;
  return std::ranges::count_if(run.stage->status, physinv::converged);
}

Count claims_above(double gtol) {
  return [=](const Run& run) -> std::optional<Index> {
    const auto* claimed = array(run, "claims_success");
    const auto* left = array(run, "gradient_left");
    if (claimed == nullptr || left == nullptr) return {};
    return (claimed->array() > 0 && !(left->array() <= gtol)).count();
  };
}

std::optional<Index> problems(const Run& run) { return run.stage->loss.size(); }

physinv::MethodColumn column(std::string head, Count count) {
  return {std::move(head),
          [count = std::move(count)](const Evidence& e, const Select& select) {
            std::optional<double> sum;
            for (const Run& run : physinv::find_runs(e, select))
              if (const auto of_run = count(run))
                sum = sum.value_or(0) + static_cast<double>(*of_run);
            return physinv::written(sum, "{:.0f}", physinv::kNothing);
          }};
}

}  // namespace

physinv::Table ends_table(const Evidence& evidence) {
  const auto experiment = physinv::registry().find(evidence.experiment);
  const double gtol = experiment->setting.gtol;
  std::vector<physinv::MethodLine> lines;
  for (const auto& method : experiment->methods)
    lines.push_back({.method = method.id, .label = method.id});
  for (const auto& id : physinv::guests(evidence))
    lines.push_back({.method = id, .label = id});
  return physinv::table_by_method(
      {.id = "ends",
       .title = "How the solvers of each library end, in problems",
       .corner = "method",
       .note = fmt::format(
           "Over all n and seeds. Gradient left: a success is claimed where an "
           "entry of the gradient is above {:g}, the experiment's gtol. Not "
           "best: a lower loss was evaluated than that of the point returned. "
           "False loss: the loss named is not that of the point. Budget spent: "
           "the budget of evaluations was spent. Outside box: a point outside "
           "of the bounds was evaluated; empty without bounds.",
           gtol)},
      evidence,
      lines,
      {column("problems", problems),
       column("claims success", claims),
       column("gradient left", claims_above(gtol)),
       column("not best", flagged("returned_not_best")),
       column("false loss", flagged("false_loss")),
       column("budget spent", flagged("budget_spent")),
       column("outside box", flagged("outside_box"))});
}

}  // namespace libraries
