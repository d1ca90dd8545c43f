#include "suite/store/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "suite/core/check.h"
#include "suite/core/hash.h"
#include "suite/store/json.h"
#include "suite/store/names.h"
#include "suite/store/repetitions.h"
#include "suite/store/results_file.h"
#include "suite/store/results_json.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char *kCases = "cases", *kCheckpoints = "checkpoints",
                     *kResults = "results.json", *kPlan = "plan.json";

/// What a store holds, and nothing else, if no process writes to it.
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
    } catch (const StoreError&) {  // in use, or a file that is removed anyway
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

/// More is not kept in memory for a commit.
constexpr std::size_t kMostWaiting = std::size_t{64} << 20;

std::size_t bytes_of(const StageRecord& r) {
  Index numbers = r.x.size() + r.curve.loss.size() + r.curve.x.size();
  for (const auto& [name, array] : r.arrays) numbers += array.size();
  return static_cast<std::size_t>(numbers) * sizeof(double);
}

bool by_case(const JournalEntry& a, const JournalEntry& b) {
  return a.info.name < b.info.name;
}

/// Estimates, losses and statuses; the other arrays are in the case's file.
void keep_what_results_need(StageRecord& r) {
  r.example_iterations.resize(0);
  r.example_evaluations.resize(0);
  r.curve = {};
  r.arrays.clear();
}

/// Unless it is damaged: then it is written again.
std::optional<nlohmann::ordered_json> known_results(const fs::path& directory) {
  if (!Folder(directory).has(kResults)) return {};
  try {
    return read_results(directory);
  } catch (const StoreError&) {
    return {};
  }
}

/// Damaged ones are reported where they are read.
Repetitions known_repetitions(const fs::path& directory) {
  try {
    return read_repetitions(directory);
  } catch (const StoreError&) {
    return {};
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
  commit();
  // The lines are removed first: a file that no line names does not count.
  forget_cases(catalog_.journal_path(), names);
  for (const auto& name : names) {
    open_.erase(name);
    cases_.remove(case_file_name(name));
  }
  catalog_ = Catalog::read(catalog_.directory());
  journal_ = Journal::resume(catalog_.journal_path(), catalog_.journal());
  if (folder_.has(kResults)) finish();
}

std::optional<StageRecord> Store::find(
    const std::string& key, const std::set<std::string>* among) const {
  auto found = catalog_.find(key, among);
  for (const JournalEntry& e : waiting_) {
    if (found && has_result(*found)) break;
    const bool asked = e.stage.key == key &&
                       (among == nullptr || among->contains(e.info.name));
    if (asked && (!found || has_result(e.stage))) found = e.stage;
  }
  return found;
}

bool Store::has(const CaseInfo& info, const StageRecord& record) {
  const bool waits =
      std::any_of(waiting_.begin(), waiting_.end(), [&](const auto& e) {
        return e.info.name == info.name && e.stage.key == record.key &&
               e.stage.position == record.position && has_result(e.stage);
      });
  if (waits) return true;
  const JournalEntry* old = catalog_.at(info.name, record.position);
  return old != nullptr && old->stage.key == record.key &&
         has_result(old->stage) &&
         open_case(info.name).has_stage(old->stage, old->arrays_hash);
}

void Store::add(const CaseInfo& info,
                const CaseData& data,
                StageRecord record) {
  SUITE_CHECK(record.case_name == info.name && is_key(record.key),
              "a stage belongs to another case or has no content key");
  if (has(info, record)) return;
  if (waiting_.empty()) waiting_since_ = now().wall;
  waiting_bytes_ += bytes_of(record);
  if (CaseData& own = data_[info.name]; own.hash != data.hash) own = data;
  std::string hash = hex64(arrays_hash(record));
  waiting_.push_back({.info = info,
                      .stage = std::move(record),
                      .file = "cases/" + case_file_name(info.name),
                      .data_hash = data.hash,
                      .arrays_hash = std::move(hash)});
}

void Store::append(const CaseInfo& info,
                   const CaseData& data,
                   const StageRecord& record) {
  add(info, data, record);
  commit();
}

bool Store::is_due(double seconds) const {
  return !waiting_.empty() && (now().wall - waiting_since_ >= seconds ||
                               waiting_bytes_ > kMostWaiting);
}

void Store::commit() {
  if (waiting_.empty()) return;
  const Seconds begin = now();
  auto entries = std::exchange(waiting_, {});
  waiting_bytes_ = 0;
  try {
    write(entries);
  } catch (const StoreError&) {
    if (data_.size() == 1) throw;
    std::stable_sort(entries.begin(), entries.end(), by_case);
    for (auto first = entries.begin(); first != entries.end();) {
      const auto last = std::upper_bound(first, entries.end(), *first, by_case);
      write({first, last});
      first = last;
    }
  }
  data_.clear();
  commit_time_ += now() - begin;
}

void Store::write(std::span<JournalEntry> entries) {
  try {
    write_files(entries);
  } catch (...) {
    for (const auto& e : entries) open_.erase(e.info.name);
    throw;  // they no longer are what the disk has
  }
  journal_.append(entries);
  for (JournalEntry& e : entries) {
    const auto stages = static_cast<Index>(e.info.stages.size());
    if (e.stage.position + 1 >= stages) open_.erase(e.info.name);
    if (has_result(e.stage)) drop_state(e.stage.key);
    appended_.insert(e.info.name + "/" + e.stage.stage);
    keep_what_results_need(e.stage);
    catalog_.add(std::move(e));
  }
}

void Store::write_files(std::span<const JournalEntry> entries) {
  std::map<std::string, CaseFile*> cases;
  for (const auto& e : entries) {
    CaseFile*& file = cases[e.info.name];
    if (file == nullptr) {
      file = &open_case(e.info.name);
      file->describe(e.info, e.stage);
      file->put_data(data_.at(e.info.name));
    }
    file->put_stage(e.stage, e.arrays_hash);
  }
  FileGroup files(cases_);
  for (const auto& [name, file] : cases)
    files.add(case_file_name(name), file->bytes());
  files.put_in_place();
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
  // Until it is written again, results.json describes what was asked for
  // before.
  plan.erase("results");
  if (const auto earlier = known_results(catalog_.directory()))
    plan["results"] = checksum_of(*earlier);
  catalog_.plan = std::move(plan);
  folder_.write(kPlan, plan_text(catalog_.plan));
}

void Store::set_context(const json& context) {
  catalog_.plan["context"] = context;
}

void keep_repetitions(const fs::path& directory,
                      const Repetitions& repetitions,
                      const LockOptions& lock) {
  Store store(directory, lock);
  if (const auto results = known_results(directory))
    store.set_context(results->at("context"));
  // Never together with repetitions that it does not contain.
  Folder(directory).remove(kResults);
  write_repetitions(directory, repetitions);
  store.finish();
}

std::vector<CaseRecord> Store::finish() {
  commit();
  const json& plan = catalog_.plan;
  const json context =
      plan.is_object() ? plan.value("context", json::object()) : json::object();
  auto cases = catalog_.summaries();
  add_repetitions(cases, known_repetitions(catalog_.directory()));
  auto results = results_json(cases, catalog_.order(), context);
  // What was altered is not written down as true; what ran here is new.
  if (auto earlier = known_results(catalog_.directory())) {
    auto& entries = earlier->at("benchmarks");
    std::erase_if(
        entries.get_ref<nlohmann::ordered_json::array_t&>(),
        [&](const nlohmann::ordered_json& entry) {
          return appended_.contains(entry.at("name").get<std::string>());
        });
    check_entries(catalog_, *earlier, results);
  }
  journal_.require_there();
  folder_.write(kResults, results_text(sealed(std::move(results))));
  return cases;
}

}  // namespace physinv
