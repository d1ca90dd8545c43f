#include "suite/results/store.h"

#include <fmt/format.h>

#include "suite/core/check.h"
#include "suite/core/hash.h"
#include "suite/results/results_json.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void remove_file(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) fail_file("delete", path, error.value());
}

/// Files aside that a killed writer left.
void remove_leftovers(const fs::path& directory) {
  for (const auto& file : fs::directory_iterator(directory))
    if (file.path().extension() == ".tmp") remove_file(file.path());
}

}  // namespace

Store::Store(const fs::path& directory) : catalog_(directory) {
  make_directory(directory);
  lock_ = DirectoryLock(directory);
  make_directory(directory / "cases");
  remove_leftovers(directory);
  remove_leftovers(directory / "cases");
  if (fs::exists(directory / "checkpoints"))
    remove_leftovers(directory / "checkpoints");
  if (exists(directory)) {
    catalog_ = Catalog::read(directory);
    journal_ = Journal::resume(catalog_.journal_path(), catalog_.journal());
    warning_ = catalog_.journal().warning;
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
  return fs::exists(directory / "journal.jsonl", error);
}

void Store::forget(const std::set<std::string>& names) {
  // The lines go first: a file that no line names counts for nothing.
  forget_cases(catalog_.journal_path(), names);
  for (const auto& name : names) {
    open_.erase(name);
    remove_file(catalog_.case_path(name));
  }
  catalog_ = Catalog::read(catalog_.directory());
  journal_ = Journal::resume(catalog_.journal_path(), catalog_.journal());
  if (fs::exists(catalog_.directory() / "results.json")) finish();
}

void Store::append(const CaseInfo& info,
                   const CaseData& data,
                   const StageRecord& record) {
  SUITE_CHECK(record.case_name == info.name, "a stage of another case");
  const fs::path path = catalog_.case_path(info.name);
  CaseFile& file = open_case(info.name, path);

  const JournalEntry* old = catalog_.at(info.name, record.position);
  if (old != nullptr && old->stage.key == record.key &&
      has_result(old->stage) && file.has_stage(old->stage, old->arrays_hash))
    return;

  const std::string hash = hex64(arrays_hash(record));
  try {
    file.put_data(data);
    file.put_stage(record, hash);
    file.save(path);
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

CaseFile& Store::open_case(const std::string& name, const fs::path& path) {
  if (!fs::exists(path)) open_.erase(name);  // somebody took it away
  if (const auto at = open_.find(name); at != open_.end()) return at->second;
  // A file that no line names is what a killed writer left: start again.
  const bool there = catalog_.knows_case(name) && fs::exists(path);
  return open_.emplace(name, there ? CaseFile(path, name) : CaseFile(name))
      .first->second;
}

std::optional<StageState> Store::state(const std::string& key) const {
  return read_state(state_path(catalog_.directory(), key));
}

void Store::drop_state(const std::string& key) {
  remove_file(state_path(catalog_.directory(), key));
}

void Store::set_plan(const std::vector<CaseInfo>& cases,
                     const json& context,
                     std::vector<PlannedCase> campaign) {
  set_plan(extend_plan(catalog_.plan,
                       make_plan(cases, context, std::move(campaign))));
}

void Store::set_plan(json plan) {
  catalog_.plan = std::move(plan);
  write_atomically(catalog_.directory() / "plan.json",
                   plan_text(catalog_.plan));
}

void Store::set_context(const json& context) {
  catalog_.plan["context"] = context;
}

std::vector<CaseRecord> Store::finish() {
  const json& plan = catalog_.plan;
  const json context =
      plan.is_object() ? plan.value("context", json::object()) : json::object();
  auto cases = catalog_.summaries();
  write_atomically(
      catalog_.directory() / "results.json",
      results_text(results_json(cases, catalog_.order(), context)));
  return cases;
}

}  // namespace physinv
