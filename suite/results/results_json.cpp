#include "suite/results/results_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "suite/core/median.h"
#include "suite/results/folder.h"
#include "suite/results/json.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFile = "results.json";

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

double milliseconds(double seconds) { return 1e3 * seconds; }

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

void add_counts(Json& j, const Counts& counts) {
  for (std::size_t i = 0; i < kCounters; ++i)
    j[std::string(kCounterNames[i])] = counts[static_cast<Counter>(i)];
}

Json statuses(const std::vector<Status>& status) {
  Json j = Json::object();
  for (const Status s :
       {Status::gtol, Status::maxiter, Status::linesearch, Status::nonfinite})
    j[std::string(to_string(s))] = std::count(status.begin(), status.end(), s);
  return j;
}

Json details(const CaseRecord& c, const StageRecord& s) {
  Json options = Json::object(), counts = Json::object();
  for (const auto& [name, value] : s.options) options[name] = value;
  add_counts(counts, s.counts);
  return {{"experiment", c.info.experiment},
          {"method", c.info.method},
          {"profile", c.info.profile},
          {"n", c.info.n},
          {"seed", c.info.seed},
          {"precision", to_string(c.info.precision)},
          {"stage", s.stage},
          {"position", s.position},
          {"key", s.key},
          {"stop", to_string(s.stop)},
          {"message", s.message},
          {"setup_ms", number(milliseconds(s.clocks.setup.wall))},
          {"warmup_ms", number(milliseconds(s.clocks.warmup.wall))},
          {"measure_ms", number(milliseconds(s.clocks.measure.wall))},
          {"counts", std::move(counts)},
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

Json entry(const CaseRecord& c,
           const StageRecord& s,
           std::size_t family,
           int threads) {
  const std::string name = c.info.name + "/" + s.stage;
  Json j{{"name", name},
         {"family_index", family},
         {"per_family_instance_index", s.position},
         {"run_name", name},
         {"run_type", "iteration"},
         {"repetitions", 1},
         {"repetition_index", 0},
         {"threads", threads},
         {"iterations", s.iterations},
         {"real_time", number(milliseconds(s.clocks.solve.wall))},
         {"cpu_time", number(milliseconds(s.clocks.solve.cpu))},
         {"time_unit", "ms"}};
  add_accuracy(j, s.loss);
  add_counts(j, s.counts);
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
  context["physinv"]["schema_version"] = kSchemaVersion;
  return context;
}

int threads_of(const nlohmann::json& context) {
  const auto at = context.find("options");
  return at != context.end() && at->is_object() && at->contains("threads") &&
                 at->at("threads").is_number_integer()
             ? at->at("threads").get<int>()
             : 1;
}

bool has_all(const Json& object,
             std::initializer_list<const char*> keys,
             bool (*is)(const Json&)) {
  return object.is_object() &&
         std::all_of(keys.begin(), keys.end(), [&](const char* key) {
           const auto at = object.find(key);
           return at != object.end() && is(*at);
         });
}

bool is_text(const Json& j) { return j.is_string(); }
bool is_number(const Json& j) { return j.is_number(); }
bool is_number_or_null(const Json& j) { return j.is_number() || j.is_null(); }

bool is_entry(const Json& j) {
  return has_all(j, {"name", "run_name", "time_unit"}, is_text) &&
         has_all(j,
                 {"family_index",
                  "per_family_instance_index",
                  "threads",
                  "iterations",
                  "forward",
                  "vjp",
                  "jacobian",
                  "inverse"},
                 is_number) &&
         has_all(
             j, {"real_time", "cpu_time", "loss_median"}, is_number_or_null) &&
         j.at("real_time").is_null() == j.at("cpu_time").is_null() &&
         j.contains("physinv") && has_all(j.at("physinv"), {"key"}, is_text);
}

bool are_results(const Json& j) {
  return j.is_object() && j.contains("context") &&
         j.at("context").is_object() && j.contains("benchmarks") &&
         j.at("benchmarks").is_array() &&
         std::all_of(
             j.at("benchmarks").begin(), j.at("benchmarks").end(), is_entry);
}

/// Takes out the checksum; false if there is another.
bool unseal(Json& results) {
  Json& context = results["context"];
  const auto own = context.find("physinv");
  if (own == context.end() || !own->is_object() || !own->contains("checksum"))
    return true;
  const Json sum = own->at("checksum");
  own->erase("checksum");
  return sum == checksum_of(results);
}

}  // namespace

Json sealed(Json results) {
  const auto sum = checksum_of(results);
  results["context"]["physinv"]["checksum"] = sum;
  return results;
}

Json read_results(const std::filesystem::path& directory) {
  return parse_results(Folder(directory).read(kFile, kLargestData),
                       directory / kFile);
}

Json parse_results(std::string_view bytes, const std::filesystem::path& path) {
  Json results;
  try {
    results = parse_json<Json>(bytes);
  } catch (const std::exception&) {  // as damaged as one of wrong types
  }
  if (!are_results(results) || !unseal(results))
    throw StoreError(fmt::format(
        "{} is damaged ('run' as before writes it again)", path.string()));
  return results;
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
      entries.push_back(entry(*at->second, stage, i, threads_of(context)));
  }
  return {{"context", full_context(context)},
          {"benchmarks", std::move(entries)}};
}

std::string results_text(const Json& results) {
  return results.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace physinv
