#include "suite/results/merge.h"

#include <fmt/format.h>

#include <map>

#include "suite/results/store.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

using Origins = std::map<std::pair<std::string, Index>, fs::path>;

std::vector<Catalog> read_shards(const std::vector<fs::path>& paths) {
  std::vector<Catalog> shards;
  for (const auto& path : paths) {
    shards.push_back(Catalog::read(path));
    if (!shards.back().plan.is_object())
      throw UnreadableInput(fmt::format(
          "{}: its plan.json is missing, so its campaign is not known (run "
          "the campaign there again: finished stages are kept)",
          path.string()));
  }
  if (shards.empty()) throw UnreadableInput("nothing to merge: name stores");
  return shards;
}

void check_same_campaign(const Catalog& a, const Catalog& b) {
  for (const char* what : {"profile", "fingerprint", "cases"}) {
    const auto of_a = a.plan.value(what, nlohmann::json());
    const auto of_b = b.plan.value(what, nlohmann::json());
    // A shard without cases does not know its profile.
    if (of_a == of_b || of_a == "" || of_b == "") continue;
    throw UnreadableInput(fmt::format(
        "{} and {} cannot be merged: they differ in {}{} (merge shards of one "
        "campaign, run by one build)",
        a.directory().string(),
        b.directory().string(),
        what,
        std::string_view(what) == "cases"
            ? ""
            : fmt::format(", {} and {}", of_a.dump(), of_b.dump())));
  }
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
                Origins& origins) {
  const CaseRecord c = shard.case_record(name);
  for (const StageRecord& stage : c.stages) {
    const auto slot = std::pair(name, stage.position);
    const JournalEntry* there = store.catalog().at(name, stage.position);
    if (there != nullptr && has_result(there->stage)) {
      if (!has_result(stage)) continue;
      const auto first = store.catalog().load(*there);
      if (first && !same(*first, stage))
        throw UnreadableInput(fmt::format(
            "{} and {} differ in stage {} of {} (one of them is not of this "
            "campaign; leave it out)",
            origins.contains(slot) ? origins[slot].string()
                                   : store.catalog().directory().string(),
            shard.directory().string(),
            stage.stage,
            name));
      if (first) continue;
    }
    store.append(c.info, c.data, stage);
    origins[slot] = shard.directory();
  }
}

}  // namespace

void merge(const std::vector<fs::path>& paths, const fs::path& out) {
  const auto shards = read_shards(paths);
  for (const auto& shard : shards) check_same_campaign(shards.front(), shard);
  Store store(out);
  if (store.catalog().plan.is_object())
    check_same_campaign(store.catalog(), shards.front());
  store.set_plan(shards.front().plan);
  Origins origins;
  for (const auto& name : shards.front().order()) {
    for (const auto& shard : shards)
      if (shard.knows_case(name)) merge_case(store, shard, name, origins);
  }
  store.finish();
}

}  // namespace physinv
