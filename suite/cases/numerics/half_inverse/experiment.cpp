// Half-inverse updates where their matrices are worst: physics of vanishing
// size, batches with every sample twice, saturated and empty networks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "problems/scaled_output/scaled_output.h"
#include "suite/cases/jpo/common/claims.h"
#include "suite/diagnostics/half_inverse_stress.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv {
namespace {

constexpr const char* kName = "numerics/half-inverse";

const std::vector<double> kGammas = {1, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12};
const std::vector<double> kTaus = {0, 1e-10, 1e-6, 1e-4, 1e-2};
const std::vector<double> kKappas = {-0.5, -1};
const std::vector<StressStart> kStarts = {{"as drawn", 1},
                                          {"x 10", 10},
                                          {"x 1000", 1e3},
                                          {"all zero", 0},
                                          {"J = 0", 1, true}};
/// Two observations each, 30 parameters: more columns than rows, and fewer.
const std::vector<Index> kSamples = {4, 20};
constexpr const char* kPaths[] = {
    "Cholesky", "tridiagonal", "two-level", "SVD of J"};

/// Norms are rounded like the updates.
constexpr double kRounding = 1e-3;

std::shared_ptr<const Stage> stress() {
  HalfInverseStressOptions options{.name = "stress",
                                   .problems = {},
                                   .taus = kTaus,
                                   .kappas = kKappas,
                                   .starts = kStarts,
                                   .samples = kSamples};
  for (const double gamma : kGammas)
    options.problems.push_back(
        problem<ScaledOutput>("scaled_output", {.gamma = gamma}));
  return half_inverse_stress(std::move(options));
}

// ---- cells ------------------------------------------------------------------

/// The stage's cells by their position on the axes.
class Cells {
 public:
  explicit Cells(const StageRecord& stage) : arrays_(stage.arrays) {}

  Index count() const { return arrays_.at("status").cols(); }
  Index on(StressAxis axis, Index cell) const {
    return static_cast<Index>(
        arrays_.at("cell")(static_cast<Index>(axis), cell));
  }
  double get(const char* array, Index cell, Index row = 0) const {
    return arrays_.at(array)(row, cell);
  }
  StressStatus status(Index cell) const {
    return static_cast<StressStatus>(static_cast<int>(get("status", cell)));
  }
  bool is(StressStatus s, Index cell) const { return status(cell) == s; }
  /// The same combination with each sample once.
  Index once(Index cell) const {
    const auto axis = static_cast<Index>(StressAxis::copies);
    Batch<double> wanted = arrays_.at("cell").col(cell);
    wanted(axis) = 0;
    Index at = cell;
    while (arrays_.at("cell").col(at) != wanted) --at;
    return at;
  }

 private:
  const std::map<std::string, Batch<double>>& arrays_;
};

using Choice = std::function<bool(Index cell)>;

const StageRecord* find_stress(const Results& results) {
  for (const CaseRecord& c : results.cases())
    if (c.info.experiment == kName)
      for (const StageRecord& s : c.stages)
        if (s.arrays.contains("status")) return &s;
  return nullptr;
}

// ---- report -----------------------------------------------------------------

/// Cells by how they ended, and the largest update over its bound.
TableRow ends(const Cells& cells, std::string label, const Choice& chosen) {
  double counts[4] = {}, largest = -1;
  for (Index j = 0; j < cells.count(); ++j) {
    if (!chosen(j)) continue;
    ++counts[static_cast<int>(cells.status(j))];
    largest = std::max(largest, cells.get("size", j));
  }
  TableRow row{.label = std::move(label)};
  for (const double n : counts) row.cells.push_back({.ours = n});
  row.cells.push_back(
      {.text = largest < 0 ? "–" : fmt::format("{:.3g}", largest)});
  return row;
}

Table ends_table(const StageRecord* stage) {
  Table table{.id = "ends",
              .title = "How the combinations end",
              .digits = 0,
              .corner = "of",
              .note =
                  "Unproven: an update's error estimate exceeds 3e-4, or rests "
                  "on singular values that rounding could have made. Last "
                  "column: largest |update| / (s^kappa |g|), s the smallest "
                  "singular value kept."};
  for (const auto name : kStressStatusNames) table.columns.emplace_back(name);
  table.columns.emplace_back("update / bound");
  if (stage == nullptr) return table;
  const Cells cells(*stage);
  const auto add =
      [&](const std::string& label, StressAxis axis, std::size_t at) {
        table.rows.push_back(ends(cells, label, [&](Index j) {
          return cells.on(axis, j) == static_cast<Index>(at);
        }));
      };
  for (std::size_t i = 0; i < kStarts.size(); ++i)
    add("weights " + kStarts[i].name, StressAxis::start, i);
  for (std::size_t i = 0; i < kTaus.size(); ++i)
    add(fmt::format("tau = {:g}", kTaus[i]), StressAxis::tau, i);
  for (std::size_t i = 0; i < kGammas.size(); ++i)
    add(fmt::format("gamma = {:g}", kGammas[i]), StressAxis::problem, i);
  for (std::size_t i = 0; i < kKappas.size(); ++i)
    add(fmt::format("kappa = {:g}", kKappas[i]), StressAxis::kappa, i);
  add("each sample once", StressAxis::copies, 0);
  add("each sample twice", StressAxis::copies, 1);
  add("float", StressAxis::precision, 0);
  add("double", StressAxis::precision, 1);
  for (std::size_t i = 0; i < std::size(kPaths); ++i)
    table.rows.push_back(
        ends(cells, fmt::format("path {}", kPaths[i]), [&](Index j) {
          return cells.get("path", j) == static_cast<double>(i);
        }));
  return table;
}

/// A value over gamma and tau, the worst of the chosen cells.
Panel map(const Cells& cells,
          std::string title,
          const Choice& chosen,
          const std::function<double(Index)>& value) {
  Panel panel{.title = std::move(title),
              .x_label = "gamma",
              .y_label = "tau (lowest: 0)",
              .x_log = true,
              .y_log = true,
              .field = Field2D{}};
  Field2D& field = *panel.field;
  field.x.assign(kGammas.rbegin(), kGammas.rend());
  for (const double tau : kTaus)
    field.y.push_back(tau > 0 ? tau : 1e-2 * kTaus[1]);
  field.values.assign(kGammas.size() * kTaus.size(), 0.0);
  for (Index j = 0; j < cells.count(); ++j) {
    if (!chosen(j)) continue;
    const auto g = kGammas.size() - 1 -
                   static_cast<std::size_t>(cells.on(StressAxis::problem, j));
    const auto t = static_cast<std::size_t>(cells.on(StressAxis::tau, j));
    double& worst = field.values[t * kGammas.size() + g];
    worst = std::max(worst, value(j));
  }
  return panel;
}

Figure maps(const StageRecord* stage) {
  Figure figure{.id = "maps",
                .title = "Half-inverse updates over gamma and tau",
                .note =
                    "Ends: 0 ok, 1 zero, 2 unproven, 3 not finite; the worst "
                    "of all starts with J other than 0. Kept: of 8 singular "
                    "values in double, weights as drawn, kappa -1/2."};
  if (stage == nullptr) return figure;
  const Cells cells(*stage);
  for (const Index precision : {0, 1})
    for (const Index copies : {0, 1})
      figure.panels.push_back(map(
          cells,
          fmt::format("Ends: {}, each sample {}",
                      precision == 0 ? "float" : "double",
                      copies == 0 ? "once" : "twice"),
          [&](Index j) {
            const auto start =
                static_cast<std::size_t>(cells.on(StressAxis::start, j));
            return !kStarts[start].blind &&
                   cells.on(StressAxis::precision, j) == precision &&
                   cells.on(StressAxis::copies, j) == copies;
          },
          [&](Index j) { return cells.get("status", j); }));
  for (const Index copies : {0, 1})
    figure.panels.push_back(map(
        cells,
        fmt::format("Kept: {} samples, each {}",
                    kSamples[0],
                    copies == 0 ? "once" : "twice"),
        [&](Index j) {
          return cells.on(StressAxis::start, j) == 0 &&
                 cells.on(StressAxis::samples, j) == 0 &&
                 cells.on(StressAxis::kappa, j) == 0 &&
                 cells.on(StressAxis::precision, j) == 1 &&
                 cells.on(StressAxis::copies, j) == copies;
        },
        [&](Index j) { return cells.get("kept", j); }));
  return figure;
}

/// Loss after the updates and norm of the largest, over gamma.
Figure lines(const StageRecord* stage) {
  Figure figure{.id = "lines",
                .title = "What a few updates do",
                .note =
                    "Three updates at rate 1 in double, tau 1e-6, 20 samples. "
                    "Updates: the largest of them."};
  if (stage == nullptr) return figure;
  const Cells cells(*stage);
  const auto panel = [&](const char* label, const char* array, Index row) {
    Panel out{
        .x_label = "gamma", .y_label = label, .x_log = true, .y_log = true};
    for (std::size_t k = 0; k < kKappas.size(); ++k)
      for (std::size_t s = 0; s < 3; ++s) {
        Series series{
            .label = fmt::format(
                "kappa {:g}, weights {}", kKappas[k], kStarts[s].name),
            .method = fmt::format("{}-{}", k, s),
            .markers = true,
            .dashed = k == 1};
        for (Index j = 0; j < cells.count(); ++j) {
          const double value = cells.get(array, j, row);
          if (cells.on(StressAxis::kappa, j) == Index(k) &&
              cells.on(StressAxis::start, j) == Index(s) &&
              cells.on(StressAxis::samples, j) == 1 &&
              cells.on(StressAxis::tau, j) == 2 &&
              cells.on(StressAxis::copies, j) == 0 &&
              cells.on(StressAxis::precision, j) == 1 && value > 0) {
            series.x.push_back(kGammas[static_cast<std::size_t>(
                cells.on(StressAxis::problem, j))]);
            series.y.push_back(value);
          }
        }
        out.series.push_back(std::move(series));
      }
    return out;
  };
  figure.panels = {panel("loss after the updates", "loss", 1),
                   panel("|update|", "norm", 0)};
  return figure;
}

// ---- claims -----------------------------------------------------------------

ClaimResult claim(const StageRecord* stage,
                  const char* id,
                  const char* says,
                  const std::function<void(const Cells&, Judge&)>& ask) {
  Judge judge;
  if (stage == nullptr) {
    judge.missing("the sweep");
  } else {
    ask(Cells(*stage), judge);
  }
  return std::move(judge).result(id, says, "smoke");
}

double count(const Cells& cells, const Choice& chosen) {
  double n = 0;
  for (Index j = 0; j < cells.count(); ++j) n += chosen(j);
  return n;
}

void all_finite(const Cells& cells, Judge& judge) {
  const auto without_cut = [&](Index j) {
    return kTaus[static_cast<std::size_t>(cells.on(StressAxis::tau, j))] == 0;
  };
  const auto lost = [&](bool cut) {
    return count(cells, [&](Index j) {
      return without_cut(j) != cut && cells.is(StressStatus::nonfinite, j);
    });
  };
  judge.report("cells", static_cast<double>(cells.count()))
      .at_most("not finite with a cut", lost(true), 0)
      .report("refused or overflowing without one", lost(false))
      .report("unproven", count(cells, [&](Index j) {
                return cells.is(StressStatus::unproven, j);
              }));
}

void within_bounds(const Cells& cells, Judge& judge) {
  double of_kept = 0, of_cut = 0;
  for (Index j = 0; j < cells.count(); ++j) {
    of_kept = std::max(of_kept, cells.get("size", j, 0));
    of_cut = std::max(of_cut, cells.get("size", j, 1));
  }
  judge.at_most("largest over s_kept^kappa |g|", of_kept, 1 + kRounding)
      .at_most("over (tau s_max)^kappa |g|", of_cut, 1 + kRounding);
}

void copies_keep_no_more(const Cells& cells, Judge& judge) {
  double pairs = 0, more = 0, unproven = 0;
  for (Index j = 0; j < cells.count(); ++j) {
    if (cells.on(StressAxis::copies, j) == 0) continue;
    const Index once = cells.once(j);
    const auto proven = [&](Index cell) {
      return cells.status(cell) < StressStatus::unproven;
    };
    const bool shown = proven(j) && proven(once);
    const bool exceeds = cells.get("kept", j) > cells.get("kept", once);
    ++pairs;
    more += shown && exceeds;
    unproven += !shown && exceeds;
  }
  judge.report("pairs", pairs)
      .at_most("of the proven with more kept", more, 0)
      .report("of the others", unproven);
}

void zero_stays(const Cells& cells, Judge& judge) {
  double blind = 0, moved = 0;
  for (Index j = 0; j < cells.count(); ++j) {
    if (!kStarts[static_cast<std::size_t>(cells.on(StressAxis::start, j))]
             .blind)
      continue;
    ++blind;
    moved += cells.get("norm", j) != 0 || !cells.is(StressStatus::zero, j);
  }
  judge.at_least("cells with J = 0", blind, 1)
      .at_most("of them with an update", moved, 0);
}

Section report(const Results& results, const Published&) {
  const StageRecord* stage = find_stress(results);
  return {
      .experiment = kName,
      .title = "Numerics of half-inverse updates",
      .paper = "hig",
      .tables = {ends_table(stage)},
      .figures = {maps(stage), lines(stage)},
      .claims = {
          claim(stage,
                "N1",
                "With a cut, no update and no loss is NaN or infinite",
                all_finite),
          claim(stage,
                "N2",
                "Every update is as short as the singular values kept and the "
                "cut promise",
                within_bounds),
          claim(stage,
                "N3",
                "Where updates are proven, a batch with every sample twice "
                "keeps no more singular values than with each once",
                copies_keep_no_more),
          claim(stage,
                "N4",
                "A Jacobian of zeros gives updates that are exactly zero",
                zero_stays)}};
}

const std::vector<Row> kRows = {
    {.methods = {"stability"}, .n = {1}, .seeds = {0}}};

const auto kRegistered = register_experiment({
    .name = kName,
    .title = "Numerics of half-inverse updates",
    .source = {.paper = "hig", .where = "Secs. 2.1, 2.3"},
    .problem = problem<ScaledOutput>("scaled_output"),
    .setting = {.predictor = {{Field::given},
                              nn::mlp({.hidden = {7},
                                       .activation = nn::Activation::tanh,
                                       .init = nn::Init::glorot})}},
    .profiles = {{.name = "smoke", .rows = kRows},
                 {.name = "quick", .rows = kRows},
                 {.name = "standard", .rows = kRows},
                 {.name = "paper", .rows = kRows}},
    .methods = {{"stability", {stress()}}},
    .report = report,
});

}  // namespace
}  // namespace physinv
