#include "suite/store/catalog.h"

#include <fmt/format.h>

#include <algorithm>

#include "suite/store/plan.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// Did a writer begin there that was killed before its journal, the first of
/// its files, stood there?
bool is_begun(const Folder& store) {
  if (!store.has("lock")) return false;
  for (const char* file : {"plan.json", "results.json", "repetitions.json"})
    if (store.has(file)) return false;
  const auto cases = store.find("cases");
  const auto names = cases ? cases->names() : std::vector<std::string>();
  return std::none_of(names.begin(), names.end(), [](const auto& name) {
    return name.ends_with(".h5");
  });
}

}  // namespace

Catalog::Catalog(fs::path directory) : directory_(std::move(directory)) {}

Catalog Catalog::read(const fs::path& directory) {
  Catalog catalog(directory);
  const fs::path path = catalog.journal_path();
  std::error_code error;
  const bool there = fs::is_directory(directory, error);
  if (there && !Folder(directory).has(path.filename()) &&
      is_begun(Folder(directory))) {
    catalog.warnings_.push_back(
        fmt::format("{}: a run started there, but no stage has finished",
                    directory.string()));
    return catalog;
  }
  if (!there || !Folder(directory).has(path.filename()))
    throw UnreadableInput(
        fmt::format("{}: no results (it has no {}; give the --out of a run)",
                    directory.string(),
                    path.filename().string()));
  catalog.journal_ = read_journal(path);
  for (auto& entry : catalog.journal_.entries) catalog.add(std::move(entry));
  catalog.journal_.entries.clear();
  std::string warning;
  catalog.plan = read_plan(directory / "plan.json", &warning);
  for (const auto& text : {catalog.journal_.warning, warning})
    if (!text.empty()) catalog.warnings_.push_back(text);
  return catalog;
}

fs::path Catalog::journal_path() const { return directory_ / "journal.jsonl"; }

fs::path Catalog::case_path(const std::string& case_name) const {
  return directory_ / "cases" / case_file_name(case_name);
}

std::optional<CaseFile> Catalog::case_file(const std::string& name) const {
  const auto cases = Folder(directory_).find("cases");
  if (!cases || !cases->has(case_file_name(name))) return std::nullopt;
  return CaseFile(*cases, name);
}

void Catalog::add(JournalEntry entry) {
  const std::size_t i = entries_.size();
  const auto slot = std::pair(entry.info.name, entry.stage.position);
  const auto [at, is_new] = slots_.emplace(slot, i);
  if (!is_new) {
    const std::string& old = entries_[at->second].stage.key;
    const auto [begin, end] = keys_.equal_range(old);
    for (auto k = begin; k != end; ++k) {
      if (k->second != at->second) continue;
      keys_.erase(k);
      break;
    }
    at->second = i;
  }
  keys_.emplace(entry.stage.key, i);
  latest_[entry.info.name] = i;
  entries_.push_back(std::move(entry));
}

bool Catalog::knows_case(const std::string& case_name) const {
  return latest_.contains(case_name);
}

const JournalEntry* Catalog::at(const std::string& case_name,
                                Index position) const {
  const auto at = slots_.find({case_name, position});
  return at == slots_.end() ? nullptr : &entries_[at->second];
}

const JournalEntry* Catalog::entry_of(
    const std::string& key, const std::set<std::string>* among) const {
  const JournalEntry* best = nullptr;
  const auto [begin, end] = keys_.equal_range(key);
  for (auto k = begin; k != end; ++k) {
    const JournalEntry& e = entries_[k->second];
    if (among != nullptr && !among->contains(e.info.name)) continue;
    const bool better =
        best == nullptr || std::pair(!has_result(e.stage), &e) <
                               std::pair(!has_result(best->stage), best);
    if (better) best = &e;
  }
  return best;
}

std::optional<StageRecord> Catalog::find(
    const std::string& key, const std::set<std::string>* among) const {
  const JournalEntry* entry = entry_of(key, among);
  return entry == nullptr ? std::nullopt : load(*entry);
}

std::optional<StageRecord> Catalog::load(const JournalEntry& entry) const {
  // Deleted, or replaced by a run that was killed before its journal line: the
  // stage counts as not run.
  const auto file = case_file(entry.info.name);
  if (!file || !file->has_stage(entry.stage, entry.arrays_hash))
    return std::nullopt;
  StageRecord record = entry.stage;
  file->read_stage(record, entry.arrays_hash);
  return record;
}

std::vector<std::string> Catalog::order() const {
  std::vector<std::string> names;
  if (plan.is_object()) names = plan.at("cases");
  std::set<std::string> seen(names.begin(), names.end());
  for (const auto& entry : entries_) {
    if (seen.insert(entry.info.name).second) names.push_back(entry.info.name);
  }
  return names;
}

CaseInfo Catalog::info_of(const std::string& case_name) const {
  CaseInfo info = entries_[latest_.at(case_name)].info;
  info.keys = planned_keys(plan, case_name, std::move(info.keys));
  return info;
}

CaseRecord Catalog::case_record(const std::string& name) const {
  CaseRecord record;
  record.info = info_of(name);
  const auto file = case_file(name);
  if (!file) return record;
  record.info.about = file->about();
  record.data = file->data();
  const auto& keys = record.info.keys;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const JournalEntry* own = at(name, static_cast<Index>(k));
    if (own == nullptr || own->stage.key != keys[k] ||
        !file->has_stage(own->stage, own->arrays_hash))
      continue;
    if (own->data_hash != record.data.hash)
      throw StoreError(fmt::format(
          "{}: its data differ from the journal line of stage {} (restore it, "
          "or delete it to run the stages of this case again)",
          case_path(name).string(),
          own->stage.stage));
    record.stages.push_back(own->stage);
    file->read_stage(record.stages.back(), own->arrays_hash);
  }
  return record;
}

CaseRecord Catalog::summary(const std::string& name) const {
  CaseRecord record;
  record.info = info_of(name);
  for (std::size_t k = 0; k < record.info.keys.size(); ++k) {
    const JournalEntry* own = at(name, static_cast<Index>(k));
    if (own == nullptr || own->stage.key != record.info.keys[k]) continue;
    if (has_result(own->stage) && own->stage.loss.size() == 0)
      return case_record(name);
    record.stages.push_back(own->stage);
    record.data.hash = own->data_hash;
  }
  return record;
}

std::vector<CaseRecord> Catalog::collect(
    CaseRecord (Catalog::*read_case)(const std::string&) const) const {
  std::vector<CaseRecord> all;
  for (const auto& name : order()) {
    if (!knows_case(name)) continue;
    auto record = (this->*read_case)(name);
    if (!record.stages.empty()) all.push_back(std::move(record));
  }
  return all;
}

std::vector<CaseRecord> Catalog::cases() const {
  return collect(&Catalog::case_record);
}

std::vector<CaseRecord> Catalog::summaries() const {
  return collect(&Catalog::summary);
}

}  // namespace physinv
