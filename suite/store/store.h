/// A directory of results and the one process that may write to it.
///
///   journal.jsonl  what has finished (the truth)   cases/<case>.h5  its arrays
///   plan.json      what was asked for              results.json     derived
///   lock           held by the writer     checkpoints/  see stage_state.h
///
/// All of it is reached through the directory's Folder (folder.h). What else is
/// there is the user's.
///
/// A stage's arrays are on disk before its line, so that the process may be
/// killed at any moment: what `commit` returned for is there, complete, once.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "suite/core/clock.h"
#include "suite/store/catalog.h"
#include "suite/store/lock.h"
#include "suite/store/plan.h"
#include "suite/store/repetitions.h"
#include "suite/store/stage_state.h"

namespace physinv {

/// How long a finished stage waits at most for others to be written with it.
inline constexpr double kCommitSeconds = 2;

class Store {
 public:
  /// Opens for writing, creating what is missing. StoreError if another
  /// process writes there, the disk does not let us, or something is damaged.
  explicit Store(const std::filesystem::path& directory,
                 const LockOptions& lock = {});
  /// Opens an existing store for `find` and `cases`.
  static Store read_only(const std::filesystem::path& directory);
  static bool exists(const std::filesystem::path& directory);

  /// A torn line that was cut off, a file that stands for a lock, or empty.
  const std::string& warning() const { return warning_; }

  /// Deletes what the store holds of these cases, and of no other.
  void forget(const std::set<std::string>& names);

  /// The stage with this content key, of whichever case has it. Failed and
  /// skipped stages are found too, unless the same key also has a result.
  std::optional<StageRecord> find(
      const std::string& key,
      const std::set<std::string>* among = nullptr) const;

  /// Takes a stage up, which is on disk after the next `commit`. One that the
  /// case already has with a result is left as it is.
  void add(const CaseInfo& info, const CaseData& data, StageRecord record);
  /// All that was added is on disk when it returns: the files of its cases,
  /// each written once and all synced together, then their lines. If there is
  /// no room for all of it, what there is room for.
  void commit();
  /// Has something waited for so long, or is it too much to be kept in memory?
  bool is_due(double seconds) const;
  /// Both at once.
  void append(const CaseInfo& info,
              const CaseData& data,
              const StageRecord& record);
  /// What commits took, most of its wall time waiting for the disk.
  Seconds commit_time() const { return commit_time_; }

  /// The state of a running stage; nothing if there is none. StoreError if
  /// it is damaged.
  std::optional<StageState> state(const std::string& key) const;
  /// Nothing is done if there is none.
  void drop_state(const std::string& key);

  /// What is asked for, see plan.h, in addition to what was asked for earlier.
  void set_plan(const std::vector<CaseInfo>& cases,
                const nlohmann::json& context,
                std::vector<PlannedCase> campaign = {});
  void set_plan(nlohmann::json plan);
  /// Replaces the context of results.json.
  void set_context(const nlohmann::json& context);

  std::vector<CaseRecord> cases() const { return catalog_.cases(); }
  const Catalog& catalog() const { return catalog_; }

  /// Writes results.json, derived from everything else. Returns the cases it
  /// describes, without curves and arrays.
  std::vector<CaseRecord> finish();

 private:
  Store() = default;
  CaseFile& open_case(const std::string& name);
  bool has(const CaseInfo& info, const StageRecord& record);
  /// Of these, in this order.
  void write(std::span<JournalEntry> entries);
  void write_files(std::span<const JournalEntry> entries);

  Folder folder_, cases_;
  DirectoryLock lock_;
  std::string warning_;
  Catalog catalog_;
  Journal journal_;
  std::map<std::string, CaseFile> open_;  ///< of cases with stages to come
  std::vector<JournalEntry> waiting_;     ///< for `commit`, with their arrays
  std::map<std::string, CaseData> data_;  ///< of their cases
  double waiting_since_ = 0;
  std::size_t waiting_bytes_ = 0;
  Seconds commit_time_;
  std::set<std::string> appended_;  ///< entries of results.json, by name
};

/// Writes repetitions.json, and results.json again.
void keep_repetitions(const std::filesystem::path& directory,
                      const Repetitions& repetitions,
                      const LockOptions& lock = {});

/// A new store in the folder of another, with a name that only the suite makes;
/// it is removed with all that a store holds. What a kill leaves of it is
/// removed when the other is opened for writing.
class PassingStore {
 public:
  explicit PassingStore(const std::filesystem::path& beside);
  ~PassingStore();
  PassingStore(const PassingStore&) = delete;
  PassingStore& operator=(const PassingStore&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace physinv
