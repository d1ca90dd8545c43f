#include "suite/app/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "reports/report.h"
#include "suite/app/options.h"
#include "suite/app/verbs.h"
#include "suite/gate/history.h"
#include "suite/harness/child.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

constexpr char kBetween = '\x1f';

Ended run_git(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "git");
  return run_child(std::move(arguments), {.seconds = 60, .bytes = 64 << 20});
}

std::string git(std::vector<std::string> arguments) {
  const Ended ended = run_git(std::move(arguments));
  return ended.status == 0 ? ended.output : "";
}

/// Those of a text that are not blank.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) {
    const auto begin = line.find_first_not_of(" \t\r");
    if (begin != line.npos) lines.push_back(line.substr(begin));
  }
  return lines;
}

/// Why git says nothing of this folder: its first line and, where that is
/// advice, its last one.
std::string complaint_of_git() {
  if (!has_program("git")) return "git is not installed";
  const Ended ended = run_git({"rev-parse", "HEAD"});
  if (ended.status == 0) return "";
  const auto lines = lines_of(ended.errors);
  if (lines.empty())
    return fmt::format(
        "git failed with status {} {}", ended.status, ended.exceeded);
  return "git: " + lines.front() +
         (lines.size() > 1 ? " ... " + lines.back() : "");
}

/// Where a shallow clone ends.
std::string end_of_clone() {
  if (!git({"rev-parse", "--is-shallow-repository"}).starts_with("true"))
    return "";
  const auto first = lines_of(
      git({"log", "--max-parents=0", "--date-order", "--format=%h of %cs"}));
  return fmt::format(
      "this clone is shallow and begins with commit {}; 'git fetch "
      "--unshallow' fetches earlier commits",
      first.empty() ? "?" : first.back());
}

/// "commit, date, subject", newest first.
std::vector<std::string> commits_of(const std::string& baseline) {
  return lines_of(git({"log",
                       fmt::format("--format=%H{0}%cI{0}%s", kBetween),
                       "--",
                       baseline}));
}

std::vector<PastBaseline> past_of(const std::string& baseline) {
  std::vector<PastBaseline> past;
  for (const std::string& line : commits_of(baseline)) {
    const auto date = line.find(kBetween), subject = line.rfind(kBetween);
    if (date == subject) continue;
    const std::string commit = line.substr(0, date);
    // "./": seen from here, wherever in the checkout that is.
    const std::string text = git({"show", commit + ":./" + baseline});
    try {
      PastBaseline one = past_baseline(text);
      one.commit = commit;
      one.date = line.substr(date + 1, subject - date - 1);
      one.subject = line.substr(subject + 1);
      past.push_back(std::move(one));
    } catch (const std::runtime_error&) {  // deleted there, or no baseline yet
    }
  }
  std::reverse(past.begin(), past.end());
  return past;
}

}  // namespace

GitHistory history_of_git(const std::string& baseline) {
  if (auto why = complaint_of_git(); !why.empty()) return {{}, std::move(why)};
  GitHistory history{history_of(past_of(baseline)), end_of_clone()};
  if (!history.lacks.empty())
    for (Section& section : history.sections)
      for (Table& table : section.tables)
        table.note += fmt::format(" Incomplete: {}.", history.lacks);
  return history;
}

nlohmann::ordered_json history_origin(const std::string& baseline) {
  return {{"heading", "What the gate measured, commit by commit"},
          {"command", "./bench history --baseline=" + baseline}};
}

ExitCode history_verb(const Arguments& arguments) {
  std::string baseline = kGateBaseline, out = "results/history";
  if (!parse("history",
             "Writes pages of the gate's baseline over the commits in git: "
             "losses, instructions and seconds. Baselines are linked by the "
             "stages that two of them have in common.",
             {{"--baseline",
               fmt::format("baseline file (default {})", kGateBaseline),
               &baseline,
               "FILE"},
              {"--out",
               "output directory (default results/history)",
               &out,
               "DIR"}},
             arguments))
    return ExitCode::good;
  if (fs::path(baseline).is_absolute())
    throw UsageError(fmt::format(
        "--baseline={} is absolute; expected a path relative to the repository",
        baseline));
  const GitHistory history = history_of_git(baseline);
  if (history.sections.empty())
    throw ExitError(ExitCode::nothing_matched,
                    fmt::format("git has fewer than two versions of '{}' here; "
                                "run in a checkout with its history{}{}",
                                baseline,
                                history.lacks.empty() ? "" : "; ",
                                history.lacks));
  write_report(out, history.sections, history_origin(baseline));
  if (!history.lacks.empty()) fmt::print("note: {}\n", history.lacks);
  fmt::print("history: {}\n", (fs::path(out) / "index.html").string());
  return ExitCode::good;
}

}  // namespace physinv
