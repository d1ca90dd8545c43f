// What claims.md asks for: a number of each setting, which a table shows, too.
#include "suite/cases/common/claims.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "suite/cases/jpo/bfgs_precision/settings.h"
#include "suite/cases/jpo/common/values.h"
#include "suite/evidence/study_table.h"

namespace physinv::bfgs_precision {
namespace {

constexpr Index kSeeds = 4;  ///< the fewest that the paper has of any

// ---- numbers of a setting ---------------------------------------------------

/// In the precision that the setting works in.
Vector<double> own_losses(const StageRecord& stage, bool single) {
  const auto own = stage.arrays.find("own_loss");
  if (own != stage.arrays.end()) return own->second.row(0).transpose();
  if (!single) return stage.loss;
  return stage.loss.cast<float>().cast<double>();
}

/// Mean percentage over all n of the problems where JPO, or its refinement, is
/// better than BFGS of the same setting, or equal.
template <bool kRefined, double Shares::*kShare>
Quantity against_bfgs(const Choice& c) {
  const RunValue value = [=](const Run& run) -> std::optional<double> {
    const auto bfgs = run.beside({c.bfgs()});
    if (!bfgs) return {};
    return compare_losses(own_losses(*run.stage, c.single),
                          own_losses(*bfgs->stage, c.single),
                          Equality::strict).*
           kShare;
  };
  return percent(depends_on(mean({c.jpo(), kRefined ? "refine" : "fit"}, value),
                            {{c.bfgs()}}));
}

Select bfgs_of(const Choice& c) { return {c.bfgs(), "solve"}; }
Select refined_of(const Choice& c) { return {c.jpo(), "refine"}; }

Quantity bfgs_iterations(const Choice& c) {
  return median_of_examples(bfgs_of(c), iterations());
}
Quantity within_ten(const Choice& c) {
  return percent(share_of_examples(bfgs_of(c),
                                   jpo::largest_sets(iterations()),
                                   [](double k) { return k <= 10; }));
}
/// Of the problems that are solved: App. D.3 counts no others.
template <bool kRefined>
Quantity iterations_of_solved(const Choice& c) {
  return median_of_examples(
      kRefined ? refined_of(c) : bfgs_of(c),
      jpo::where(jpo::is_solved(within_of_truth(1e-3)), iterations()));
}
/// To what is read as machine precision.
template <bool kRefined>
Quantity at_zero(const Choice& c) {
  return percent(
      mean(kRefined ? refined_of(c) : bfgs_of(c), jpo::solved(Solved(1e-12))));
}
Quantity mean_over_bfgs(const Choice& c) {
  const RunValue value = [=](const Run& run) -> std::optional<double> {
    const auto bfgs = run.beside(bfgs_of(c));
    if (!bfgs) return {};
    return run.stage->loss.mean() / bfgs->stage->loss.mean();
  };
  return depends_on(mean({c.jpo(), "fit"}, value), {bfgs_of(c)});
}

// ---- columns ----------------------------------------------------------------

using Column = StudyColumn<Choice>;

std::vector<Column> tables(const std::string& varied) {
  const auto column = [&](const char* title, auto of, const char* printed) {
    return Column(title, of, varied + ' ' + printed);
  };
  return {
      column("better, %",
             against_bfgs<false, &Shares::better>,
             "table4/jpo/better"),
      column(
          "equal, %", against_bfgs<false, &Shares::equal>, "table4/jpo/equal"),
      column("refined better, %",
             against_bfgs<true, &Shares::better>,
             "table5/jpo/better"),
      column("refined equal, %",
             against_bfgs<true, &Shares::equal>,
             "table5/jpo/equal")};
}

Condition all_of_them(std::string label, Quantity q, const Choice&) {
  return at_least(std::move(label), std::move(q), 100);
}

std::vector<Column> columns_of(const std::string& varied) {
  if (varied == "jpo/robotic-arm")
    return {
        {"iterations of BFGS (a couple)", bfgs_iterations, asks_within(1, 25)},
        {"BFGS below 1e-12, % (all)", at_zero<false>, all_of_them},
        {"refined JPO, % (all)", at_zero<true>, all_of_them}};
  std::vector<Column> all = tables(varied);
  if (varied == "jpo/kuramoto-sivashinsky") {
    all.push_back({"iterations of BFGS (12 to 22)",
                   iterations_of_solved<false>,
                   asks_within(12, 22)});
    all.push_back({"of the refinement (4 to 17)",
                   iterations_of_solved<true>,
                   asks_within(4, 17)});
  }
  if (varied == "jpo/navier-stokes") {
    all.push_back(
        {"BFGS within 10 iterations, % (usually)", within_ten, asks_above(50)});
    all.push_back({"mean loss of JPO over BFGS's (above)",
                   mean_over_bfgs,
                   asks_above(1)});
  }
  return all;
}

StudyTable<Choice> settings_of(const Study& s) {
  return {.settings = s.choices,
          .columns = columns_of(s.varied),
          .title = [](const Choice& choice) { return choice.title; },
          .seeds = kSeeds};
}

// ---- claims -----------------------------------------------------------------

/// Each column comes out with some setting.
std::vector<Condition> each_with_some_setting(const Study& s) {
  const auto study = settings_of(s);
  std::vector<Condition> all;
  for (const Column& c : study.columns) {
    Condition any = study.condition(s.choices[0], c);
    for (std::size_t k = 1; k < s.choices.size(); ++k)
      any = either(any, study.condition(s.choices[k], c));
    all.push_back(std::move(any));
  }
  return all;
}

// ---- report -----------------------------------------------------------------

Section report(const Study& s, const Evidence& evidence) {
  Table table{
      .id = "settings",
      .title = "JPO against BFGS by precision and tolerance",
      .where = "Sec. 4, Tables 4 and 5",
      .corner = "precision, gtol",
      .note =
          "Means over n, then mean ± sample standard deviation over seeds; of "
          "iterations medians. In brackets what the text states. Both methods "
          "of a row have its setting; float compares float losses."};
  return {.tables = {settings_of(s).rows(std::move(table), evidence)}};
}

}  // namespace

void add_claims(Registry& r) {
  for (const Study& s : all_studies()) {
    ClaimNames names = claim_names();
    names.set("columns_of_every_setting", settings_of(s).conditions());
    names.set("each_column_with_some_setting", each_with_some_setting(s));
    add_claims_of_experiment(r, "jpo/bfgs_precision", s.name, names);
    r.add_report(s.name, std::bind_front(report, s));
  }
}

}  // namespace physinv::bfgs_precision
