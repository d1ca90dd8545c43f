#include "suite/store/stage_state.h"

#include <fmt/format.h>

#include "suite/store/checksum.h"
#include "suite/store/field_json.h"
#include "suite/store/folder.h"
#include "suite/store/names.h"

namespace physinv {

template <class F>
void each_field(MaybeConst<StageState> auto& state, F&& f) {
  f("case", state.case_name);
  f("stage", state.stage);
  f("iteration", state.iteration);
  f("threads", state.threads, true);
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSum = 8;
constexpr const char* kFolder = "checkpoints";

const std::string& checked(const std::string& key) {
  if (!is_key(key))
    throw StoreError(
        fmt::format("'{}' is not a content key of 32 hexadecimal digits", key));
  return key;
}

std::optional<Folder> states_of(const fs::path& store) {
  std::error_code error;
  if (!fs::exists(store, error)) return {};
  return Folder(store).find(kFolder);
}

StageState parsed(std::string_view text) {
  const auto end = text.find('\n');
  if (end == std::string_view::npos) throw std::runtime_error("no header");
  auto state = from_object<StageState>(parse_json(text.substr(0, end)));
  if (state.iteration < 0) throw std::runtime_error("no iteration");
  if (!is_thread_log(state.threads)) throw std::runtime_error("no threads");
  state.bytes = text.substr(end + 1);
  return state;
}

}  // namespace

void write_state(const fs::path& store,
                 const std::string& key,
                 const StageState& state) {
  const std::string text =
      fmt::format(" {}\n{}", to_object(state).dump(), state.bytes);
  Folder(store).make(kFolder).write(
      checked(key), fmt::format("{:08x}{}", crc32c(text), text));
}

std::optional<StageState> read_state(const fs::path& store,
                                     const std::string& key) {
  checked(key);
  const auto states = states_of(store);
  if (!states || !states->has(key)) return {};
  return parse_state(states->read(key, kLargestData), states->path() / key);
}

StageState parse_state(std::string_view bytes, const fs::path& path) {
  const auto sum = bytes.substr(0, kSum);
  const auto text = bytes.substr(sum.size());
  try {
    if (fmt::format("{:08x}", crc32c(text)) != sum)
      throw std::runtime_error("checksum");
    return parsed(text);
  } catch (const std::exception&) {
    throw StoreError(
        fmt::format("{} is damaged (its stage starts again)", path.string()));
  }
}

void remove_state(const fs::path& store, const std::string& key) {
  checked(key);
  if (const auto states = states_of(store)) states->remove(key);
}

}  // namespace physinv
