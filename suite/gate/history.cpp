#include "suite/gate/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <stdexcept>

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

double decimal(std::string_view text) {
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// "NAME results=.. loss=BEST,MEDIAN,WORST ms=FAST..SLOW ..."
void add_stage(PastBaseline& past, const std::vector<std::string_view>& words) {
  PastBaseline::Stage stage;
  for (const std::string_view word : words) {
    if (word.starts_with("results=")) stage.results = word.substr(8);
    if (word.starts_with("loss="))
      if (const auto losses = split(word.substr(5), ','); losses.size() >= 2)
        if (const double loss = decimal(losses[1]); std::isfinite(loss))
          stage.loss = loss;
    if (word.starts_with("stop=")) stage.stop = word.substr(5);
    if (word.starts_with("nonfinite="))
      stage.nonfinite = whole_part<std::int64_t>(decimal(word.substr(10)));
    if (word.starts_with("ms="))
      stage.fastest_ms = decimal(word.substr(3, word.find("..") - 3));
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
double raised(double loss) { return std::max(loss, kSolvedLoss); }

using Ratio = std::function<std::optional<double>(
    const PastBaseline&, const PastBaseline&, const std::string& group)>;

std::string group_of(const std::string& name) {
  return name.substr(0, name.find('/'));
}

std::optional<double> loss_ratio(const PastBaseline& a,
                                 const PastBaseline& b,
                                 const std::string& group) {
  Link link;
  for (const auto& [name, stage] : b.stages)
    if (group_of(name) == group)
      if (const auto at = a.stages.find(name); at != a.stages.end())
        if (losses_compare(at->second, stage))
          link.add(raised(*at->second.loss), raised(*stage.loss));
  return link.ratio();
}

std::optional<double> time_ratio(const PastBaseline& a,
                                 const PastBaseline& b,
                                 const std::string& group) {
  if (a.machine != b.machine) return {};
  Link link;
  for (const auto& [name, stage] : b.stages)
    if (group_of(name) == group)
      if (const auto at = a.stages.find(name); at != a.stages.end())
        if (!at->second.failed() && !stage.failed())
          link.add(at->second.fastest_ms, stage.fastest_ms);
  return link.ratio();
}

std::optional<double> instruction_ratio(const PastBaseline& a,
                                        const PastBaseline& b,
                                        const std::string& group) {
  if (a.counter != b.counter) return {};
  Link link;
  for (const auto& [name, count] : b.instructions)
    if (group_of(name) == group)
      if (const auto at = a.instructions.find(name); at != a.instructions.end())
        link.add(static_cast<double>(at->second), static_cast<double>(count));
  return link.ratio();
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

Moved moved(const PastBaseline& a, const PastBaseline& b) {
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
  double sum = 0, count = 0;
  for (const auto& ratio : all)
    if (ratio) sum += math::log(*ratio), ++count;
  if (count == 0) return {.text = "–"};
  const double mean = math::exp(sum / count);
  return {.ours = mean, .text = fmt::format("×{:.3g}", mean)};
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
    const Moved m = moved(a, b);
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
    throw std::runtime_error("it is no baseline");
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
          whole_part<std::uint64_t>(decimal(words[1]));
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
