#include "suite/store/merge.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "suite/store/results_file.h"
#include "suite/store/store.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

using Origins = std::map<std::pair<std::string, Index>, fs::path>;

std::vector<Catalog> read_shards(const std::vector<fs::path>& paths) {
  std::vector<Catalog> shards;
  for (const auto& path : paths) {
    shards.push_back(Catalog::read(path));
    if (!shards.back().plan.is_object())
      throw UnreadableInput(fmt::format(
          "{}: its plan.json is missing, so its campaign is unknown (run the "
          "campaign there again: finished stages are reused)",
          path.string()));
  }
  if (shards.empty())
    throw UnreadableInput("nothing to merge: give the directories of shards");
  return shards;
}

[[noreturn]] void refuse(const Catalog& a,
                         const Catalog& b,
                         std::string_view why,
                         std::string_view right) {
  throw UnreadableInput(fmt::format("{} and {} cannot be merged: {} ({})",
                                    a.directory().string(),
                                    b.directory().string(),
                                    why,
                                    right));
}

/// The first case for which both plans have an entry of `what`, but another.
std::string differing_case(const json& a, const json& b, const char* what) {
  const json none = json::object();
  const json of_a = a.value(what, none), of_b = b.value(what, none);
  for (const auto& [name, value] : of_a.items())
    if (of_b.contains(name) && of_b[name] != value) return name;
  return "";
}

/// Plans of version 1 say with which flags they ran, nothing more.
json set_flags(const Catalog& c) {
  return c.plan.at("context").value("/options/set"_json_pointer, json());
}

void check_same_campaign(const Catalog& a, const Catalog& b) {
  for (const char* what : {"profile", "fingerprint", "cases"}) {
    const json of_a = a.plan.at(what), of_b = b.plan.at(what);
    // A shard without cases has no profile.
    if (of_a == of_b || of_a == "" || of_b == "") continue;
    refuse(
        a,
        b,
        fmt::format("they differ in {}{}",
                    what,
                    of_a.is_array()
                        ? ""
                        : fmt::format(", {} and {}", of_a.dump(), of_b.dump())),
        "merge shards of one campaign, run by one build");
  }
  const bool old = !a.plan.contains("recipes") || !b.plan.contains("recipes");
  for (const char* what : {"recipes", "keys"}) {
    const auto name = differing_case(a.plan, b.plan, what);
    if (!name.empty())
      refuse(a,
             b,
             fmt::format("they ran {} with different {}",
                         name,
                         std::string_view(what) == "keys" ? "data or numerics"
                                                          : "options"),
             "run all shards with the same flags but --shard and --out");
  }
  if (old && set_flags(a) != set_flags(b))
    refuse(a,
           b,
           fmt::format("they ran with --set={} and {}",
                       set_flags(a).dump(),
                       set_flags(b).dump()),
           "run all shards with the same flags but --shard and --out");
}

/// Somebody forgot OUT, or it is a campaign that merging would overwrite.
void check_out(const std::vector<fs::path>& shards, const fs::path& out) {
  std::error_code error;
  for (const auto& shard : shards)
    if (fs::equivalent(shard, out, error))
      throw UnreadableInput(
          fmt::format("{} is both OUT and a shard (first give a separate "
                      "directory for OUT, then the shards)",
                      out.string()));
  if (!Store::exists(out)) return;
  const Catalog there = Catalog::read(out);
  if (there.entries().empty() ||
      (there.plan.is_object() && there.plan.value("merged", false)))
    return;
  throw UnreadableInput(
      fmt::format("{} contains another campaign, so it cannot be OUT (first "
                  "give another directory for OUT, then the shards)",
                  out.string()));
}

json merged_plan(const std::vector<Catalog>& shards) {
  json plan = shards.front().plan;
  for (const auto& shard : shards) {
    for (const char* what : {"recipes", "keys", "stages"})
      plan[what].update(shard.plan.value(what, json::object()));
    for (const char* what : {"profile", "fingerprint"})
      if (plan[what] == "") plan[what] = shard.plan.at(what);
  }
  plan["merged"] = true;
  return plan;
}

bool same(const StageRecord& a, const StageRecord& b) {
  return a.key == b.key && a.stop == b.stop && a.iterations == b.iterations &&
         a.counts == b.counts && results_hash(a) == results_hash(b) &&
         (a.trajectory == b.trajectory || a.trajectory.empty() ||
          b.trajectory.empty());
}

void merge_case(Store& store,
                const Catalog& shard,
                const std::string& name,
                Origins& origins,
                std::vector<std::string>& warnings) {
  const CaseRecord c = shard.case_record(name);
  MissingWork lacks;
  lacks.add(shard, c);
  for (const auto& stage : lacks.lost)
    warnings.push_back(
        fmt::format("{}: the arrays of {} are missing (run the campaign's "
                    "command there again)",
                    shard.directory().string(),
                    stage));
  for (const StageRecord& stage : c.stages) {
    const auto slot = std::pair(name, stage.position);
    const JournalEntry* there = store.catalog().at(name, stage.position);
    if (there != nullptr && has_result(there->stage)) {
      if (!has_result(stage)) continue;
      const auto first = store.catalog().load(*there);
      if (first && !same(*first, stage))
        throw UnreadableInput(fmt::format(
            "{} and {} differ in stage {} of {} (one of them belongs to "
            "another campaign; leave it out)",
            origins.contains(slot) ? origins[slot].string()
                                   : store.catalog().directory().string(),
            shard.directory().string(),
            stage.stage,
            name));
      if (first) continue;
    }
    store.add(c.info, c.data, stage);
    origins[slot] = shard.directory();
  }
}

}  // namespace

Merged merge(const std::vector<fs::path>& paths,
             const fs::path& out,
             const LockOptions& lock) {
  const auto shards = read_shards(paths);
  for (const auto& shard : shards) check_same_campaign(shards.front(), shard);
  check_out(paths, out);
  for (const auto& shard : shards) checked_cases(shard);
  Store store(out, lock);
  json plan = merged_plan(shards);
  if (store.catalog().plan.is_object()) {
    check_same_campaign(store.catalog(), shards.front());
    plan = extend_plan(store.catalog().plan, std::move(plan));
  }
  store.set_plan(std::move(plan));
  Merged merged;
  if (!store.warning().empty()) merged.warnings.push_back(store.warning());
  for (const auto& shard : shards)
    merged.warnings.insert(merged.warnings.end(),
                           shard.warnings().begin(),
                           shard.warnings().end());
  Origins origins;
  for (const std::string name : shards.front().plan.at("cases")) {
    std::size_t from = 0;
    for (const auto& shard : shards) {
      if (!shard.knows_case(name)) continue;
      if (from++ > 0) store.commit();  // what is there is looked at
      merge_case(store, shard, name, origins, merged.warnings);
    }
    if (store.is_due(kCommitSeconds)) store.commit();
  }
  merged.lacks = missing_work(store.catalog(), store.finish());
  return merged;
}

}  // namespace physinv
