#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "reports/latest_claims.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/app/published_campaign.h"
#include "suite/app/sections.h"
#include "suite/harness/columns.h"
#include "suite/harness/progress.h"
#include "suite/harness/registry.h"
#include "suite/harness/select.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

struct ReproduceFlags {
  std::vector<std::string> names;
  std::string paper, campaigns = "reports/campaigns", out = "results/reproduce";
  int jobs = 0;
  bool dry = false;
};

/// A published campaign as it is run again.
struct Again {
  std::string name;
  /// Names of cases by the profile that they were run for.
  std::map<std::string, std::vector<std::string>> cases;
  std::vector<std::string> sets;  ///< --set of the campaign
  std::string seeds;              ///< of all cases: "0,1,2"
  double cpu_seconds = 0;         ///< of solving, when it was published
  std::size_t unknown = 0;        ///< cases that are not registered now
  std::vector<ClaimKey> decides;  ///< what it decides of all campaigns

  std::size_t size() const {  ///< cases
    std::size_t all = 0;
    for (const auto& [profile, names] : cases) all += names.size();
    return all;
  }
};

std::string paper_of(const std::string& experiment) {
  const auto e = registry().find(experiment);
  return e ? e->citation.paper : "";
}

/// Leaves out cases that no profile has by now.
void drop_unknown(Again& again) {
  for (auto& [profile, names] : again.cases) {
    std::set<std::string> known;
    for (const Case& c :
         registry().expand(profile, parse_overrides(again.sets, again.seeds)))
      known.insert(c.info.name);
    again.unknown += std::erase_if(
        names, [&](const std::string& name) { return !known.contains(name); });
  }
  std::erase_if(again.cases, [](const auto& of) { return of.second.empty(); });
}

/// What results.json.gz of the campaign says was run, of one paper or of all.
Again again_of(const NamedDigest& campaign,
               const fs::path& folder,
               const std::string& paper) {
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
    if (!paper.empty() && paper_of(c.info.experiment) != paper) continue;
    const std::string& own = c.info.profile;
    again.cases[own.empty() ? provenance.value("profile", "") : own].push_back(
        c.info.name);
    seeds.insert(c.info.seed);
    for (const StageRecord& s : c.stages)
      if (has_time(s)) again.cpu_seconds += s.clocks.solve.cpu;
  }
  again.seeds = fmt::format("{}", fmt::join(seeds, ","));
  drop_unknown(again);
  return again;
}

/// Those of `campaigns` below `folder` that decide a claim (`latest` is what
/// all of them come to) of this paper, with the paper's cases alone, or,
/// without a paper, all of them; the cheapest first.
std::vector<Again> to_run_again(const std::vector<NamedDigest>& campaigns,
                                const Papers& latest,
                                const fs::path& folder,
                                const std::string& paper) {
  std::map<std::string, std::vector<ClaimKey>> decides;
  for (const auto& [key, claims] : latest)
    if (paper.empty() || key == paper)
      for (const auto& [claim, found] : claims)
        if (found.claim.verdict != Verdict::not_judged)
          decides[found.campaign].push_back(claim);
  std::vector<Again> all;
  for (const NamedDigest& c : campaigns) {
    if (!paper.empty() && !decides.contains(c.name)) continue;
    Again again = again_of(c, folder / c.name, paper);
    again.decides = decides[c.name];
    all.push_back(std::move(again));
  }
  std::stable_sort(all.begin(), all.end(), [](const Again& a, const Again& b) {
    return a.cpu_seconds < b.cpu_seconds;
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
  Columns table({"<campaign", "cases", "CPU time", "<decides"});
  double seconds = 0;
  std::size_t cases = 0, unknown = 0;
  for (const Again& a : all) {
    table.add({a.name,
               std::to_string(a.size()),
               duration_text(a.cpu_seconds),
               text_of(a.decides)});
    seconds += a.cpu_seconds, cases += a.size(), unknown += a.unknown;
  }
  std::string text = table.text(Screen::of(stdout).room());
  text += fmt::format("{} campaigns, {} cases, {} of CPU when published\n",
                      all.size(),
                      cases,
                      duration_text(seconds));
  if (unknown > 0)
    text +=
        fmt::format("{} of these cases are no longer registered\n", unknown);
  return text;
}

/// What a run ended with, if the next one can go on.
std::optional<std::string> trouble_of_run(const Arguments& arguments) {
  try {
    run_verb(arguments);
    return {};
  } catch (const ExitError& error) {
    if (error.code() != ExitCode::case_failed) throw;
    return error.what();
  }
}

/// Into OUT/NAME; what was wrong.
std::vector<std::string> run_again(const Again& again,
                                   const ReproduceFlags& flags,
                                   const std::string& store) {
  std::vector<std::string> troubles;
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
    if (auto t = trouble_of_run(arguments)) troubles.push_back(*t);
  }
  return troubles;
}

void publish(const std::string& store, const fs::path& folder) {
  const Loaded loaded = load(store);
  const Published numbers = printed_numbers();
  const auto sections = sections_of(loaded.results, numbers);
  publish_campaign(
      folder, loaded, sections, provenance(loaded, sections, numbers));
}

/// Of the claims that these campaigns decide, those that come to another
/// verdict than the published one; how many.
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
  std::vector<std::string> troubles;
  const std::string kept = flags.out + "/campaigns";
  for (const Again& again : all) {
    if (again.cases.empty()) continue;  // none is registered any more
    const std::string store = flags.out + '/' + again.name;
    for (const std::string& t : run_again(again, flags, store))
      troubles.push_back(again.name + ": " + t);
    publish(store, fs::path(kept) / again.name);
  }
  results_verb({"--campaigns=" + kept, "--out=" + flags.out + "/RESULTS.md"});
  const std::size_t changed =
      show_changes(all, latest, latest_claims(published_digests(kept)));
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
