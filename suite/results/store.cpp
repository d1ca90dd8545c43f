#include "suite/results/store.h"

#include <fmt/format.h>

#include "suite/core/check.h"
#include "suite/core/hash.h"
#include "suite/results/names.h"
#include "suite/results/results_json.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char *kCases = "cases", *kCheckpoints = "checkpoints",
                     *kResults = "results.json", *kPlan = "plan.json";

/// What a store holds, and nothing else, if nobody writes to it.
void remove_store(const Folder& beside, const std::string& name) {
  const auto store = beside.find(name);
  if (!store) return;
  {
    const DirectoryLock lock(*store);
    if (const auto cases = store->find(kCases)) {
      for (const auto& file : cases->names())
        if (file.ends_with(".h5")) cases->remove(file);
      cases->remove_leftovers();
      store->remove_empty(kCases);
    }
    if (const auto states = store->find(kCheckpoints)) {
      for (const auto& file : states->names())
        if (is_key(file)) states->remove(file);
      states->remove_leftovers();
      store->remove_empty(kCheckpoints);
    }
    for (const char* file : {"journal.jsonl", kPlan, kResults})
      store->remove(file);
    store->remove_leftovers();
  }
  store->remove("lock");
  beside.remove_empty(name);
}

/// Those of a run that was killed; one that runs holds its lock.
void remove_passing_stores(const Folder& folder) {
  for (const auto& name : folder.names()) {
    if (!is_new_folder(name)) continue;
    try {
      remove_store(folder, name);
    } catch (const StoreError&) {  // in use, or a file that goes anyway
    }
  }
}

/// What could not be read back is not written.
void check_cases(const std::vector<CaseInfo>& cases) {
  for (const auto& info : cases) {
    try {
      check_case(info);
    } catch (const std::runtime_error& e) {
      throw UnreadableInput(
          fmt::format("the case {} cannot be stored: {}", info.name, e.what()));
    }
  }
}

}  // namespace

PassingStore::PassingStore(const fs::path& beside) {
  make_directory(beside);
  path_ = Folder(beside).make_new().path();
}

PassingStore::~PassingStore() {
  try {
    remove_store(Folder(path_.parent_path()), path_.filename());
  } catch (const StoreError&) {  // somebody took it away, or put things there
  }
}

Store::Store(const fs::path& directory, const LockOptions& lock)
    : catalog_(directory) {
  make_directory(directory);
  folder_ = Folder(directory);
  lock_ = DirectoryLock(folder_, lock);
  cases_ = folder_.make(kCases);
  remove_passing_stores(folder_);
  folder_.remove_leftovers();
  cases_.remove_leftovers();
  if (const auto states = folder_.find(kCheckpoints))
    states->remove_leftovers();
  warning_ = lock_.warning();
  if (exists(directory)) {
    catalog_ = Catalog::read(directory);
    journal_ = Journal::resume(catalog_.journal_path(), catalog_.journal());
    const std::string& torn = catalog_.journal().warning;
    if (!torn.empty()) warning_ += (warning_.empty() ? "" : "; ") + torn;
  } else {
    journal_ = Journal::create(catalog_.journal_path());
  }
}

Store Store::read_only(const fs::path& directory) {
  Store store;
  store.catalog_ = Catalog::read(directory);
  return store;
}

bool Store::exists(const fs::path& directory) {
  std::error_code error;
  return fs::is_directory(directory, error) &&
         Folder(directory).has("journal.jsonl");
}

void Store::forget(const std::set<std::string>& names) {
  // The lines go first: a file that no line names counts for nothing.
  forget_cases(catalog_.journal_path(), names);
  for (const auto& name : names) {
    open_.erase(name);
    cases_.remove(case_file_name(name));
  }
  catalog_ = Catalog::read(catalog_.directory());
  journal_ = Journal::resume(catalog_.journal_path(), catalog_.journal());
  if (folder_.has(kResults)) finish();
}

void Store::append(const CaseInfo& info,
                   const CaseData& data,
                   const StageRecord& record) {
  SUITE_CHECK(record.case_name == info.name && is_key(record.key),
              "a stage of another case, or without a content key");
  CaseFile& file = open_case(info.name);

  const JournalEntry* old = catalog_.at(info.name, record.position);
  if (old != nullptr && old->stage.key == record.key &&
      has_result(old->stage) && file.has_stage(old->stage, old->arrays_hash))
    return;

  const std::string hash = hex64(arrays_hash(record));
  try {
    file.put_data(data);
    file.put_stage(record, hash);
    file.save(cases_);
  } catch (...) {
    open_.erase(info.name);  // it no longer is what the disk has
    throw;
  }
  const auto stages = static_cast<Index>(info.stages.size());
  if (record.position + 1 >= stages) open_.erase(info.name);

  JournalEntry entry{.info = info,
                     .stage = stage_from_json(to_json(record)),
                     .file = "cases/" + case_file_name(info.name),
                     .data_hash = data.hash,
                     .arrays_hash = hash};
  journal_.append(entry);
  if (has_result(record)) drop_state(record.key);
  entry.stage.x = record.x;
  entry.stage.loss = record.loss;
  entry.stage.status = record.status;
  catalog_.add(std::move(entry));
}

CaseFile& Store::open_case(const std::string& name) {
  const bool there = cases_.has(case_file_name(name));
  if (!there) open_.erase(name);  // somebody took it away
  if (const auto at = open_.find(name); at != open_.end()) return at->second;
  // A file that no line names is what a killed writer left: start again.
  const bool known = catalog_.knows_case(name) && there;
  return open_.emplace(name, known ? CaseFile(cases_, name) : CaseFile(name))
      .first->second;
}

std::optional<StageState> Store::state(const std::string& key) const {
  return read_state(catalog_.directory(), key);
}

void Store::drop_state(const std::string& key) {
  remove_state(catalog_.directory(), key);
}

void Store::set_plan(const std::vector<CaseInfo>& cases,
                     const json& context,
                     std::vector<PlannedCase> campaign) {
  check_cases(cases);
  set_plan(extend_plan(catalog_.plan,
                       make_plan(cases, context, std::move(campaign))));
}

void Store::set_plan(json plan) {
  catalog_.plan = std::move(plan);
  folder_.write(kPlan, plan_text(catalog_.plan));
}

void Store::set_context(const json& context) {
  catalog_.plan["context"] = context;
}

std::vector<CaseRecord> Store::finish() {
  const json& plan = catalog_.plan;
  const json context =
      plan.is_object() ? plan.value("context", json::object()) : json::object();
  auto cases = catalog_.summaries();
  journal_.require_there();
  folder_.write(
      kResults,
      results_text(sealed(results_json(cases, catalog_.order(), context))));
  return cases;
}

}  // namespace physinv
