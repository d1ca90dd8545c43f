#include "suite/harness/keys.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <utility>

#include "suite/core/disturbance.h"
#include "suite/core/float_environment.h"
#include "suite/core/hash.h"
#include "suite/harness/sources.h"
#include "suite/harness/study.h"

namespace physinv {
namespace {

void append(std::string& text, const Options& options) {
  for (const auto& [name, value] : options)
    text += fmt::format("  {}={}\n", name, value);
}

void append(std::string& text, std::string_view name, const NetworkRole& role) {
  text += fmt::format("{}=", name);
  for (const Field f : role.inputs)
    text += fmt::format("{},", static_cast<int>(f));
  text += role.recipe.description + '\n';
}

}  // namespace

CaseData draw_data(const Case& c) {
  const DefaultFloatEnvironment floats;  // whatever the caller has
  const Rng root = root_of(c.info.experiment, c.info.seed);
  Samples<double> samples =
      disturbed(c.experiment->problem.make<double>()->sample(
          0, c.info.n, root.child("data/test")));
  return {.hash = hex64(content_hash(samples)),
          .x = std::move(samples.x),
          .y = std::move(samples.y),
          .given = std::move(samples.given)};
}

std::string recipe_text(const Case& c, std::size_t position) {
  const Experiment& e = *c.experiment;
  std::string text = fmt::format(
      "experiment={}\nproblem={}\n", streams_of(e.name), e.problem.name);
  append(text, e.problem.options);
  append(text, "predictor", e.setting.predictor);
  append(text, "surrogate", e.setting.surrogate);
  text += fmt::format("output_scale={}\ngtol={}\nn={}\nseed={}\n",
                      e.setting.output_scale,
                      e.setting.gtol,
                      c.info.n,
                      c.info.seed);
  if (e.setting.output_form != OutputForm::linear)
    text += fmt::format("output_form={}\n",
                        static_cast<int>(e.setting.output_form));
  const Labelling& labels = e.setting.labels;
  if (labels.per_problem != 1 || labels.bounded != 0)
    text += fmt::format(
        "labels={}\nbounded={}\n", labels.per_problem, labels.bounded);
  for (std::size_t i = 0; i <= position; ++i) {
    const Stage& stage = *c.method->chain[i];
    text += fmt::format(
        "stage={}\niterations={}\n", stage.name(), c.stage_iterations[i]);
    if (stage.has_precision())
      text += fmt::format("precision={}\n", to_string(c.info.precision));
    append(text, stage.options());
  }
  return text;
}

std::vector<std::string> content_keys(const Case& c,
                                      std::string_view data_hash,
                                      const Numerics& numerics) {
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < c.method->chain.size(); ++i) {
    keys.push_back(hex128(recipe_text(c, i) +
                          fmt::format("recorded={}\ndata={}\nnumerics={}\n",
                                      c.experiment->setting.recorded,
                                      data_hash,
                                      numerics(c, i))));
  }
  return keys;
}

std::string numerics_of_build(const Case& c, std::size_t position) {
  return project_sources().fingerprint(
      chain_sources(*c.experiment, *c.method, position));
}

Numerics remembered_numerics() {
  using Known = std::map<std::pair<const Method*, std::size_t>, std::string>;
  return
      [known = std::make_shared<Known>()](const Case& c, std::size_t position) {
        std::string& text = (*known)[{c.method, position}];
        if (text.empty()) text = numerics_of_build(c, position);
        return text;
      };
}

std::vector<PlannedCase> planned(const std::vector<Case>& cases) {
  const Numerics numerics = remembered_numerics();
  std::vector<PlannedCase> all;
  for (const Case& c : cases) {
    const std::size_t last = c.method->chain.size() - 1;
    all.push_back({.name = c.info.name,
                   .recipe = hex128(recipe_text(c, last) + numerics(c, last))});
  }
  return all;
}

}  // namespace physinv
