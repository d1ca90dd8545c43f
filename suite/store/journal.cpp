#include "suite/store/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <nlohmann/json.hpp>

#include "suite/store/checksum.h"
#include "suite/store/field_json.h"
#include "suite/store/names.h"

namespace physinv {

template <class F>
void each_field(MaybeConst<JournalEntry> auto& entry, F&& f) {
  f("info", entry.info);
  f("record", entry.stage);
  f("file", entry.file);
  f("data_hash", entry.data_hash);
  f("arrays_hash", entry.arrays_hash);
}

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kPrefix = 9;  // digits and a space
constexpr const char* kNoKey = "a key does not have 32 hexadecimal digits";
constexpr const char* kNoWord =
    "method, profile or a stage is not in [a-z0-9_-]";

std::string to_line(const json& content) {
  // A message may hold any bytes; those that are not UTF-8 are replaced.
  const std::string text =
      content.dump(-1, ' ', false, json::error_handler_t::replace);
  return fmt::format("{:08x} {}\n", crc32c(text), text);
}

/// True if the line (without its end) agrees with its checksum.
bool intact(std::string_view line) {
  return line.size() > kPrefix && line[kPrefix - 1] == ' ' &&
         line.substr(0, kPrefix - 1) ==
             fmt::format("{:08x}", crc32c(line.substr(kPrefix)));
}

/// A damaged line end hides a finished line in the one before it.
bool hides_line(std::string_view line) {
  for (auto at = line.find(" {\"", kPrefix); at != std::string_view::npos;
       at = line.find(" {\"", at + 1)) {
    if (intact(line.substr(at + 1 - kPrefix))) return true;
  }
  return false;
}

[[noreturn]] void fail_line(const fs::path& path,
                            std::size_t number,
                            std::size_t offset,
                            std::string_view line,
                            std::string_view why) {
  throw CorruptJournal(fmt::format(
      "{}: line {}, at byte {} and {} bytes long, {}; nothing was changed "
      "({})",
      path.string(),
      number,
      offset,
      line.size(),
      why,
      number == 1 ? "restore the file or choose another --out"
                  : fmt::format("restore the file, or delete this line, sed -i "
                                "{}d, to run its stage again",
                                number)));
}

json parse_line(std::string_view line) {
  return parse_json(line.substr(kPrefix));
}

/// Files of a store are in its folder itself, which no link leads out of.
Folder store_of(const fs::path& path) {
  return Folder(path.has_parent_path() ? path.parent_path() : ".");
}

void check_header(const fs::path& path, std::string_view line) {
  const json header = parse_line(line);
  const auto version = whole(header.at("schema_version"));
  if (version > kSchemaVersion) {
    throw UnreadableInput(
        fmt::format("{}: the schema version is {}, this program reads up to {} "
                    "(use the program that wrote it or a newer one)",
                    path.string(),
                    version,
                    kSchemaVersion));
  }
  if (version < 1)
    fail_line(path, 1, 0, line, "is not the header of a journal");
}

void require(bool good, const char* what) {
  if (!good) throw std::runtime_error(what);
}

void check_stage(const StageRecord& r, const CaseInfo& info) {
  require(r.case_name == info.name, "a stage belongs to another case");
  require(is_key(r.key), kNoKey);
  require(is_word(r.stage), kNoWord);
  require(
      r.position >= 0 && r.position < static_cast<Index>(info.stages.size()),
      "a stage is not in the chain of its case");
}

JournalEntry entry_of(std::string_view line) {
  auto entry = from_object<JournalEntry>(parse_line(line));
  check_case(entry.info);
  check_stage(entry.stage, entry.info);
  return entry;
}

struct stat file_of(const FileDescriptor& fd) {
  struct stat info {};
  ::fstat(fd.get(), &info);
  return info;
}

std::string utc() {
  const std::time_t t = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&t, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z",
                     parts.tm_year + 1900,
                     parts.tm_mon + 1,
                     parts.tm_mday,
                     parts.tm_hour,
                     parts.tm_min,
                     parts.tm_sec);
}

}  // namespace

void check_case(const CaseInfo& c) {
  require(
      is_case_name(c.name) && is_path(c.experiment),
      "its name is not a path of [a-z0-9_.=+-] with at most 250 characters");
  require(is_word(c.method) && is_word(c.profile), kNoWord);
  for (const auto& stage : c.stages) require(is_word(stage), kNoWord);
  for (const auto& key : c.keys) require(is_key(key), kNoKey);
  require(c.keys.size() == c.stages.size(), "a stage has no key");
  require(c.n > 0, "n is not positive");
}

JournalText read_journal(const fs::path& path) {
  return parse_journal(store_of(path).read(path.filename(), kLargestData),
                       path);
}

JournalText parse_journal(std::string_view bytes, const fs::path& path) {
  JournalText text;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < bytes.size(); ++number) {
    const std::size_t end = bytes.find('\n', begin);
    const bool ended = end != std::string_view::npos;
    const auto line = bytes.substr(begin, ended ? end - begin : end);
    if (!ended || !intact(line)) {
      if (number == 0 || ended || hides_line(line))
        fail_line(path, number + 1, begin, line, "has a wrong checksum");
      text.warning = fmt::format(
          "{}: line {}, at byte {}, is incomplete, because writing it was "
          "interrupted; its stage runs again",
          path.string(),
          number + 1,
          begin);
      break;
    }
    try {
      if (number == 0) {
        check_header(path, line);
      } else {
        text.entries.push_back(entry_of(line));
      }
    } catch (const UnreadableInput&) {
      throw;
    } catch (const CorruptJournal&) {
      throw;
    } catch (const std::exception& e) {
      fail_line(path,
                number + 1,
                begin,
                line,
                fmt::format("is invalid: {}", e.what()));
    }
    begin = end + 1;
    text.good_bytes = begin;
  }
  if (number == 0 && text.good_bytes == 0)
    fail_line(path, 1, 0, "", "is missing: the file is empty");
  return text;
}

void forget_cases(const fs::path& path, const std::set<std::string>& names) {
  const Folder store = store_of(path);
  const std::string bytes = store.read(path.filename(), kLargestData);
  const auto entries = parse_journal(bytes, path).entries;
  std::size_t begin = bytes.find('\n') + 1;
  std::string kept = bytes.substr(0, begin);
  for (const auto& entry : entries) {
    const std::size_t end = bytes.find('\n', begin) + 1;
    if (!names.contains(entry.info.name))
      kept.append(bytes, begin, end - begin);
    begin = end;
  }
  store.write(path.filename(), kept);
}

Journal Journal::create(const fs::path& path) {
  // Complete or not there at all, so that a first line is never torn.
  store_of(path).write(
      path.filename(),
      to_line({{"schema_version", kSchemaVersion}, {"created", utc()}}));
  return resume(path, read_journal(path));
}

Journal Journal::resume(const fs::path& path, const JournalText& text) {
  Journal journal;
  journal.path_ = path;
  journal.size_ = text.good_bytes;
  const Folder store = store_of(path);
  const auto open = [&] {
    return store.open(path.filename(), O_WRONLY | O_APPEND, "write");
  };
  journal.fd_ = open();
  // A backup made of links keeps the lines that it has.
  if (file_of(journal.fd_).st_nlink > 1) {
    store.write(path.filename(), store.read(path.filename(), kLargestData));
    journal.fd_ = open();
  }
  if (!text.warning.empty()) {
    if (::ftruncate(journal.fd_.get(), static_cast<off_t>(text.good_bytes)) < 0)
      fail_file("write", path, errno);
    sync(journal.fd_, path);
  }
  return journal;
}

void Journal::require_there() const {
  const struct stat own = file_of(fd_);
  struct stat named {};
  const bool there = ::lstat(path_.c_str(), &named) == 0 &&
                     named.st_ino == own.st_ino && named.st_dev == own.st_dev;
  if (!there)
    throw StoreError(fmt::format(
        "{} was removed or replaced during the run (run the campaign again)",
        path_.string()));
}

void Journal::append(std::span<const JournalEntry> entries) {
  require_there();
  std::string lines;
  for (const JournalEntry& entry : entries) lines += to_line(to_object(entry));
  if (size_ + lines.size() > kLargestData)
    throw StoreError(fmt::format(
        "{} would exceed the size limit of {} bytes (choose another --out)",
        path_.string(),
        kLargestData));
  try {
    write_all(fd_, lines, path_);
    sync(fd_, path_);
  } catch (...) {
    // If this fails as well, the next reader sees a torn line.
    [[maybe_unused]] const int rc =
        ::ftruncate(fd_.get(), static_cast<off_t>(size_));
    throw;
  }
  size_ += lines.size();
}

}  // namespace physinv
