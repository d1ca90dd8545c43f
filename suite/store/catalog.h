/// What a directory of results holds: journal, plan and case files as one
/// index. Reads only.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "suite/store/case_file.h"
#include "suite/store/journal.h"

namespace physinv {

class Catalog {
 public:
  Catalog() = default;
  /// An empty one for a new store.
  explicit Catalog(std::filesystem::path directory);
  /// Reads journal and plan. StoreError or UnreadableInput if it cannot.
  static Catalog read(const std::filesystem::path& directory);

  const std::filesystem::path& directory() const { return directory_; }
  std::filesystem::path journal_path() const;
  std::filesystem::path case_path(const std::string& case_name) const;

  /// Where several lines name a stage of a case, the last one counts: the
  /// case's file holds its arrays.
  void add(JournalEntry entry);
  const std::vector<JournalEntry>& entries() const { return entries_; }
  const JournalText& journal() const { return journal_; }
  /// Warnings for the reader: a torn line, a plan that is missing or old.
  const std::vector<std::string>& warnings() const { return warnings_; }
  bool knows_case(const std::string& case_name) const;
  const JournalEntry* at(const std::string& case_name, Index position) const;

  /// What a known case is, with the keys that count.
  CaseInfo info_of(const std::string& case_name) const;

  /// The stage with this content key, of whichever case; one with a result if
  /// there is one. Nothing if its arrays are deleted. With `among`, only of
  /// these cases.
  std::optional<StageRecord> find(
      const std::string& key,
      const std::set<std::string>* among = nullptr) const;
  std::optional<StageRecord> load(const JournalEntry& entry) const;

  /// A known case with its arrays; stages of other keys than the plan's, or
  /// without one the case's latest, are left out.
  CaseRecord case_record(const std::string& name) const;

  /// Names of the unsharded campaign in order, then cases it does not name.
  std::vector<std::string> order() const;
  /// Cases that have a stage, in this order.
  std::vector<CaseRecord> cases() const;
  /// The same with what results.json needs: estimates, losses, statuses and
  /// the hash of the data. Reads only files of stages from earlier processes.
  std::vector<CaseRecord> summaries() const;

  /// plan.json, null if there is none.
  nlohmann::json plan;

 private:
  /// Its arrays, if they are there.
  std::optional<CaseFile> case_file(const std::string& name) const;
  CaseRecord summary(const std::string& name) const;
  std::vector<CaseRecord> collect(
      CaseRecord (Catalog::*read_case)(const std::string&) const) const;
  const JournalEntry* entry_of(const std::string& key,
                               const std::set<std::string>* among) const;

  std::filesystem::path directory_;
  std::vector<std::string> warnings_;
  JournalText journal_;
  std::vector<JournalEntry> entries_;
  std::map<std::pair<std::string, Index>, std::size_t> slots_;
  std::unordered_multimap<std::string, std::size_t> keys_;
  std::map<std::string, std::size_t> latest_;  // entry of each case
};

}  // namespace physinv
