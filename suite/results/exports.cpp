#include "suite/results/exports.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "suite/core/median.h"
#include "suite/store/catalog.h"
#include "suite/store/missing_work.h"
#include "suite/store/plan.h"
#include "suite/store/results_json.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

bool is_error(const Json& entry) { return entry.contains("error_occurred"); }

/// It failed, or most of its losses are not finite: a series of losses that
/// ends raises no alarm.
bool alarms(const Json& entry) {
  return is_error(entry) || !entry.at("loss_median").is_number();
}

std::string why(const Json& entry) {
  return is_error(entry) ? entry.at("error_message").get<std::string>()
                         : "its median loss is not finite";
}

/// Its cores were shared: its times are no measure of speed.
bool is_crowded(const Json& entry) {
  const auto own = entry.find("physinv");
  return own != entry.end() && own->value("crowded", false);
}

/// Nanoseconds of all repetitions by "wall" or "cpu", the recorded run first.
std::vector<double> times_of(const Json& entry, const char* clock) {
  return entry.at("physinv").at("times").at(clock);
}

double mean(const std::vector<double>& v) {
  return std::accumulate(v.begin(), v.end(), 0.0) /
         static_cast<double>(v.size());
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
    {"median", "time", [](const std::vector<double>& v) { return median(v); }},
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

std::vector<StageName> stages_not_run(const Catalog& catalog,
                                      const MissingWork& lacks) {
  std::vector<StageName> names;
  for (const auto& name : lacks.unrun_cases) {
    const auto stages = planned_stages(catalog.plan, name);
    for (const auto& stage : stages) names.push_back({name, stage});
    if (stages.empty()) names.push_back({name, ""});
  }
  for (const auto* some : {&lacks.unrun_stages, &lacks.lost}) {
    for (const std::string& name : *some) {
      const auto space = name.rfind(' ');
      names.push_back({name.substr(0, space), name.substr(space + 1)});
    }
  }
  return names;
}

void add_not_run(Json& results, const std::vector<StageName>& names) {
  for (const auto& [name, stage] : names)
    results["benchmarks"].push_back(
        error_entry(stage.empty() ? name : name + "/" + stage, "not run"));
}

Json benchmark_json(Json results) {
  Json all = Json::array();
  for (const Json& entry : results.at("benchmarks")) {
    if (is_error(entry)) {
      all.push_back(entry);
      continue;
    }
    const auto wall = times_of(entry, "wall"), cpu = times_of(entry, "cpu");
    for (std::size_t i = 0; i < wall.size(); ++i) {
      Json own = entry;
      own["repetitions"] = wall.size();
      own["repetition_index"] = i;
      own["real_time"] = wall[i], own["cpu_time"] = cpu[i];
      all.push_back(std::move(own));
    }
    if (wall.size() < 2) continue;
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
  for (const Json& b : benchmarks.at("benchmarks")) {
    const std::string name = quoted(b.at("name"));
    out += is_error(b)
               ? fmt::format(
                     "{},,,,,,,,true,{}\n", name, quoted(b.at("error_message")))
               : fmt::format("{},{},{},{},{},,,{},,\n",
                             name,
                             b.at("iterations").dump(),
                             b.at("real_time").dump(),
                             b.at("cpu_time").dump(),
                             b.at("time_unit").get<std::string>(),
                             is_crowded(b) ? quoted("crowded") : "");
  }
  return out;
}

Json smaller_is_better(const Json& results) {
  Json out = Json::array();
  for (const Json& entry : results.at("benchmarks")) {
    const std::string name = entry.at("name");
    Json error{{"name", name + " error"},
               {"unit", "0 or 1"},
               {"value", alarms(entry) ? 1 : 0}};
    if (alarms(entry)) error["extra"] = why(entry);
    out.push_back(std::move(error));
    if (is_error(entry)) continue;
    const auto wall = times_of(entry, "wall");
    Json time{{"name", name + " time"},
              {"unit", "ms"},
              {"value", 1e-6 * median(wall)}};
    if (wall.size() > 1)
      time["range"] = fmt::format("{:.6g}", 1e-6 * deviation(wall));
    time["extra"] =
        fmt::format("repetitions: {}{}",
                    wall.size(),
                    is_crowded(entry) ? ", crowded: no measure of speed" : "");
    out.push_back(std::move(time));
    if (const Json& loss = entry.at("loss_median"); loss.is_number())
      out.push_back(
          {{"name", name + " loss"}, {"unit", "loss"}, {"value", loss}});
  }
  return out;
}

Json bencher_metrics(const Json& results) {
  Json out = Json::object();
  for (const Json& entry : results.at("benchmarks")) {
    Json measures{{"error", {{"value", alarms(entry) ? 1 : 0}}}};
    if (!is_error(entry)) {
      const auto wall = times_of(entry, "wall");
      const auto [low, high] = std::minmax_element(wall.begin(), wall.end());
      measures["crowded"] = {{"value", is_crowded(entry) ? 1 : 0}};
      measures["latency"] = {{"value", median(wall)},
                             {"lower_value", *low},
                             {"upper_value", *high}};
      if (const Json& loss = entry.at("loss_median"); loss.is_number())
        measures["loss"] = {{"value", loss}};
      double simulations = 0;
      for (const char* counter : {"forward", "vjp", "jacobian", "inverse"})
        simulations += entry.at(counter).get<double>();
      measures["simulations"] = {{"value", simulations}};
    }
    out[entry.at("name").get<std::string>()] = std::move(measures);
  }
  return out;
}

}  // namespace physinv
