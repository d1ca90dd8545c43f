#include "suite/app/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "reports/report.h"
#include "suite/app/options.h"
#include "suite/app/verbs.h"
#include "suite/gate/history.h"
#include "suite/harness/child.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

constexpr char kBetween = '\x1f';

std::string git(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "git");
  const Ended ended =
      run_child(std::move(arguments), {.seconds = 60, .bytes = 64 << 20});
  return ended.status == 0 ? ended.output : "";
}

/// "commit, date, subject", newest first.
std::vector<std::string> commits_of(const std::string& baseline) {
  std::vector<std::string> lines;
  std::string text = git(
      {"log", fmt::format("--format=%H{0}%cI{0}%s", kBetween), "--", baseline});
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
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

std::vector<Section> history_sections(const std::string& baseline) {
  if (!has_program("git")) return {};
  return history_of(past_of(baseline));
}

nlohmann::ordered_json history_origin(const std::string& baseline) {
  return {{"heading", "What the gate measured, commit by commit"},
          {"command", "./bench history --baseline=" + baseline}};
}

ExitCode history_verb(const Arguments& arguments) {
  std::string baseline = kGateBaseline, out = "results/history";
  if (!parse("history",
             "Pages of what the gate's baseline said, commit by commit: "
             "losses, instructions and seconds, linked over what two "
             "baselines have in common. Made from git.",
             {{"--baseline",
               fmt::format("which (default {})", kGateBaseline),
               &baseline,
               "FILE"},
              {"--out", "where to (default results/history)", &out, "DIR"}},
             arguments))
    return ExitCode::good;
  if (fs::path(baseline).is_absolute())
    throw UsageError(fmt::format(
        "--baseline={} is absolute; a path below this folder, as git has it, "
        "is expected",
        baseline));
  const auto sections = history_sections(baseline);
  if (sections.empty())
    throw ExitError(ExitCode::nothing_matched,
                    fmt::format("git has no two versions of '{}' here; run in "
                                "a checkout with its history",
                                baseline));
  write_report(out, sections, history_origin(baseline));
  fmt::print("history: {}\n", (fs::path(out) / "index.html").string());
  return ExitCode::good;
}

}  // namespace physinv
