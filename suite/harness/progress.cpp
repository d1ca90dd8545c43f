#include "suite/harness/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "suite/core/clock.h"
#include "suite/core/median.h"
#include "suite/evidence/convergence_history.h"
#include "suite/harness/context.h"
#include "suite/harness/output.h"
#include "suite/harness/run_case.h"
#include "suite/results/solved_loss.h"

namespace physinv {
namespace {

constexpr std::size_t kRecent = 5;

/// Rows of the live table and plain lines have the same columns.
std::string row(std::string_view name,
                std::size_t width,
                std::string_view stage,
                std::string_view status,
                double loss,
                double seconds) {
  const std::string best =
      std::isfinite(loss) ? fmt::format("{:.2e}", loss) : std::string("-");
  return fmt::format("{:<{}}  {:<7} {:<10} {:>11} {:>9}",
                     name,
                     width,
                     stage,
                     status,
                     best,
                     duration_text(seconds));
}

/// Of all examples, those without a finite loss as the highest; NaN of none.
double median_of(const Vector<double>& losses) {
  std::vector<double> all;
  for (const double loss : losses)
    all.push_back(std::isfinite(loss) ? loss : HUGE_VAL);
  return all.empty() ? std::nan("") : median(std::move(all));
}

double seconds_of(const Clocks& c) {
  return c.setup.wall + c.warmup.wall + c.solve.wall + c.measure.wall;
}

}  // namespace

std::string_view end_of(Stop stop, double loss) {
  return stop == Stop::converged && std::isfinite(loss) &&
                 loss > kSolvedByDefault
             ? "stationary"
             : to_string(stop);
}

std::string duration_text(double seconds) {
  constexpr double kCountable = 3600e6;
  if (!std::isfinite(seconds)) return "?";
  if (seconds > kCountable) return fmt::format("{:.1e} h", seconds / 3600);
  if (seconds < 0.0995) return fmt::format("{:.1f} ms", 1e3 * seconds);
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  const auto s = static_cast<long>(std::lround(seconds));
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s / 60 % 60);
}

void Rates::add(const std::string& stage, double operations, double seconds) {
  for (Sum* sum : {&by_stage_[stage], &all_})
    sum->operations += operations, sum->seconds += seconds;
}

double Rates::seconds(const std::string& stage, double operations) const {
  const auto at = by_stage_.find(stage);
  const Sum& sum = at != by_stage_.end() ? at->second : all_;
  if (!(sum.operations > 0)) return -1;
  return operations * sum.seconds / sum.operations;
}

Progress::Progress(const Screen& screen,
                   const std::vector<Case>& cases,
                   int jobs)
    : screen_(screen), cases_(cases), jobs_(jobs), begin_(now().wall) {
  for (const Case& c : cases) {
    done_.emplace_back(c.info.stages.size(), false);
    stages_ += c.info.stages.size();
    operations_ += c.operations();
  }
}

void Progress::reused(std::size_t case_index, Index position) {
  const auto at = static_cast<std::size_t>(position);
  if (done_[case_index][at]) return;
  done_[case_index][at] = true;
  ++stages_done_;
  operations_done_ += cases_[case_index].operations(at);
}

void Progress::started(std::size_t worker,
                       std::size_t case_index,
                       Index position) {
  if (running_.size() <= worker) running_.resize(worker + 1);
  running_[worker] = {.active = true,
                      .case_index = case_index,
                      .position = position,
                      .since = now().wall};
}

void Progress::report(std::size_t worker, Index iteration, double loss) {
  if (running_.size() <= worker) return;
  Running& r = running_[worker];
  r.iteration = iteration;
  if (std::isfinite(loss)) {
    r.loss = r.has_loss ? std::min(r.loss, loss) : loss;
    r.has_loss = true;
  }
}

void Progress::finished(std::size_t worker,
                        std::size_t case_index,
                        const StageRecord& record) {
  const auto at = static_cast<std::size_t>(record.position);
  reused(case_index, record.position);
  const double seconds = seconds_of(record.clocks);
  if (record.stop != Stop::failed && record.stop != Stop::skipped)
    rates_.add(record.stage, cases_[case_index].operations(at), seconds);
  idle(worker);
  const std::string line = finished_row(record, cases_[case_index]);
  if (screen_.live) {
    recent_.push_back(line);
    if (recent_.size() > kRecent) recent_.pop_front();
    if (record.stop == Stop::failed)
      say(record.case_name + ": " + record.message);
    return;
  }
  put_line(line, record);
}

void Progress::put_line(const std::string& row, const StageRecord& record) {
  const std::string total = std::to_string(stages_);
  if (!headed_)
    put(fmt::format(
        "{:<{}} {}\n", "done", 2 * total.size() + 3, head("median loss")));
  headed_ = true;
  put(fmt::format("[{:>{}}/{}] {}{}\n",
                  stages_done_,
                  total.size(),
                  total,
                  row,
                  record.message.empty() || record.stop != Stop::failed
                      ? ""
                      : "  " + record.message));
}

std::string Progress::head(std::string_view loss) const {
  return fmt::format("{:<{}}  {:<7} {:<10} {:>11} {:>9}",
                     "case",
                     name_width(),
                     "stage",
                     "end",
                     loss,
                     "time");
}

void Progress::idle(std::size_t worker) {
  if (worker < running_.size()) running_[worker].active = false;
}

void Progress::say(const std::string& line) {
  clear();
  put(line + "\n");
}

double Progress::remaining() const {
  double sum = 0;
  for (std::size_t i = 0; i < cases_.size(); ++i) {
    for (std::size_t k = 0; k < done_[i].size(); ++k) {
      if (done_[i][k]) continue;
      const double s =
          rates_.seconds(cases_[i].info.stages[k], cases_[i].operations(k));
      if (s < 0) return -1;
      sum += s;
    }
  }
  const double t = now().wall;
  for (const Running& r : running_) {
    if (!r.active) continue;
    const auto at = static_cast<std::size_t>(r.position);
    const Case& c = cases_[r.case_index];
    sum -= std::min(t - r.since,
                    rates_.seconds(c.info.stages[at], c.operations(at)));
  }
  return std::max(0.0, sum) / jobs_;
}

std::size_t Progress::name_width() const {
  std::size_t widest = 20;
  for (const Case& c : cases_) widest = std::max(widest, c.info.name.size());
  if (!screen_.live) return widest;
  const auto fits =
      static_cast<std::size_t>(std::max(20, screen_.columns - 45));
  return std::min(widest, fits);
}

std::string Progress::bar() const {
  const double share =
      operations_ > 0 ? std::clamp(operations_done_ / operations_, 0.0, 1.0)
                      : 1.0;
  const double left = remaining();
  const std::string tail = fmt::format(" {}/{} stages  {}  left {}",
                                       stages_done_,
                                       stages_,
                                       duration_text(now().wall - begin_),
                                       left < 0 ? "?" : duration_text(left));
  const int width =
      std::clamp(screen_.columns - static_cast<int>(tail.size()) - 8, 10, 40);
  const int full = static_cast<int>(std::lround(share * width));
  return fmt::format("[{:#<{}}{:.<{}}] {:3.0f}%{}",
                     "",
                     full,
                     "",
                     width - full,
                     100 * share,
                     tail);
}

std::string Progress::running_row(const Running& r, double t) const {
  const Case& c = cases_[r.case_index];
  const auto at = static_cast<std::size_t>(r.position);
  return row(c.info.name,
             name_width(),
             c.info.stages[at],
             r.iteration > 0 ? fmt::format("it {}", r.iteration) : "running",
             r.has_loss ? r.loss : std::nan(""),
             t - r.since);
}

std::string Progress::finished_row(const StageRecord& record,
                                   const Case& c) const {
  // A diagnosis solves nothing: its loss is that of the start.
  const auto at = static_cast<std::size_t>(record.position);
  const bool solves = c.method == nullptr || at >= c.method->chain.size() ||
                      !is_diagnostic(c.method->chain[at]->options());
  const double loss = solves ? median_of(record.loss) : std::nan("");
  return row(record.case_name,
             name_width(),
             record.stage,
             end_of(record.stop, loss),
             loss,
             seconds_of(record.clocks));
}

void Progress::draw() {
  const double t = now().wall;
  if (!screen_.live || t - drawn_ < 0.1) return;
  drawn_ = t;
  std::vector<std::string> lines = {bar(), head("best loss")};
  for (const Running& r : running_)
    if (r.active && lines.size() < 12) lines.push_back(running_row(r, t));
  const std::size_t first_recent = lines.size();
  lines.insert(lines.end(), recent_.begin(), recent_.end());

  clear();
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string line =
        lines[i].substr(0, static_cast<std::size_t>(screen_.columns - 1));
    const bool dim = screen_.color && i >= first_recent;
    const bool bold = screen_.color && i == 0;
    text += fmt::format("{}{}{}\n",
                        dim    ? "\033[2m"
                        : bold ? "\033[1m"
                               : "",
                        line,
                        dim || bold ? "\033[0m" : "");
  }
  lines_ = static_cast<int>(lines.size());
  put(text);
}

void Progress::clear() {
  if (lines_ > 0) put(fmt::format("\033[{}A\033[J", lines_));
  lines_ = 0;
}

void Progress::put(const std::string& text) const {
  if (screen_.quiet) return;
  physinv::put(screen_.stream, text);
}

}  // namespace physinv
