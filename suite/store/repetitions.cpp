#include "suite/store/repetitions.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "suite/core/median.h"
#include "suite/store/folder.h"
#include "suite/store/json.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kRepetitionsFile = "repetitions.json";

}  // namespace

Repetitions read_repetitions(const fs::path& directory) {
  const Folder folder(directory);
  if (!folder.has(kRepetitionsFile)) return {};
  return parse_repetitions(folder.read(kRepetitionsFile, kLargestText),
                           directory / kRepetitionsFile);
}

Repetitions parse_repetitions(std::string_view bytes, const fs::path& path) {
  Repetitions repetitions;
  try {
    const Json all = parse_json<Json>(bytes);
    if (!is_intact(all)) throw std::runtime_error("checksum");
    for (const auto& [name, times] : all.at("times").items())
      for (const Json& t : times)
        repetitions[name].push_back(seconds_from_json(t));
  } catch (const std::exception&) {
    throw StoreError(
        fmt::format("{} is damaged (delete it, or run --benchmark_repetitions "
                    "again)",
                    path.string()));
  }
  return repetitions;
}

void write_repetitions(const fs::path& directory,
                       const Repetitions& repetitions) {
  Json times = Json::object();
  for (const auto& [name, seconds] : repetitions) {
    times[name] = Json::array();
    for (const Seconds& s : seconds) times[name].push_back(Json(to_json(s)));
  }
  Json all{{"times", std::move(times)}};
  all["checksum"] = checksum_of(all);
  Folder(directory).write(kRepetitionsFile, all.dump(1) + "\n");
}

void add_repetitions(std::vector<CaseRecord>& cases,
                     const Repetitions& repetitions) {
  for (CaseRecord& c : cases) {
    for (StageRecord& s : c.stages) {
      const auto at = repetitions.find(
          fmt::format("{}/{} {}", c.info.name, s.stage, s.key));
      if (at != repetitions.end() && has_time(s)) s.repeated = at->second;
    }
  }
}

std::vector<double> solving_times(const StageRecord& stage,
                                  double Seconds::*clock) {
  std::vector<double> all = {stage.clocks.solve.*clock};
  for (const Seconds& again : stage.repeated) all.push_back(again.*clock);
  return all;
}

Seconds solving_time(const StageRecord& stage) {
  return {median(solving_times(stage, &Seconds::wall)),
          median(solving_times(stage, &Seconds::cpu))};
}

}  // namespace physinv
