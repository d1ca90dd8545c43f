#include "suite/gate/gate_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "suite/harness/output.h"
#include "suite/results/markdown.h"

namespace physinv {
namespace {

constexpr std::size_t kAnnotations = 10;  // GitHub shows so many of a step
constexpr std::size_t kMarkdownRows = 200;

bool quiet(const Finding& f) {
  return f.code == ExitCode::good &&
         (f.verdict == "same" || f.verdict == "within" ||
          (f.kind != "clock" && f.verdict == "equal"));
}

/// Failures first.
std::vector<const Finding*> loud(const GateReport& report) {
  std::vector<const Finding*> all;
  for (const auto& f : report.findings)
    if (!quiet(f)) all.push_back(&f);
  std::stable_sort(all.begin(), all.end(), [](auto* a, auto* b) {
    return (a->code != ExitCode::good) > (b->code != ExitCode::good);
  });
  return all;
}

/// Of a workflow command: '%' and ends of lines are its own.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '%'    ? std::string("%25")
           : c == '\n' ? std::string("%0A")
           : c == '\r' ? std::string("%0D")
                       : std::string(1, c);
  return out;
}

nlohmann::json number(double v) {
  return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(nullptr);
}

nlohmann::json numbers_of(const StageLine& line) {
  if (line.name.empty()) return nullptr;
  nlohmann::json work;
  for (std::size_t i = 0; i < kWork.size(); ++i)
    work[std::string(kWork[i])] = line.work[i];
  return {{"trajectory", line.trajectory},
          {"stop", to_string(line.stop)},
          {"loss_best", number(line.losses.best)},
          {"loss_median", number(line.losses.median)},
          {"loss_worst", number(line.losses.worst)},
          {"losses_not_finite", line.losses.nonfinite},
          {"work", std::move(work)},
          {"ms", number(line.fastest)}};
}

std::string loss_text(const Distance& d) {
  return fmt::format("{:.1e} in the {} loss", d.loss, d.which);
}

std::string text_of(const Distance& d) {
  std::string text;
  if (d.x.value_or(0) > 0) text = fmt::format("{:.1e} in x", *d.x);
  if (d.loss > 0) text += (text.empty() ? "" : ", ") + loss_text(d);
  return text.empty() ? fmt::format("{}losses agree to the recorded digits",
                                    d.x ? "x and " : "")
                      : "relative change " + text;
}

/// The finding that is farthest from the baseline in this; null if none is.
template <class F>
const Finding* farthest(const GateReport& report, F&& size) {
  const Finding* most = nullptr;
  for (const auto& f : report.findings)
    if (f.distance && size(*f.distance) > 0 &&
        (most == nullptr || size(*f.distance) > size(*most->distance)))
      most = &f;
  return most;
}

nlohmann::json to_json(const std::optional<Distance>& d) {
  if (!d) return nullptr;
  return {{"x", d->x ? nlohmann::json(*d->x) : nlohmann::json(nullptr)},
          {"loss", d->loss},
          {"of_loss", d->which}};
}

}  // namespace

Finding finding_of(const StageVerdict& j) {
  std::string detail = j.reasons.text();
  if (j.distance) detail += (detail.empty() ? "" : "; ") + text_of(*j.distance);
  return {.kind = "accuracy",
          .name = j.stage,
          .verdict = std::string(to_string(j.change)),
          .detail = std::move(detail),
          .code = fails(j) ? ExitCode::accuracy : ExitCode::good,
          .numbers = {{"digits", j.before.digits},
                      {"before", numbers_of(j.before)},
                      {"now", numbers_of(j.now)}},
          .reasons = j.reasons,
          .distance = j.distance};
}

ExitCode GateReport::code() const {
  ExitCode gravest = ExitCode::good;
  for (const auto& f : findings)
    if (f.code != ExitCode::good &&
        (gravest == ExitCode::good || f.code < gravest))
      gravest = f.code;
  return gravest;
}

std::string summary_text(const GateReport& report) {
  std::vector<std::pair<std::string, std::map<std::string, int>>> kinds;
  for (const auto& f : report.findings) {
    if (kinds.empty() || kinds.back().first != f.kind)
      kinds.emplace_back(f.kind, std::map<std::string, int>());
    ++kinds.back().second[f.verdict];
  }
  std::string text;
  for (const auto& [kind, verdicts] : kinds) {
    std::string counts;
    for (const auto& [verdict, count] : verdicts)
      counts +=
          fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, verdict);
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", kind, counts);
  }
  return text;
}

std::string undecided_text(const GateReport& report) {
  std::size_t asked = 0, decided = 0;
  for (const auto& f : report.findings) {
    if (f.kind != "clock") continue;
    ++asked;
    decided += f.verdict != "inconclusive" && f.verdict != "not timed";
  }
  if (asked == 0 || decided > 0) return "";
  return fmt::format(
      "the timing comparison decided 0 of {} cases; use fewer cases "
      "(--filter), more seconds (--budget) or a wider --within",
      asked);
}

std::string largest_text(const GateReport& report) {
  const auto* x =
      farthest(report, [](const Distance& d) { return d.x.value_or(0); });
  const auto* loss = farthest(report, [](const Distance& d) { return d.loss; });
  std::string text;
  if (x != nullptr)
    text = fmt::format("{:.1e} in x of {}", *x->distance->x, x->name);
  if (loss != nullptr)
    text += fmt::format("{}{} of {}",
                        text.empty() ? "" : ", ",
                        loss_text(*loss->distance),
                        loss->name);
  return text.empty() ? "" : "largest relative change " + text;
}

std::string terminal_text(const GateReport& report) {
  std::string text;
  for (const auto& note : report.notes) text += "note: " + note + '\n';
  const auto shown = loud(report);
  std::size_t width = 4;
  for (const auto* f : shown) width = std::max(width, f->name.size());
  if (!shown.empty())
    text += fmt::format("{:<12}  {:<{}}  {:<12}  {}\n",
                        "check",
                        "name",
                        width,
                        "verdict",
                        "why");
  for (const auto* f : shown)
    text += fmt::format("{:<12}  {:<{}}  {:<12}  {}\n",
                        f->kind,
                        one_line(f->name),
                        width,
                        f->verdict,
                        one_line(f->detail));
  if (const auto largest = largest_text(report); !largest.empty())
    text += one_line(largest) + '\n';
  if (const auto undecided = undecided_text(report); !undecided.empty())
    text += "warning: " + undecided + '\n';
  return text + summary_text(report) + '\n';
}

std::string markdown_text(const GateReport& report) {
  const bool good = report.code() == ExitCode::good;
  const std::string undecided = undecided_text(report);
  std::string text = fmt::format("### physinv-bench gate: {}{}\n\n{}\n\n",
                                 good ? "passed" : "failed",
                                 undecided.empty() ? "" : ", timing undecided",
                                 summary_text(report));
  for (const auto& line : {undecided, largest_text(report)})
    if (!line.empty()) text += "- " + markdown(line) + '\n';
  for (const auto& note : report.notes) text += "- " + markdown(note) + '\n';
  const auto shown = loud(report);
  if (!shown.empty())
    text += "\n| check | name | verdict | why |\n| --- | --- | --- | --- |\n";
  for (std::size_t i = 0; i < std::min(shown.size(), kMarkdownRows); ++i)
    text += fmt::format("| {} | {} | {} | {} |\n",
                        shown[i]->kind,
                        markdown(shown[i]->name),
                        shown[i]->verdict,
                        markdown(shown[i]->detail));
  if (shown.size() > kMarkdownRows)
    text += fmt::format("\nand {} more\n", shown.size() - kMarkdownRows);
  return text + '\n';
}

std::string annotations(const GateReport& report) {
  std::string text;
  if (const auto undecided = undecided_text(report); !undecided.empty())
    text += fmt::format("::warning title=clock undecided::{}\n",
                        escaped(undecided));
  std::size_t left = kAnnotations;
  for (const auto* f : loud(report)) {
    if (f->code == ExitCode::good || left-- == 0) break;
    text += fmt::format("::error title={} {}::{}: {}\n",
                        f->kind,
                        f->verdict,
                        escaped(f->name),
                        escaped(f->detail));
  }
  return text;
}

nlohmann::json to_json(const GateReport& report) {
  nlohmann::json findings = nlohmann::json::array();
  for (const auto& f : report.findings)
    findings.push_back({{"check", f.kind},
                        {"name", f.name},
                        {"verdict", f.verdict},
                        {"why", f.detail},
                        {"worse", f.reasons.worse},
                        {"better", f.reasons.better},
                        {"other", f.reasons.other},
                        {"relative_change", to_json(f.distance)},
                        {"exit_code", static_cast<int>(f.code)},
                        {"numbers", f.numbers}});
  return {{"schema_version", 1},
          {"exit_code", static_cast<int>(report.code())},
          {"notes", report.notes},
          {"warning", undecided_text(report)},
          {"largest_change", largest_text(report)},
          {"findings", std::move(findings)}};
}

}  // namespace physinv
