#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "suite/evidence/cell.h"
#include "suite/evidence/performance_profiles.h"
#include "suite/evidence/running_time.h"
#include "suite/evidence/standings.h"

namespace physinv {
namespace {

/// Tolerances of running times; scores are of the first.
constexpr double kTolerances[] = {1e-2, 1e-5};
/// Of more pairs, those of the first methods.
constexpr std::size_t kMostPairs = 28;
constexpr const char* kNotKnown = "not known";

/// What methods are called in an experiment's pages.
class Titles {
 public:
  Titles(const CommonRuns& common,
         const std::map<std::string, std::string>& titles)
      : methods_(common.methods), titles_(titles) {}
  std::string operator()(std::size_t m) const {
    const auto found = titles_.find(methods_[m]);
    return found == titles_.end() ? methods_[m] : found->second;
  }

 private:
  const std::vector<std::string>& methods_;
  const std::map<std::string, std::string>& titles_;
};

/// A number with all its digits for programs.
Cell number(double value, const char* format = "{:.3g}") {
  Cell cell = written(value, format);
  if (std::isfinite(value)) cell.ours = value;
  return cell;
}

std::string noun(const CommonRuns& common) {
  return common.runs ? "runs" : "problems";
}

/// Runs of a method that failed, and those of them without a known time
/// or the simulations of.
struct Failed {
  std::string method;
  std::size_t runs = 0, unknown = 0;
};

std::vector<Failed> failed_of(const CommonRuns& common, const Titles& title) {
  std::vector<Failed> all;
  for (std::size_t m = 0; m < common.methods.size(); ++m) {
    Failed one{.method = title(m)};
    for (const CommonRun& group : common.groups) {
      const ConvergenceHistory& history = group.histories[m];
      one.runs += history.failed;
      one.unknown += !history.all_seconds || !history.all_simulations;
    }
    if (one.runs > 0) all.push_back(std::move(one));
  }
  return all;
}

/// " Failed: BFGS 1 of 3 runs, ...". Empty if none did.
std::string failed_note(const CommonRuns& common, const Titles& title) {
  std::string text;
  for (const Failed& f : failed_of(common, title))
    text += fmt::format("{}{} {} of {} runs",
                        text.empty() ? " Failed, of which the loss counts as "
                                       "the highest: "
                                     : ", ",
                        f.method,
                        f.runs,
                        common.groups.size());
  return text.empty() ? "" : text + ".";
}

/// The same of what was spent until then.
std::string spent_note(const CommonRuns& common, const Titles& title) {
  std::string text;
  for (const Failed& f : failed_of(common, title))
    text += fmt::format(
        "{}{} {} of {} runs{}",
        text.empty() ? " Failed, which counts with all that was spent until "
                       "then: "
                     : ", ",
        f.method,
        f.runs,
        common.groups.size(),
        f.unknown > 0 ? fmt::format(" ({} without a record of it, so that "
                                    "there is no value)",
                                    f.unknown)
                      : "");
  return text.empty() ? "" : text + ".";
}

std::string left_out(const CommonRuns& common) {
  return common.left_out == 0
             ? ""
             : fmt::format(
                   " The {} methods that end lowest; {} more are left "
                   "out.",
                   common.methods.size(),
                   common.left_out);
}

Table standings_table(const CommonRuns& common,
                      const Standings& s,
                      const TargetCosts& costs,
                      const Titles& title) {
  Table table{.id = "standings",
              .title = "How the methods stand",
              .digits = 2,
              .corner = "method",
              .columns = {"mean rank",
                          "lowest, %",
                          "score by seconds",
                          "score by simulations"}};
  const auto seconds = performance_ratios(costs.seconds);
  const auto simulations = performance_ratios(costs.simulations);
  for (const std::size_t m : s.order)
    table.rows.push_back({title(m),
                          {number(s.mean_rank[m]),
                           number(100 * s.lowest[m]),
                           number(profile_score(seconds[m])),
                           number(profile_score(simulations[m]))}});
  table.note = fmt::format(
      "Ranks of the final losses on {} {}; 1 is the lowest. Losses that reach "
      "the same of the 24 targets of the runtime distribution, or are below "
      "{:g}, count as equal. Scores (AlgoPerf): mean height of the performance "
      "profile of tau = {:g} between factors of 1 and {:g}; a method that is "
      "fastest on every problem has 1.{}{}",
      s.problems,
      noun(common),
      kEqualLoss,
      kTolerances[0],
      kScoredFactor,
      failed_note(common, title),
      left_out(common));
  return table;
}

void add_times(TableRow& row,
               const TargetCosts& costs,
               std::size_t m,
               const std::string& name) {
  for (const bool by_time : {true, false}) {
    const auto& cost = by_time ? costs.seconds[m] : costs.simulations[m];
    const auto& spent =
        by_time ? costs.spent_seconds[m] : costs.spent_simulations[m];
    const RunningTime time = expected_running_time(
        cost, spent, name + (by_time ? "/seconds" : "/simulations"));
    if (by_time)
      row.cells.push_back(number(time.problems == 0
                                     ? 0
                                     : 100 * static_cast<double>(time.solved) /
                                           static_cast<double>(time.problems)));
    for (const double value : {time.expected, time.low, time.high})
      row.cells.push_back(std::isfinite(value) ? number(value)
                          : std::isnan(value)  ? Cell{.text = kNotKnown}
                                               : Cell{.text = "never"});
  }
}

Table times_table(const CommonRuns& common,
                  const Standings& s,
                  const std::vector<TargetCosts>& costs,
                  const Titles& title) {
  Table table{.id = "running_time",
              .title = "Expected running time to a target",
              .digits = 3,
              .corner = "method",
              .columns = {"solved, %",
                          "seconds",
                          "seconds from",
                          "seconds to",
                          "simulations",
                          "simulations from",
                          "simulations to"}};
  for (std::size_t k = 0; k < costs.size(); ++k)
    for (const std::size_t m : s.order) {
      table.rows.push_back(
          {fmt::format("{}, tau = {:g}", title(m), kTolerances[k]), {}});
      add_times(table.rows.back(),
                costs[k],
                m,
                fmt::format("{}/{:g}", common.methods[m], kTolerances[k]));
    }
  table.note = fmt::format(
      "Everything spent until the loss is at most f_L + tau (f_0 - f_L), as "
      "in the performance profiles, or until the end, divided by the number "
      "of {} solved: COCO's expected running time. From, to: 95 % interval of "
      "1,000 resamplings of the {}, which count as independent.{}{}{}",
      noun(common),
      noun(common),
      spent_note(common, title),
      left_out(common),
      common.crowded
          ? " Some stages shared their cores, so their times are too long."
          : "");
  return table;
}

Table pairs_table(const CommonRuns& common,
                  const Standings& s,
                  const Titles& title) {
  Table table{
      .id = "rank_test",
      .title = "Which method ends lower",
      .digits = 0,
      .corner = "pair",
      .columns = {"lower, %", "equal, %", "p", "p by Holm", "the first is"}};
  const double share = 100 / static_cast<double>(s.problems);
  const std::size_t shown = std::min(s.pairs.size(), kMostPairs);
  for (std::size_t k = 0; k < shown; ++k) {
    const MethodPair& pair = s.pairs[k];
    table.rows.push_back({title(pair.first) + " against " + title(pair.second),
                          {number(share * static_cast<double>(pair.test.below)),
                           number(share * static_cast<double>(pair.test.ties)),
                           number(pair.test.p, "{:.2g}"),
                           number(pair.p, "{:.2g}"),
                           {.text = pair.p >= kSignificant ? "not shown"
                                    : pair.test.down       ? "lower"
                                                           : "higher"}}});
  }
  table.note = fmt::format(
      "Final losses on the same {} {}: two-sided Wilcoxon signed rank test of "
      "the ratios of the targets reached, without ties. p by Holm is corrected "
      "for {} pairs; below "
      "{:g} the difference is significant.{}{}{}{}",
      s.problems,
      noun(common),
      s.pairs.size(),
      kSignificant,
      common.runs ? ""
                  : fmt::format(" Problems of one network are not independent; "
                                "there were {} runs.",
                                common.groups.size()),
      s.pairs.size() > shown
          ? fmt::format(" The first {} pairs are shown.", shown)
          : "",
      failed_note(common, title),
      left_out(common));
  return table;
}

}  // namespace

void add_standings(Section& section,
                   const CommonRuns& common,
                   const std::map<std::string, std::string>& titles) {
  const Standings s = standings(common);
  if (s.pairs.empty()) return;
  const Titles title(common, titles);
  std::vector<TargetCosts> costs;
  for (const double tolerance : kTolerances)
    costs.push_back(target_costs(common, tolerance));
  section.standing = standing_text(common, s, titles);
  section.tables.push_back(standings_table(common, s, costs.front(), title));
  section.tables.push_back(times_table(common, s, costs, title));
  section.tables.push_back(pairs_table(common, s, title));
}

}  // namespace physinv
