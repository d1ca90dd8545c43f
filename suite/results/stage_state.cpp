#include "suite/results/stage_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "suite/results/checksum.h"
#include "suite/results/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kSum = 8;

}  // namespace

fs::path state_path(const fs::path& store, const std::string& key) {
  return store / "checkpoints" / key;
}

void write_state(const fs::path& path, const StageState& state) {
  make_directory(path.parent_path());
  const json head = {{"case", state.case_name},
                     {"stage", state.stage},
                     {"iteration", state.iteration}};
  const std::string text = fmt::format(" {}\n{}", head.dump(), state.bytes);
  write_atomically(path, fmt::format("{:08x}{}", crc32c(text), text));
}

std::optional<StageState> read_state(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  const std::string all = read_file(path);
  const std::string_view text(all.data() + std::min(kSum, all.size()),
                              all.size() - std::min(kSum, all.size()));
  if (fmt::format("{:08x}", crc32c(text)) != all.substr(0, kSum))
    throw StoreError(
        fmt::format("{} is damaged (its stage starts again)", path.string()));
  const auto end = text.find('\n');
  const json head = json::parse(text.substr(0, end));
  return StageState{.case_name = head.at("case"),
                    .stage = head.at("stage"),
                    .iteration = head.at("iteration"),
                    .bytes = std::string(text.substr(end + 1))};
}

}  // namespace physinv
