#include "suite/results/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <nlohmann/json.hpp>
#include <optional>

#include "suite/results/checksum.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kPrefix = 9;  // digits and a space

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
  return json::parse(line.substr(kPrefix));
}

void check_header(const fs::path& path, std::string_view line) {
  const json header = parse_line(line);
  const int version = header.value("schema_version", 0);
  if (version > kSchemaVersion) {
    throw UnreadableInput(fmt::format(
        "{}: its results have schema version {}, this program reads up to {} "
        "(use the program that wrote them or a newer one)",
        path.string(),
        version,
        kSchemaVersion));
  }
  if (version < 1) fail_line(path, 1, 0, line, "is no journal's header");
}

json to_json(const JournalEntry& e) {
  return {{"info", physinv::to_json(e.info)},
          {"record", physinv::to_json(e.stage)},
          {"file", e.file},
          {"data_hash", e.data_hash},
          {"arrays_hash", e.arrays_hash}};
}

JournalEntry entry_from_json(const json& j) {
  return {.info = case_from_json(j.at("info")),
          .stage = stage_from_json(j.at("record")),
          .file = j.at("file"),
          .data_hash = j.at("data_hash"),
          .arrays_hash = j.at("arrays_hash")};
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

JournalText read_journal(const fs::path& path) {
  const std::string bytes = read_file(path);
  JournalText text;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < bytes.size(); ++number) {
    const std::size_t end = bytes.find('\n', begin);
    const bool ended = end != std::string::npos;
    const std::string_view line =
        std::string_view(bytes).substr(begin, ended ? end - begin : end);
    if (!ended || !intact(line)) {
      if (number == 0 || ended || hides_line(line))
        fail_line(path, number + 1, begin, line, "fails its checksum");
      text.warning = fmt::format(
          "{}: line {}, at byte {}, was cut off while it was written; its "
          "stage runs again",
          path.string(),
          number + 1,
          begin);
      break;
    }
    try {
      if (number == 0) {
        check_header(path, line);
      } else {
        text.entries.push_back(entry_from_json(parse_line(line)));
      }
    } catch (const json::exception& e) {
      fail_line(path, number + 1, begin, line, e.what());
    }
    begin = end + 1;
    text.good_bytes = begin;
  }
  if (number == 0 && text.good_bytes == 0)
    fail_line(path, 1, 0, "", "is missing: the file is empty");
  return text;
}

void forget_cases(const fs::path& path, const std::set<std::string>& names) {
  const auto entries = read_journal(path).entries;
  const std::string bytes = read_file(path);
  std::size_t begin = bytes.find('\n') + 1;
  std::string kept = bytes.substr(0, begin);
  for (const auto& entry : entries) {
    const std::size_t end = bytes.find('\n', begin) + 1;
    if (!names.contains(entry.info.name))
      kept.append(bytes, begin, end - begin);
    begin = end;
  }
  write_atomically(path, kept);
}

Journal Journal::create(const fs::path& path) {
  // Complete or not there at all, so that a first line is never torn.
  write_atomically(
      path, to_line({{"schema_version", kSchemaVersion}, {"created", utc()}}));
  return resume(path, read_journal(path));
}

Journal Journal::resume(const fs::path& path, const JournalText& text) {
  Journal journal;
  journal.path_ = path;
  journal.size_ = text.good_bytes;
  journal.fd_ =
      FileDescriptor(::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC));
  if (journal.fd_.get() < 0) fail_file("write", path, errno);
  if (!text.warning.empty()) {
    if (::ftruncate(journal.fd_.get(), static_cast<off_t>(text.good_bytes)) < 0)
      fail_file("write", path, errno);
    sync(journal.fd_, path);
  }
  return journal;
}

void Journal::append(const JournalEntry& entry) {
  const std::string line = to_line(to_json(entry));
  try {
    write_all(fd_, line, path_);
    sync(fd_, path_);
  } catch (...) {
    // If this fails as well, the next reader sees a torn line.
    [[maybe_unused]] const int rc =
        ::ftruncate(fd_.get(), static_cast<off_t>(size_));
    throw;
  }
  size_ += line.size();
}

}  // namespace physinv
