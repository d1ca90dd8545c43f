#include "suite/store/results_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "suite/core/median.h"
#include "suite/store/fields.h"
#include "suite/store/json.h"
#include "suite/store/repetitions.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTimeUnit = "ns";

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

double nanoseconds(double seconds) { return 1e9 * seconds; }

/// Middle of the losses; those that are not finite count as largest.
double median_loss(const Vector<double>& loss) {
  std::vector<double> v(loss.data(), loss.data() + loss.size());
  for (double& a : v)
    if (!std::isfinite(a)) a = std::numeric_limits<double>::infinity();
  return median(std::move(v));
}

void add_accuracy(Json& j, const Vector<double>& loss) {
  const bool any = loss.size() > 0;
  j["loss_mean"] = any ? number(loss.mean()) : nullptr;
  j["loss_median"] = any ? number(median_loss(loss)) : nullptr;
  j["loss_max"] = any ? number(loss.maxCoeff<Eigen::PropagateNaN>()) : nullptr;
  const auto solved = static_cast<double>((loss.array() < 1e-6).count());
  j["solved_1e-6"] =
      any ? number(solved / static_cast<double>(loss.size())) : nullptr;
}

Json statuses(const std::vector<Status>& status) {
  Json j = Json::object();
  for (const Status s : kValues<Status>)
    j[std::string(to_string(s))] = std::count(status.begin(), status.end(), s);
  return j;
}

Json run_context(const RunContext& run) {
  if (run.threads == 0) return nullptr;
  Json context{{"host_name", run.host},
               {"cpu_model", run.processor},
               {"instruction_set", run.instruction_set},
               {"threads", run.threads},
               {"jobs", run.jobs}};
  if (!run.thread_changes.empty())
    context["thread_changes"] = run.thread_changes;
  return context;
}

Json times(const StageRecord& s) {
  if (!has_time(s)) return nullptr;
  Json all;
  for (const auto& [name, clock] :
       {std::pair("wall", &Seconds::wall), {"cpu", &Seconds::cpu}}) {
    Json list = Json::array();
    for (const double t : solving_times(s, clock))
      list.push_back(number(nanoseconds(t)));
    all[name] = std::move(list);
  }
  return all;
}

Json details(const CaseRecord& c, const StageRecord& s) {
  Json options = Json::object(), counts = Json::object();
  for (const auto& [name, value] : s.options) options[name] = value;
  add_counts(counts, s.counts);
  const auto spent = [&](Seconds seconds) {
    return has_result(s) ? number(1e3 * seconds.wall) : Json(nullptr);
  };
  return {{"experiment", c.info.experiment},
          {"method", c.info.method},
          {"profile", profile_of(c, s)},
          {"n", c.info.n},
          {"seed", c.info.seed},
          {"precision", to_string(c.info.precision)},
          {"stage", s.stage},
          {"position", s.position},
          {"key", s.key},
          {"stop", to_string(s.stop)},
          {"message", s.message},
          {"setup_ms", spent(s.clocks.setup)},
          {"warmup_ms", spent(s.clocks.warmup)},
          {"data_ms", spent(s.clocks.data)},
          {"measure_ms", spent(s.clocks.measure)},
          {"times", times(s)},
          {"timed_on", run_context(s.run)},
          {"counts", has_result(s) ? std::move(counts) : Json(nullptr)},
          {"peak_buffer_bytes", s.buffer_bytes},
          {"rss_bytes", s.rss_bytes},
          {"crowded", s.crowded},
          {"statuses", statuses(s.status)},
          {"data_hash", c.data.hash},
          {"trajectory", s.trajectory},
          {"finished", s.finished},
          {"revision", s.revision},
          {"options", std::move(options)}};
}

Json measured_entry(const std::string& name,
                    const StageRecord& s,
                    int threads) {
  Json j{{"name", name},
         {"family_index", 0},
         {"per_family_instance_index", s.position},
         {"run_name", name},
         {"run_type", "iteration"},
         {"repetitions", 1 + s.repeated.size()},
         {"repetition_index", 0},
         {"threads", threads},
         {"iterations", s.iterations},
         {"real_time", number(nanoseconds(solving_time(s).wall))},
         {"cpu_time", number(nanoseconds(solving_time(s).cpu))},
         {"time_unit", kTimeUnit}};
  add_accuracy(j, s.loss);
  add_counts(j, s.counts);
  return j;
}

Json entry(const CaseRecord& c, const StageRecord& s, std::size_t family) {
  const std::string name = c.info.name + "/" + s.stage;
  Json j = has_time(s)
               ? measured_entry(name, s, std::max(1, s.run.threads))
               : error_entry(
                     name,
                     s.message.empty()
                         ? std::string(to_string(s.stop))
                         : fmt::format("{}: {}", to_string(s.stop), s.message));
  j["family_index"] = family;
  j["per_family_instance_index"] = s.position;
  j["physinv"] = details(c, s);
  return j;
}

/// The context with what every reader may rely on.
Json full_context(const nlohmann::json& given) {
  Json context{{"date", ""},
               {"host_name", ""},
               {"executable", "physinv-bench"},
               {"num_cpus", 0},
               {"mhz_per_cpu", 0},
               {"cpu_scaling_enabled", false},
               {"caches", Json::array()},
               {"load_avg", Json::array()},
               {"library_build_type", "release"},
               {"physinv", Json::object()}};
  for (const auto& [key, value] : given.items()) context[key] = value;
  context["physinv"]["schema_version"] = kResultsVersion;
  return context;
}

}  // namespace

Json error_entry(const std::string& name, const std::string& message) {
  // compare.py takes the times of every entry that is not an aggregate, and
  // pairs entries of one unit.
  return {{"name", name},
          {"family_index", 0},
          {"per_family_instance_index", 0},
          {"run_name", name},
          {"run_type", "aggregate"},
          {"aggregate_name", "error"},
          {"error_occurred", true},
          {"error_message", message},
          {"time_unit", "none"}};
}

Json results_json(const std::vector<CaseRecord>& cases,
                  const std::vector<std::string>& order,
                  const nlohmann::json& context) {
  std::map<std::string, const CaseRecord*> by_name;
  for (const auto& c : cases) by_name[c.info.name] = &c;
  Json entries = Json::array();
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto at = by_name.find(order[i]);
    if (at == by_name.end()) continue;
    for (const auto& stage : at->second->stages)
      entries.push_back(entry(*at->second, stage, i));
  }
  return {{"context", full_context(context)},
          {"benchmarks", std::move(entries)}};
}

double seconds_per_unit(const nlohmann::ordered_json& entry) {
  return entry.value("time_unit", "ms") == "ms" ? 1e-3 : 1e-9;
}

std::string results_text(const Json& results) {
  return results.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace physinv
