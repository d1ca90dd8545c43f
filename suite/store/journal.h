/// The journal: what has finished, one line per stage, in order of time.
///
///   <8 hexadecimal digits: CRC-32C of the rest> <compact JSON>\n
///
/// The first line is a header. Lines do not depend on each other, so deleting
/// one makes its stage run again and nothing else.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "suite/store/folder.h"
#include "suite/store/json.h"
#include "suite/store/record.h"

namespace physinv {

struct JournalEntry {
  CaseInfo info;
  StageRecord stage;        ///< the line has none of its arrays
  std::string file;         ///< of the arrays, relative to the store
  std::string data_hash;    ///< of the case's data
  std::string arrays_hash;  ///< of the stage's arrays
};

struct JournalText {
  std::vector<JournalEntry> entries;
  std::uint64_t good_bytes = 0;  ///< what follows is a torn line
  std::string warning;           ///< about a torn line, or empty
};

/// Names and keys become parts of paths: std::runtime_error if they are not
/// such as a registry makes.
void check_case(const CaseInfo& info);

/// Reads and verifies every line; its names and keys are such as the suite
/// makes. A last line without its end was torn by a
/// kill: it is left out and named in the warning. Throws CorruptJournal for
/// any other damage, UnreadableInput for a newer schema.
JournalText read_journal(const std::filesystem::path& path);
/// The same of a file's bytes; `path` is for messages.
JournalText parse_journal(std::string_view bytes,
                          const std::filesystem::path& path);

/// Takes out the lines of these cases, all or none of them; the other lines
/// stay byte by byte.
void forget_cases(const std::filesystem::path& path,
                  const std::set<std::string>& names);

class Journal {
 public:
  Journal() = default;
  /// Starts a journal or continues the one read as `text`, whose torn line is
  /// cut off.
  static Journal create(const std::filesystem::path& path);
  static Journal resume(const std::filesystem::path& path,
                        const JournalText& text);

  /// The lines are on disk when it returns; if it throws, none is there.
  void append(std::span<const JournalEntry> entries);
  void append(const JournalEntry& entry) { append({&entry, 1}); }
  /// StoreError if somebody removed the journal, or put another in its place.
  void require_there() const;

 private:
  std::filesystem::path path_;
  FileDescriptor fd_;
  std::uint64_t size_ = 0;
};

}  // namespace physinv
