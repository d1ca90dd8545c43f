#include "suite/results/exports.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "suite/results/folder.h"
#include "suite/results/json.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kFile = "repetitions.json";

/// Milliseconds of all repetitions, the recorded run first.
std::vector<double> times_of(const Json& entry,
                             const Repetitions& repetitions,
                             double Seconds::*clock) {
  const Json& first =
      entry.at(clock == &Seconds::wall ? "real_time" : "cpu_time");
  std::vector<double> all;
  if (first.is_number()) all.push_back(first);
  const auto at =
      repetitions.find(entry.at("name").get<std::string>() + " " +
                       entry.at("physinv").at("key").get<std::string>());
  if (at != repetitions.end())
    for (const Seconds& s : at->second) all.push_back(1e3 * (s.*clock));
  return all;
}

double mean(const std::vector<double>& v) {
  return std::accumulate(v.begin(), v.end(), 0.0) /
         static_cast<double>(v.size());
}

double middle(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const std::size_t n = v.size();
  return n % 2 == 1 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

double deviation(const std::vector<double>& v) {
  const double m = mean(v);
  double sum = 0;
  for (const double a : v) sum += (a - m) * (a - m);
  return v.size() > 1 ? std::sqrt(sum / static_cast<double>(v.size() - 1)) : 0;
}

double variation(const std::vector<double>& v) {
  return mean(v) > 0 ? deviation(v) / mean(v) : 0;
}

struct Aggregate {
  const char *name, *unit;
  double (*of)(const std::vector<double>&);
};
constexpr Aggregate kAggregates[] = {
    {"mean", "time", mean},
    {"median", "time", [](const std::vector<double>& v) { return middle(v); }},
    {"stddev", "time", deviation},
    {"cv", "percentage", variation}};

Json aggregate(const Json& entry,
               const Aggregate& a,
               const std::vector<double>& wall,
               const std::vector<double>& cpu) {
  return {{"name",
           fmt::format("{}_{}", entry.at("name").get<std::string>(), a.name)},
          {"family_index", entry.at("family_index")},
          {"per_family_instance_index", entry.at("per_family_instance_index")},
          {"run_name", entry.at("run_name")},
          {"run_type", "aggregate"},
          {"repetitions", wall.size()},
          {"threads", entry.at("threads")},
          {"aggregate_name", a.name},
          {"aggregate_unit", a.unit},
          {"iterations", wall.size()},
          {"real_time", a.of(wall)},
          {"cpu_time", a.of(cpu)},
          {"time_unit", entry.at("time_unit")}};
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + '"';
}

}  // namespace

Repetitions read_repetitions(const fs::path& directory) {
  const Folder folder(directory);
  if (!folder.has(kFile)) return {};
  return parse_repetitions(folder.read(kFile, kLargestText), directory / kFile);
}

Repetitions parse_repetitions(std::string_view bytes, const fs::path& path) {
  Repetitions repetitions;
  try {
    const Json all = parse_json<Json>(bytes);
    if (!is_intact(all)) throw std::runtime_error("checksum");
    for (const auto& [name, times] : all.at("times").items())
      for (const Json& t : times)
        repetitions[name].push_back({t.at(0), t.at(1)});
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
    for (const Seconds& s : seconds) times[name].push_back({s.wall, s.cpu});
  }
  Json all{{"times", std::move(times)}};
  all["checksum"] = checksum_of(all);
  Folder(directory).write(kFile, all.dump(1) + "\n");
}

Json benchmark_json(Json results, const Repetitions& repetitions) {
  Json all = Json::array();
  for (const Json& entry : results.at("benchmarks")) {
    const auto wall = times_of(entry, repetitions, &Seconds::wall);
    const auto cpu = times_of(entry, repetitions, &Seconds::cpu);
    const std::size_t count = std::max<std::size_t>(1, wall.size());
    for (std::size_t i = 0; i < count; ++i) {
      Json own = entry;
      own["repetitions"] = count;
      own["repetition_index"] = i;
      if (i < wall.size()) own["real_time"] = wall[i], own["cpu_time"] = cpu[i];
      all.push_back(std::move(own));
    }
    if (count < 2) continue;
    for (const Aggregate& a : kAggregates)
      all.push_back(aggregate(entry, a, wall, cpu));
  }
  results["benchmarks"] = std::move(all);
  return results;
}

std::string benchmark_csv(const Json& benchmarks) {
  std::string out =
      "name,iterations,real_time,cpu_time,time_unit,bytes_per_second,"
      "items_per_second,label,error_occurred,error_message\n";
  for (const Json& b : benchmarks.at("benchmarks"))
    out += fmt::format("{},{},{},{},{},,,,,\n",
                       quoted(b.at("name")),
                       b.at("iterations").dump(),
                       b.at("real_time").dump(),
                       b.at("cpu_time").dump(),
                       b.at("time_unit").get<std::string>());
  return out;
}

Json smaller_is_better(const Json& results, const Repetitions& repetitions) {
  Json out = Json::array();
  for (const Json& entry : results.at("benchmarks")) {
    const std::string name = entry.at("name");
    const auto wall = times_of(entry, repetitions, &Seconds::wall);
    if (!wall.empty()) {
      Json time{
          {"name", name + " time"}, {"unit", "ms"}, {"value", middle(wall)}};
      if (wall.size() > 1)
        time["range"] = fmt::format("{:.6g}", deviation(wall));
      time["extra"] = fmt::format("repetitions: {}", wall.size());
      out.push_back(std::move(time));
    }
    if (const Json& loss = entry.at("loss_median"); loss.is_number())
      out.push_back(
          {{"name", name + " loss"}, {"unit", "loss"}, {"value", loss}});
  }
  return out;
}

Json bencher_metrics(const Json& results, const Repetitions& repetitions) {
  Json out = Json::object();
  for (const Json& entry : results.at("benchmarks")) {
    Json measures = Json::object();
    const auto wall = times_of(entry, repetitions, &Seconds::wall);
    if (!wall.empty()) {
      const auto [low, high] = std::minmax_element(wall.begin(), wall.end());
      measures["latency"] = {{"value", 1e6 * middle(wall)},
                             {"lower_value", 1e6 * *low},
                             {"upper_value", 1e6 * *high}};
    }
    if (const Json& loss = entry.at("loss_median"); loss.is_number())
      measures["loss"] = {{"value", loss}};
    double simulations = 0;
    for (const char* counter : {"forward", "vjp", "jacobian", "inverse"})
      simulations += entry.at(counter).get<double>();
    measures["simulations"] = {{"value", simulations}};
    out[entry.at("name").get<std::string>()] = std::move(measures);
  }
  return out;
}

}  // namespace physinv
