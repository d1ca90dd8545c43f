#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "reports/latest_claims.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/app/published_campaign.h"
#include "suite/app/sections.h"
#include "suite/core/clock.h"
#include "suite/harness/columns.h"
#include "suite/harness/keys.h"
#include "suite/harness/progress.h"
#include "suite/harness/registry.h"
#include "suite/harness/select.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

constexpr double kNever = std::numeric_limits<double>::infinity();

struct ReproduceFlags {
  std::vector<std::string> names;
  std::string paper, campaigns = "reports/campaigns", out = "results/reproduce";
  std::string budget;  ///< of all campaigns
  int jobs = 0;
  bool share_cores = false, dry = false;
};

/// A published campaign as it is run again.
struct Again {
  std::string name;
  /// Names of cases by the profile that they were run for.
  std::map<std::string, std::vector<std::string>> cases;
  std::vector<std::string> sets;          ///< --set of the campaign
  std::string seeds;                      ///< of all cases: "0,1,2"
  double cpu_seconds = 0;                 ///< of solving, when it was published
  std::size_t unknown = 0;                ///< cases that are not registered now
  std::size_t of_plugins = 0;             ///< cases of experiments that are not
  std::size_t stages = 0, same_keys = 0;  ///< stored; of today's sources
  std::vector<ClaimKey> decides;          ///< what it decides of all campaigns

  std::size_t size() const {  ///< cases
    std::size_t all = 0;
    for (const auto& [profile, names] : cases) all += names.size();
    return all;
  }
};

bool is_registered(const std::string& of) {
  return registry().find(of) != nullptr ||
         std::ranges::any_of(registry().overviews(),
                             [&](const Overview& o) { return o.paper == of; });
}

std::string paper_of(const std::string& experiment) {
  const auto e = registry().find(experiment);
  return e ? e->citation.paper : "";
}

using CasesByName = std::map<std::string, Case>;

CasesByName registered_cases(const Again& again, const std::string& profile) {
  CasesByName cases;
  for (Case& c :
       registry().expand(profile, parse_overrides(again.sets, again.seeds))) {
    std::string name = c.info.name;
    cases.emplace(std::move(name), std::move(c));
  }
  return cases;
}

/// Counts the stages that a run of this program would store under the same key.
void count_keys(const CaseRecord& stored,
                const Case& today,
                const Numerics& numerics,
                Again& again) {
  const auto keys = content_keys(today, stored.data.hash, numerics);
  for (const StageRecord& s : stored.stages) {
    const auto position = static_cast<std::size_t>(s.position);
    if (position < keys.size() && keys[position] == s.key) ++again.same_keys;
  }
}

/// Leaves out cases that no profile has any more, and counts keys of the
/// others.
void match_with_registered(const Results& results,
                           const Numerics& numerics,
                           Again& again) {
  std::map<std::string_view, const CaseRecord*> stored;
  for (const CaseRecord& c : results.cases()) stored[c.info.name] = &c;
  for (auto& [profile, names] : again.cases) {
    const CasesByName registered = registered_cases(again, profile);
    again.unknown += std::erase_if(names, [&](const std::string& name) {
      return !registered.contains(name);
    });
    for (const std::string& name : names)
      count_keys(*stored.at(name), registered.at(name), numerics, again);
  }
  std::erase_if(again.cases, [](const auto& of) { return of.second.empty(); });
}

/// What results.json.gz of the campaign says was run, of one paper or of all.
Again again_of(const NamedDigest& campaign,
               const fs::path& folder,
               const std::string& paper,
               const Numerics& numerics) {
  const auto& provenance = campaign.digest.at("provenance");
  Again again{.name = campaign.name, .cases = {}, .sets = {}, .seeds = {}};
  if (const auto options = provenance.find("options");
      options != provenance.end())
    for (const auto& value :
         options->value("set", nlohmann::ordered_json::array()))
      if (!value.get<std::string>().starts_with("seeds="))
        again.sets.push_back(value);
  std::set<std::uint64_t> seeds;
  const Results results = published_results(folder);
  for (const CaseRecord& c : results.cases()) {
    if (!is_registered(c.info.experiment)) {
      ++again.of_plugins;
      continue;
    }
    if (!paper.empty() && paper_of(c.info.experiment) != paper) continue;
    const std::string& own = c.info.profile;
    again.cases[own.empty() ? provenance.value("profile", "") : own].push_back(
        c.info.name);
    seeds.insert(c.info.seed);
    again.stages += c.stages.size();
    for (const StageRecord& s : c.stages)
      if (has_time(s)) again.cpu_seconds += s.clocks.solve.cpu;
  }
  again.seeds = fmt::format("{}", fmt::join(seeds, ","));
  match_with_registered(results, numerics, again);
  return again;
}

/// Those of `campaigns` below `folder` that decide a claim of this paper
/// (`latest` are the verdicts of all campaigns), with the paper's cases alone,
/// or, without a paper, all of them; the longest first.
std::vector<Again> to_run_again(const std::vector<NamedDigest>& campaigns,
                                const Papers& latest,
                                const fs::path& folder,
                                const std::string& paper) {
  std::map<std::string, std::vector<ClaimKey>> decides;
  for (const auto& [key, claims] : latest)
    if (paper.empty() || key == paper)
      for (const auto& [claim, found] : claims)
        if (found.claim.verdict != Verdict::not_judged &&
            is_registered(claim.first))
          decides[found.campaign].push_back(claim);
  const Numerics numerics = remembered_numerics();
  std::vector<Again> all;
  for (const NamedDigest& c : campaigns) {
    if (!paper.empty() && !decides.contains(c.name)) continue;
    Again again = again_of(c, folder / c.name, paper, numerics);
    again.decides = decides[c.name];
    all.push_back(std::move(again));
  }
  std::stable_sort(all.begin(), all.end(), [](const Again& a, const Again& b) {
    return a.cpu_seconds > b.cpu_seconds;
  });
  return all;
}

std::string keys_of(const Papers& papers) {
  std::vector<std::string> keys;
  for (const auto& [key, claims] : papers)
    if (!key.empty()) keys.push_back(key);
  return fmt::format("{}", fmt::join(keys, ", "));
}

/// "jpo P2 P6, jpo/billiards P1": each experiment once.
std::string text_of(const std::vector<ClaimKey>& claims) {
  std::string text, experiment;
  for (const auto& [of, id] : claims) {
    if (of != experiment)
      text += (text.empty() ? "" : ", ") + (experiment = of);
    text += ' ' + id;
  }
  return text;
}

std::string plan_text(const std::vector<Again>& all) {
  Columns table({"<campaign", "cases", "CPU time", "same key", "<decides"});
  double seconds = 0;
  std::size_t cases = 0, unknown = 0, of_plugins = 0;
  for (const Again& a : all) {
    table.add({a.name,
               std::to_string(a.size()),
               duration_text(a.cpu_seconds),
               fmt::format("{}/{}", a.same_keys, a.stages),
               text_of(a.decides)});
    seconds += a.cpu_seconds, cases += a.size(), unknown += a.unknown;
    of_plugins += a.of_plugins;
  }
  std::string text = table.text(Screen::of(stdout).room());
  text += fmt::format("{} campaigns, {} cases, {} of CPU when published\n",
                      all.size(),
                      cases,
                      duration_text(seconds));
  if (unknown > 0)
    text +=
        fmt::format("{} of these cases are no longer registered\n", unknown);
  if (of_plugins > 0)
    text += fmt::format(
        "{} more cases are of experiments that this program lacks; load their "
        "plug-in with --plugin=FILE\n",
        of_plugins);
  return text;
}

/// What the runs of a campaign ended with.
struct RunEnding {
  std::vector<std::string> troubles;
  bool complete = true;  ///< every case was run
};

void run(const Arguments& arguments, RunEnding& ended) {
  try {
    run_verb(arguments);
  } catch (const ExitError& error) {
    if (error.code() == ExitCode::incomplete)
      ended.complete = false;
    else if (error.code() != ExitCode::case_failed)
      throw;
    ended.troubles.push_back(error.what());
  }
}

/// Into `store`; until the time `until` [s].
RunEnding run_again(const Again& again,
                    const ReproduceFlags& flags,
                    const std::string& store,
                    double until) {
  RunEnding ended;
  for (const auto& [profile, names] : again.cases) {
    Arguments arguments{"--profile=" + profile,
                        "--seeds=" + again.seeds,
                        "--out=" + store,
                        "--no-report"};
    for (const std::string& name : names)
      arguments.push_back("--filter=" + exactly(name));
    for (const std::string& set : again.sets)
      arguments.push_back("--set=" + set);
    if (flags.jobs > 0)
      arguments.push_back(fmt::format("--jobs={}", flags.jobs));
    if (flags.share_cores) arguments.push_back("--share-cores");
    if (until < kNever)
      arguments.push_back(fmt::format("--time-budget={:.3f}s",
                                      std::max(1e-3, until - now().wall)));
    run(arguments, ended);
  }
  return ended;
}

void publish(const std::string& store, const fs::path& folder) {
  const Loaded loaded = load(store);
  const Published numbers = printed_numbers();
  const auto sections = sections_of(loaded.results, numbers);
  publish_campaign(
      folder, loaded, sections, provenance(loaded, sections, numbers));
}

/// Of the claims that these campaigns decide, those whose verdict differs from
/// the published one; how many.
std::size_t show_changes(const std::vector<Again>& all,
                         const Papers& published,
                         const Papers& here) {
  std::set<ClaimKey> decided;
  for (const Again& a : all) decided.insert(a.decides.begin(), a.decides.end());
  auto changed = new_verdicts(published, here);
  std::erase_if(changed,
                [&](const NewVerdict& c) { return !decided.contains(c.key); });
  Columns table({"<claim", "<published", "<here", "<says"});
  for (const NewVerdict& c : changed)
    table.add({text_of({c.key}),
               std::string(words_of(c.then)),
               std::string(words_of(c.now)),
               c.says});
  if (!changed.empty()) fmt::print("{}", table.text(Screen::of(stdout).room()));
  fmt::print("{} of {} claims have the published verdict\n",
             decided.size() - changed.size(),
             decided.size());
  return changed.size();
}

struct Reproduced {
  std::vector<Again> complete;
  std::vector<std::string> troubles;
};

/// Runs all within `budget` [s] and publishes into `kept` those of which every
/// case was run.
Reproduced reproduce_all(const std::vector<Again>& all,
                         const ReproduceFlags& flags,
                         const fs::path& kept,
                         double budget) {
  Reproduced result;
  const double until = now().wall + budget;
  for (const Again& again : all) {
    if (again.cases.empty()) continue;  // none is registered any more
    if (now().wall >= until) {
      result.troubles.push_back(again.name +
                                ": not begun within the time budget");
      continue;
    }
    const std::string store = flags.out + '/' + again.name;
    const RunEnding ended = run_again(again, flags, store, until);
    for (const std::string& t : ended.troubles)
      result.troubles.push_back(again.name + ": " + t);
    if (!ended.complete) continue;
    publish(store, kept / again.name);
    result.complete.push_back(again);
  }
  return result;
}

/// False if help was asked for.
bool parse_flags(const Arguments& arguments, ReproduceFlags& flags) {
  return parse(
      "reproduce",
      "Runs the cases of published campaigns again and writes the same pages "
      "from the results: the named campaigns, or all that decide a claim of a "
      "paper. Finished stages are reused. Exit 7 if a verdict changed, 10 if "
      "something did not run.",
      {{.name = "CAMPAIGN",
        .help = "name from RESULTS.md, such as 41-paper-jpo-billiards",
        .to = &flags.names,
        .optional = true},
       {"--paper", "jpo, hig, sip or physgrad", &flags.paper, "KEY"},
       {"--campaigns",
        "folder of published campaigns (default reports/campaigns)",
        &flags.campaigns,
        "DIR"},
       {"--out",
        "output directory (default results/reproduce)",
        &flags.out,
        "DIR"},
       {"-j,--jobs", "worker processes; default: cores", &flags.jobs},
       {"--share-cores",
        "give free cores to running cases, as in run",
        &flags.share_cores},
       {"--time-budget",
        "wall time of all campaigns, such as 2h: the longest run first; what "
        "is left runs when the command is repeated",
        &flags.budget,
        "TIME"},
       {"--dry-run", "print what would run and the time it took", &flags.dry}},
      arguments);
}

}  // namespace

ExitCode reproduce_verb(const Arguments& arguments) {
  ReproduceFlags flags;
  if (!parse_flags(arguments, flags)) return ExitCode::good;
  if (flags.names.empty() == flags.paper.empty())
    throw UsageError(
        "give either published campaigns or a paper (--paper=KEY)");
  const double budget = flags.budget.empty()
                            ? kNever
                            : parse_duration("--time-budget", flags.budget);
  const auto campaigns = published_digests(flags.campaigns, flags.names);
  const Papers latest = latest_claims(campaigns);
  const auto all =
      to_run_again(campaigns, latest, flags.campaigns, flags.paper);
  if (all.empty())
    throw ExitError(
        ExitCode::nothing_matched,
        fmt::format(
            "no campaign in {} decides a claim of '{}'; known papers: {}",
            flags.campaigns,
            flags.paper,
            keys_of(latest)));
  fmt::print("{}", plan_text(all));
  if (flags.dry) return ExitCode::good;
  const std::string kept = flags.out + "/campaigns";
  const auto [complete, troubles] = reproduce_all(all, flags, kept, budget);
  std::size_t changed = 0;
  if (!complete.empty()) {
    results_verb({"--campaigns=" + kept, "--out=" + flags.out + "/RESULTS.md"});
    changed =
        show_changes(complete, latest, latest_claims(published_digests(kept)));
  }
  if (!troubles.empty())
    throw ExitError(ExitCode::incomplete,
                    fmt::format("{} campaigns are incomplete, first {}",
                                troubles.size(),
                                troubles.front()));
  if (changed > 0)
    throw ExitError(
        ExitCode::claim,
        fmt::format("{} claims have another verdict than published", changed));
  return ExitCode::good;
}

}  // namespace physinv
