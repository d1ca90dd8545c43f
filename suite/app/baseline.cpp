#include "suite/gate/baseline.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "suite/app/gate_flags.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/gate/instructions.h"
#include "suite/gate/measure.h"
#include "suite/harness/build_info.h"
#include "suite/harness/registry.h"
#include "suite/harness/select.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// The folder of a campaign, or a file in it.
std::string campaign_directory(const std::string& text) {
  const fs::path path(text);
  return is_file(path)
             ? (path.has_parent_path() ? path.parent_path().string() : ".")
             : text;
}

/// What the campaign was asked for. A baseline of this program's numbers is
/// not made from those of another.
Chosen chosen_of(const nlohmann::json& plan, const std::string& directory) {
  if (plan.value("fingerprint", "") != build_info().fingerprint)
    throw UsageError(fmt::format(
        "'{}' was run by another build; run it again with this build",
        directory));
  const auto options =
      plan.at("context").value("options", nlohmann::json::object());
  return {.profile = plan.at("profile"),
          .seeds = options.value("seeds", ""),
          .filters = options.value("filter", std::vector<std::string>()),
          .sets = options.value("set", std::vector<std::string>())};
}

/// Only users who have the plug-ins and methods in Python know them.
void check_known(const Results& results) {
  for (const CaseRecord& c : results.cases()) {
    const auto e = registry().find(c.info.experiment);
    if (e == nullptr || find_method(*e, c.info.method) == nullptr)
      throw UsageError(fmt::format(
          "this program does not have {}; write the baseline with the program "
          "that ran it, with the same plug-ins and methods",
          c.info.name));
  }
}

std::vector<CaseRecord> records_of(const Results& results,
                                   const std::vector<Case>& cases) {
  const auto names = names_of(cases);
  auto records = results.cases();
  const auto all = records.size();
  std::erase_if(records,
                [&](const auto& c) { return !names.contains(c.info.name); });
  if (records.size() < all)
    fmt::print(
        "note: {} cases of earlier runs are left out; the last run did not "
        "select them\n",
        all - records.size());
  return records;
}

/// physinv-count knows the profiles as they are declared.
CountTable counts_of(const std::string& regex,
                     const Chosen& chosen,
                     const std::vector<Case>& cases) {
  if (!chosen.sets.empty() || !chosen.seeds.empty())
    throw UsageError("--count needs a campaign without --set and --seeds");
  std::vector<std::string> names;
  for (const Case& c : NameFilter({regex}, "--count").apply(cases))
    names.push_back(c.info.name);
  if (names.empty())
    throw ExitError(
        ExitCode::nothing_matched,
        fmt::format("--count={} matches no case of the campaign", regex));
  std::string why;
  const auto counting = find_counting(counting_program(), &why);
  if (!counting)
    throw EnvironmentError("instructions cannot be counted: " + why);
  return count_instructions(
      *counting, counting_program(), chosen.profile, names);
}

}  // namespace

ExitCode baseline_verb(const Arguments& arguments) {
  std::string given, out, counted;
  int jobs = 0;
  if (!parse(
          "baseline",
          "Writes a baseline from a campaign that was run with --trace: a line "
          "per stage with hashes, end, losses, work and times. Runs its cases "
          "once more with data changed by one ulp to find out which digits are "
          "stable.",
          {{"RESULTS", "directory that 'run' wrote, or a file in it", &given},
           {"--out",
            "baseline file; default: reports/baselines/<profile>.txt",
            &out,
            "FILE"},
           {"--count",
            "count the instructions of the cases whose name matches; only for "
            "profiles without overrides",
            &counted,
            "REGEX"},
           {"-j,--jobs", "worker processes; default: cores", &jobs}},
          arguments))
    return ExitCode::good;
  if (!counted.empty()) NameFilter({counted}, "--count");  // before any run
  const std::string directory = campaign_directory(given);
  const Loaded loaded = load(directory);
  require_complete(loaded.lacks, kRunAgain);

  Baseline b = blank_baseline(chosen_of(loaded.catalog.plan, directory));
  const auto cases = cases_of(b.chosen);
  check_known(loaded.results);
  b.stages = lines_of(records_of(loaded.results, cases));
  measure_digits(
      b.stages,
      cases,
      {.out = directory, .jobs = jobs_or_cores(jobs), .resume = true},
      Screen::of(stdout));
  if (!counted.empty()) b.counts = counts_of(counted, b.chosen, cases);
  if (out.empty()) out = "reports/baselines/" + b.chosen.profile + ".txt";
  const std::string text = to_text(b);
  if (const fs::path folder = fs::path(out).parent_path(); !folder.empty())
    make_directory(folder);
  write_atomically(out, text);
  fmt::print("{} stages, {} bytes: {}\n", b.stages.size(), text.size(), out);
  return ExitCode::good;
}

}  // namespace physinv
