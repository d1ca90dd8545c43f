#include "suite/compare/summary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "suite/core/median.h"
#include "suite/results/shortened.h"

namespace physinv {
namespace {

/// A method while its stages are read.
struct Reader {
  MethodChange change;
  Index last = -1;  ///< position of the last stage
  std::string stage;
  /// Of a run, on the first side and on this one, by n and seed.
  std::map<std::pair<Index, std::int64_t>, std::pair<double, double>> seconds;

  void add(const Compared& compared, std::size_t side);
  void add_last(const Reading& a, const Reading& b);
};

void Reader::add_last(const Reading& a, const Reading& b) {
  change.solved_first += a.solved;
  change.solved += b.solved;
  change.examples_first += a.examples;
  change.examples += b.examples;
}

void Reader::add(const Compared& compared, std::size_t side) {
  const Reading &a = *compared.sides.front(), &b = *compared.sides[side];
  ++change.stages;
  const Direction end = end_direction(a, b);
  change.better_ends += end == Direction::better;
  change.worse_ends += end == Direction::worse;
  if (a.position > last) {
    last = a.position;
    stage = compared.id.stage;
    change.solved_first = change.solved = 0;
    change.examples_first = change.examples = 0;
  }
  if (a.position == last) add_last(a, b);
  if (const TimeRatio times = time_ratio(a, b); times.compares) {
    auto& run = seconds[{compared.id.n, compared.id.seed}];
    run.first += times.a.median;
    run.second += times.b.median;
  }
}

std::optional<double> time_of(const Reader& method) {
  std::vector<double> ratios;
  for (const auto& [run, seconds] : method.seconds)
    ratios.push_back(std::max(seconds.second, kShortTime) /
                     std::max(seconds.first, kShortTime));
  return ratios.empty() ? std::nullopt : std::optional(median(ratios));
}

const SideRank* rank_of(const std::vector<SideRank>& ranks,
                        const MethodChange& change,
                        const std::string& stage) {
  const auto found =
      std::find_if(ranks.begin(), ranks.end(), [&](const SideRank& rank) {
        return std::tie(rank.experiment, rank.method, rank.stage, rank.side) ==
               std::tie(change.experiment, change.method, stage, change.side);
      });
  return found == ranks.end() ? nullptr : &*found;
}

/// "52 %"; of losses that are not stored nothing is known.
std::string share_text(Index solved, Index examples) {
  return examples == 0 ? "–"
                       : fmt::format("{:.0f} %", percent_of(solved, examples));
}

/// "on 57 % of 336 problems, p = 0.001"
std::string rank_text(const SideRank& rank) {
  const std::size_t own = rank.better() ? rank.test.below : rank.test.above();
  return fmt::format(
      "on {:.0f} % of {} problems, {}",
      100 * static_cast<double>(own) / static_cast<double>(rank.test.pairs),
      rank.test.pairs,
      p_text(rank.p));
}

std::string losses_text(const MethodChange& change) {
  if (change.rank == nullptr) return "not compared";
  if (!change.rank->differs()) return "no difference shown";
  return fmt::format("{} ({})",
                     change.rank->better() ? "lower" : "higher",
                     rank_text(*change.rank));
}

std::string times_text(double ratio) { return fmt::format("×{:.2g}", ratio); }

std::string ends_text(const MethodChange& change) {
  if (change.better_ends + change.worse_ends == 0) return "=";
  return fmt::format("{} better, {} worse of {}",
                     change.better_ends,
                     change.worse_ends,
                     change.stages);
}

/// "higher losses: a (...), b (...) and 2 more"; empty of none.
class Listed {
 public:
  explicit Listed(std::string what) : what_(std::move(what)) {}
  void add(const std::string& name, const std::string& how) {
    if (++count_ <= kNamed) names_.push_back(name + " (" + how + ")");
  }
  void add_to(std::vector<std::string>& parts) const {
    if (count_ == 0) return;
    parts.push_back(fmt::format(
        "{}: {}{}",
        what_,
        fmt::join(names_, ", "),
        count_ > kNamed ? fmt::format(" and {} more", count_ - kNamed) : ""));
  }

 private:
  static constexpr std::size_t kNamed = 3;
  std::string what_;
  std::vector<std::string> names_;
  std::size_t count_ = 0;
};

/// Without the experiment if all are of one.
std::string name_of(const MethodChange& change, bool one_experiment) {
  return one_experiment ? change.method
                        : change.experiment + "/" + change.method;
}

bool of_one_experiment(const std::vector<MethodChange>& changes) {
  return std::all_of(changes.begin(), changes.end(), [&](const auto& change) {
    return change.experiment == changes.front().experiment;
  });
}

std::string summary_of(const std::vector<MethodChange>& changes,
                       std::size_t side,
                       double factor) {
  const bool one = of_one_experiment(changes);
  factor = std::max(factor, 1.0);
  Listed lower("lower losses"), higher("higher losses"), slower("slower"),
      faster("faster"), worse("worse ends"), better("better ends");
  std::size_t methods = 0, unchanged = 0;
  for (const MethodChange& c : changes) {
    if (c.side != side) continue;
    ++methods;
    unchanged += c.unchanged;
    const std::string name = name_of(c, one);
    if (c.rank != nullptr && c.rank->differs())
      (c.rank->better() ? lower : higher).add(name, rank_text(*c.rank));
    if (c.time && *c.time > factor) slower.add(name, times_text(*c.time));
    if (c.time && *c.time < 1 / factor) faster.add(name, times_text(*c.time));
    const auto of = [&](std::size_t count) {
      return fmt::format("{} of {} stages", count, c.stages);
    };
    if (c.worse_ends > 0) worse.add(name, of(c.worse_ends));
    if (c.better_ends > 0) better.add(name, of(c.better_ends));
  }
  std::vector<std::string> parts;
  for (const Listed* list :
       {&higher, &lower, &worse, &better, &slower, &faster})
    list->add_to(parts);
  if (parts.empty()) parts.emplace_back("no method got better or worse");
  if (methods > 0)
    parts.push_back(
        fmt::format("{} of {} methods unchanged", unchanged, methods));
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace

std::vector<MethodChange> method_changes(const Comparison& comparison,
                                         const std::vector<SideRank>& ranks) {
  std::map<std::tuple<std::size_t, std::string, std::string>, Reader> all;
  for (const Compared& row : comparison.rows)
    for (const Compared& stage : row.stages()) {
      if (stage.missing()) continue;
      for (std::size_t side = 1; side < stage.sides.size(); ++side) {
        Reader& own = all[{side, stage.id.experiment, stage.id.method}];
        own.change.experiment = stage.id.experiment;
        own.change.method = stage.id.method;
        own.change.side = side;
        own.change.unchanged &= stage.unchanged_on(side, comparison.thresholds);
        own.add(stage, side);
      }
    }
  std::vector<MethodChange> changes;
  for (auto& [key, own] : all) {
    own.change.time = time_of(own);
    own.change.rank = rank_of(ranks, own.change, own.stage);
    if (own.change.rank != nullptr && own.change.rank->differs())
      own.change.unchanged = false;
    changes.push_back(std::move(own.change));
  }
  return changes;
}

Table method_table(const std::vector<MethodChange>& changes,
                   const Comparison& comparison,
                   std::size_t most) {
  const auto solved_on = [&](std::size_t side) {
    return "solved " + shortened(comparison.labels[side], 24);
  };
  const bool two = comparison.labels.size() == 2;
  Table table{.id = "methods",
              .title = "Methods that changed",
              .corner = "method",
              .columns = {solved_on(0),
                          two ? solved_on(1) : "solved",
                          "losses",
                          "time",
                          "ends"},
              .keys = {"experiment", "method", "side"}};
  std::size_t unchanged = 0, left_out = 0;
  for (const MethodChange& c : changes) {
    if (c.unchanged) {
      ++unchanged;
      continue;
    }
    if (table.rows.size() == most) {
      ++left_out;
      continue;
    }
    const std::string& label = comparison.labels[c.side];
    std::string name = c.experiment + "/" + c.method;
    if (comparison.labels.size() > 2) name += ", " + shortened(label, 24);
    table.rows.push_back(
        {std::move(name),
         {{.text = share_text(c.solved_first, c.examples_first)},
          {.text = share_text(c.solved, c.examples)},
          {.text = losses_text(c)},
          {.text = !c.time        ? "not compared"
                   : *c.time == 1 ? "="
                                  : times_text(*c.time)},
          {.text = ends_text(c)}},
         {c.experiment, c.method, label}});
  }
  table.note = fmt::format(
      "Solved: examples whose last loss is at most {:g} (--solved). Time: all "
      "stages of a run, median over runs; below {:g} ms times are equal. ",
      comparison.thresholds.solved,
      1e3 * kShortTime);
  if (left_out > 0) table.note += fmt::format("{} more changed. ", left_out);
  table.note +=
      fmt::format("{} of {} methods unchanged.", unchanged, changes.size());
  return table;
}

std::vector<std::string> summary_sentences(
    const std::vector<MethodChange>& changes, const Comparison& comparison) {
  std::vector<std::string> sentences;
  for (std::size_t s = 1; s < comparison.labels.size(); ++s)
    sentences.push_back(
        fmt::format("{} against {}: {}",
                    comparison.labels[s],
                    comparison.labels.front(),
                    summary_of(changes, s, comparison.thresholds.factor)));
  return sentences;
}

}  // namespace physinv
