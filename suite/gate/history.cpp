#include "suite/gate/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <stdexcept>

#include "suite/core/decimal.h"
#include "suite/core/math.h"
#include "suite/core/stop.h"
#include "suite/core/whole.h"
#include "suite/results/shortened.h"
#include "suite/results/solved_loss.h"

namespace physinv {
namespace {

/// Losses nearer than this are the same.
constexpr double kSameLoss = 1e-6;

std::vector<std::string_view> split(std::string_view text, char at) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const auto end = std::min(text.find(at), text.size());
    parts.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

/// 0 for what is none.
double number(std::string_view text) {
  return decimal<double>(text).value_or(0);
}

/// "NAME results=.. loss=BEST,MEDIAN,WORST ms=FAST..SLOW ..."
void add_stage(PastBaseline& past, const std::vector<std::string_view>& words) {
  PastBaseline::Stage stage;
  for (const std::string_view word : words) {
    if (word.starts_with("results=")) stage.results = word.substr(8);
    if (word.starts_with("loss="))
      if (const auto losses = split(word.substr(5), ','); losses.size() >= 2)
        if (const double loss = number(losses[1]); std::isfinite(loss))
          stage.loss = loss;
    if (word.starts_with("stop=")) stage.stop = word.substr(5);
    if (word.starts_with("nonfinite="))
      stage.nonfinite = whole_part<std::int64_t>(number(word.substr(10)));
    if (word.starts_with("ms="))
      stage.fastest_ms = number(word.substr(3, word.find("..") - 3));
  }
  past.stages[std::string(words.front())] = std::move(stage);
}

/// A link from one commit to the next: the geometric mean of the ratios.
class Link {
 public:
  void add(double from, double to) {
    if (!(from > 0) || !(to > 0)) return;
    sum_ += math::log(to / from);
    ++count_;
  }
  std::optional<double> ratio() const {
    return count_ == 0 ? std::nullopt : std::optional(math::exp(sum_ / count_));
  }

 private:
  double sum_ = 0;
  int count_ = 0;
};

/// Is the median of the same losses on both sides?
bool losses_compare(const PastBaseline::Stage& a,
                    const PastBaseline::Stage& b) {
  return a.loss && b.loss && a.nonfinite == b.nonfinite && !a.failed() &&
         !b.failed();
}

/// Losses that are solved are equal.
double raised(double loss) { return std::max(loss, kEqualLoss); }

using Ratio = std::function<std::optional<double>(
    const PastBaseline&, const PastBaseline&, const std::string& group)>;

std::string group_of(const std::string& name) {
  return name.substr(0, name.find('/'));
}

/// Over what both have of a group; `add` says what counts.
template <class T, class Add>
std::optional<double> ratio_over(const std::map<std::string, T>& a,
                                 const std::map<std::string, T>& b,
                                 const std::string& group,
                                 Add&& add) {
  Link link;
  for (const auto& [name, now] : b)
    if (const auto before = a.find(name);
        before != a.end() && group_of(name) == group)
      add(link, before->second, now);
  return link.ratio();
}

std::optional<double> loss_ratio(const PastBaseline& a,
                                 const PastBaseline& b,
                                 const std::string& group) {
  const auto add = [](Link& link, const auto& before, const auto& now) {
    if (losses_compare(before, now))
      link.add(raised(*before.loss), raised(*now.loss));
  };
  return ratio_over(a.stages, b.stages, group, add);
}

std::optional<double> time_ratio(const PastBaseline& a,
                                 const PastBaseline& b,
                                 const std::string& group) {
  if (a.machine != b.machine) return {};
  const auto add = [](Link& link, const auto& before, const auto& now) {
    if (!before.failed() && !now.failed())
      link.add(before.fastest_ms, now.fastest_ms);
  };
  return ratio_over(a.stages, b.stages, group, add);
}

std::optional<double> instruction_ratio(const PastBaseline& a,
                                        const PastBaseline& b,
                                        const std::string& group) {
  if (a.counter != b.counter) return {};
  const auto add = [](Link& link, std::uint64_t before, std::uint64_t now) {
    link.add(static_cast<double>(before), static_cast<double>(now));
  };
  return ratio_over(a.instructions, b.instructions, group, add);
}

Figure index_figure(const std::vector<PastBaseline>& past,
                    const std::set<std::string>& groups,
                    const char* id,
                    const char* title,
                    const char* note,
                    const Ratio& ratio) {
  Panel panel{.x_label = "baseline, oldest first",
              .y_label = "over the first",
              .y_log = true};
  for (const std::string& group : groups) {
    Series s{.label = group, .method = group, .markers = true};
    double index = 1;
    for (std::size_t k = 0; k < past.size(); ++k) {
      if (k > 0) index *= ratio(past[k - 1], past[k], group).value_or(1);
      const bool there = std::any_of(
          past[k].stages.begin(), past[k].stages.end(), [&](const auto& stage) {
            return group_of(stage.first) == group;
          });
      if (!there) continue;
      s.x.push_back(static_cast<double>(k + 1));
      s.y.push_back(index);
    }
    panel.series.push_back(std::move(s));
  }
  return {.id = id,
          .title = title,
          .panels = {std::move(panel)},
          .columns = 1,
          .note = note};
}

struct Moved {
  int both = 0, bits = 0, losses = 0, added = 0, gone = 0;
};

/// By more than nearly nothing, or to another number of finite losses.
bool other_losses(const PastBaseline::Stage& a, const PastBaseline::Stage& b) {
  if (!losses_compare(a, b))
    return a.loss.has_value() != b.loss.has_value() ||
           a.nonfinite != b.nonfinite || a.failed() != b.failed();
  const double from = raised(*a.loss), to = raised(*b.loss);
  return std::abs(to - from) > kSameLoss * from;
}

Moved moved_between(const PastBaseline& a, const PastBaseline& b) {
  Moved out;
  for (const auto& [name, stage] : b.stages) {
    const auto at = a.stages.find(name);
    if (at == a.stages.end()) {
      ++out.added;
      continue;
    }
    ++out.both;
    out.bits += at->second.results != stage.results;
    out.losses += other_losses(at->second, stage);
  }
  out.gone = static_cast<int>(a.stages.size()) - out.both;
  return out;
}

double failed_in(const PastBaseline& past) {
  return static_cast<double>(std::count_if(
      past.stages.begin(), past.stages.end(), [](const auto& stage) {
        return stage.second.failed();
      }));
}

Cell count_cell(double value) { return {.ours = value}; }

Cell ratio_cell(const std::vector<std::optional<double>>& all) {
  Link link;
  for (const auto& ratio : all)
    if (ratio) link.add(1, *ratio);
  const auto mean = link.ratio();
  if (!mean) return {.text = "–"};
  return {.ours = *mean, .text = fmt::format("×{:.3g}", *mean)};
}

Table commits_table(const std::vector<PastBaseline>& past,
                    const std::set<std::string>& groups) {
  Table table{.id = "commits",
              .title = "Baselines and what they moved",
              .digits = 0,
              .corner = "baseline",
              .columns = {"date",
                          "stages",
                          "new",
                          "gone",
                          "failed",
                          "other bits",
                          "other losses",
                          "instructions",
                          "seconds"}};
  for (std::size_t k = past.size(); k-- > 0;) {
    const PastBaseline& b = past[k];
    const PastBaseline& a = past[k == 0 ? 0 : k - 1];
    const Moved m = moved_between(a, b);
    std::vector<std::optional<double>> instructions, seconds;
    for (const std::string& group : groups) {
      instructions.push_back(instruction_ratio(a, b, group));
      seconds.push_back(time_ratio(a, b, group));
    }
    table.rows.push_back({fmt::format("{}: {} {}",
                                      k + 1,
                                      b.commit.substr(0, 9),
                                      shortened(b.subject, 50)),
                          {{.text = b.date.substr(0, 10)},
                           count_cell(static_cast<double>(b.stages.size())),
                           count_cell(m.added),
                           count_cell(m.gone),
                           count_cell(failed_in(b)),
                           count_cell(m.bits),
                           count_cell(m.losses),
                           ratio_cell(instructions),
                           ratio_cell(seconds)}});
  }
  table.note =
      "Against the baseline before. Failed: stages that failed, were skipped "
      "or diverged. Other losses: a median that moved by more than 1e-6 of "
      "itself, where losses below 1e-12 are equal, or another number of losses "
      "that are finite. Instructions and seconds: geometric means over "
      "what both have, of one counter and one machine.";
  return table;
}

}  // namespace

bool PastBaseline::Stage::failed() const {
  return stop == to_string(Stop::failed) || stop == to_string(Stop::skipped) ||
         stop == to_string(Stop::diverged);
}

PastBaseline past_baseline(std::string_view text) {
  PastBaseline past;
  if (!text.starts_with("physinv-bench baseline "))
    throw std::runtime_error("it is not a baseline");
  bool counts = false;
  for (const std::string_view line : split(text, '\n')) {
    const auto words = split(line, ' ');
    if (words.empty()) continue;
    const std::string_view key = words.front();
    const auto rest = line.substr(std::min(key.size() + 1, line.size()));
    if (key == "machine") past.machine = rest;
    if (key == "instructions" && words.size() > 2) {
      counts = true;
      past.counter = rest.substr(words[1].size() + 1);
    } else if (key.find('/') != key.npos && counts && words.size() == 2) {
      past.instructions[std::string(key)] =
          whole_part<std::uint64_t>(number(words[1]));
    } else if (key.find('/') != key.npos && !counts) {
      add_stage(past, words);
    }
  }
  if (past.stages.empty()) throw std::runtime_error("it has no stages");
  return past;
}

std::vector<Section> history_of(const std::vector<PastBaseline>& past) {
  if (past.size() < 2) return {};
  std::set<std::string> groups;
  for (const PastBaseline& b : past)
    for (const auto& [name, stage] : b.stages) groups.insert(group_of(name));
  Section section{.experiment = "history",
                  .title = "What the gate measured, commit by commit"};
  section.tables.push_back(commits_table(past, groups));
  section.figures = {
      index_figure(past,
                   groups,
                   "losses",
                   "Final losses",
                   "Each commit's median losses over those of the baseline "
                   "before, stage by stage; geometric means, linked. Losses "
                   "below 1e-12 are equal. What is new, gone or failed, or has "
                   "another number of losses that are finite, links nothing.",
                   loss_ratio),
      index_figure(past,
                   groups,
                   "instructions",
                   "Instructions",
                   "The same of the instructions of counted cases; another "
                   "counter links nothing.",
                   instruction_ratio),
      index_figure(past,
                   groups,
                   "seconds",
                   "Seconds of solving",
                   "The same of each stage's fastest run; another machine, and "
                   "what failed or diverged, links nothing.",
                   time_ratio)};
  return {std::move(section)};
}

}  // namespace physinv
