#include "suite/store/results_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "suite/store/catalog.h"
#include "suite/store/json.h"
#include "suite/store/repetitions.h"
#include "suite/store/results_json.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kResultsFile = "results.json";

[[noreturn]] void contradict(const Catalog& catalog, const std::string& what) {
  throw StoreError(
      fmt::format("{} contradicts the plan, the journal, the case file or the "
                  "repetitions about {}: one of them was edited (restore it; "
                  "if it is results.json, delete it and repeat the same 'run')",
                  (catalog.directory() / kResultsFile).string(),
                  what));
}

[[noreturn]] void refuse(const std::filesystem::path& path,
                         const std::string& why) {
  throw StoreError(
      fmt::format("{} is damaged: {} (repeat the same 'run' to write it again)",
                  path.string(),
                  why));
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
bool is_object(const Json& j) { return j.is_object(); }
bool is_boolean(const Json& j) { return j.is_boolean(); }
bool is_number(const Json& j) { return j.is_number(); }
bool is_number_or_null(const Json& j) { return j.is_number() || j.is_null(); }

bool are_times(const Json& j) {
  return j.is_array() && std::all_of(j.begin(), j.end(), is_number);
}

bool has_times(const Json& j) {
  const auto at = j.find("times");
  return at != j.end() && has_all(*at, {"wall", "cpu"}, are_times) &&
         at->at("wall").size() == at->at("cpu").size() &&
         !at->at("wall").empty();
}

bool is_error(const Json& j) {
  return j.at("error_occurred") == true &&
         has_all(j, {"error_message"}, is_text) && !j.contains("real_time") &&
         !j.contains("cpu_time");
}

bool is_measured(const Json& j) {
  return has_all(j,
                 {"threads",
                  "iterations",
                  "real_time",
                  "cpu_time",
                  "forward",
                  "vjp",
                  "jacobian",
                  "inverse"},
                 is_number) &&
         has_all(j, {"loss_median"}, is_number_or_null) &&
         has_all(j.at("physinv"), {"crowded"}, is_boolean) &&
         has_times(j.at("physinv"));
}

bool is_entry(const Json& j) {
  return has_all(j, {"name", "run_name", "time_unit"}, is_text) &&
         has_all(j, {"family_index", "per_family_instance_index"}, is_number) &&
         j.contains("physinv") && has_all(j.at("physinv"), {"key"}, is_text) &&
         (j.contains("error_occurred") ? is_error(j) : is_measured(j));
}

/// What is read of files of older programs.
bool is_old_entry(const Json& j) {
  return has_all(j, {"name", "time_unit"}, is_text) &&
         has_all(j, {"real_time", "cpu_time"}, is_number_or_null) &&
         has_all(j, {"physinv"}, is_object);
}

bool are_results(const Json& j) {
  return has_all(j, {"context"}, [](const Json& c) { return c.is_object(); }) &&
         has_all(j, {"benchmarks"}, [](const Json& b) { return b.is_array(); });
}

bool are_entries(const Json& results) {
  const Json& all = results.at("benchmarks");
  return std::all_of(
      all.begin(),
      all.end(),
      results_version(results) < kResultsVersion ? is_old_entry : is_entry);
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

/// An entry as far as it does not depend on what else was asked for.
Json own_part(Json entry) {
  entry.erase("family_index");
  return entry;
}

/// The run that an entry describes.
std::string run_of(const Json& entry) {
  const Json& own = entry.at("physinv");
  const auto text = [&](const char* key) {
    const auto at = own.find(key);
    return at != own.end() && at->is_string() ? at->get<std::string>() : "";
  };
  return fmt::format("{} {} {} {}",
                     entry.at("name").get<std::string>(),
                     text("key"),
                     text("finished"),
                     text("stop"));
}

/// By run, what the journal and the case files say of it.
using Truth = std::map<std::string, Json>;

Truth truth_of(const Json& own) {
  Truth truth;
  for (const Json& entry : own.at("benchmarks"))
    truth.emplace(run_of(entry), own_part(entry));
  return truth;
}

/// By name of a stage, the runs that the journal knows of, also those that
/// others have replaced.
std::map<std::string, std::set<std::string>> known_runs(
    const Catalog& catalog) {
  std::map<std::string, std::set<std::string>> runs;
  for (const JournalEntry& line : catalog.entries()) {
    const std::string name = line.info.name + "/" + line.stage.stage;
    runs[name].insert(fmt::format("{} {} {} {}",
                                  name,
                                  line.stage.key,
                                  line.stage.finished,
                                  to_string(line.stage.stop)));
  }
  return runs;
}

/// What is true of a run as the entry can tell it: earlier files of this
/// version have neither `data_ms` nor the status `ftol`, as which nothing ended
/// then.
Json as_told(Json truth, const Json& entry) {
  const Json& told = entry.at("physinv");
  Json& own = truth.at("physinv");
  if (!told.contains("data_ms")) own.erase("data_ms");
  const auto statuses = told.find("statuses");
  if (statuses != told.end() && !statuses->contains("ftol") &&
      own.at("statuses").at("ftol") == 0)
    own.at("statuses").erase("ftol");
  return truth;
}

/// Is an entry what is true of its run, or of a run that counts no more: its
/// line was replaced, torn or deleted?
bool agrees(const Json& entry,
            const Truth& truth,
            const std::map<std::string, std::set<std::string>>& known) {
  const std::string run = run_of(entry);
  if (const auto own = truth.find(run); own != truth.end())
    return as_told(own->second, entry) == own_part(entry);
  const auto runs = known.find(entry.at("name").get<std::string>());
  return runs == known.end() || runs->second.contains(run);
}

/// Is it from before the plan was written, as during a run?
bool is_earlier(const Json& results, const nlohmann::json& plan) {
  return plan.is_object() && plan.contains("results") &&
         plan.at("results") == checksum_of(results);
}

/// The name of a context's key in which plan.json differs.
std::string differing_key(const Json& context, const nlohmann::json& plan) {
  if (!plan.is_object() || !plan.contains("context")) return {};
  for (const auto& [key, value] : plan.at("context").items())
    if (key != "physinv" && nlohmann::json(context.value(key, Json())) != value)
      return key;
  return {};
}

/// Is the file as new as every stage? Then its context is the plan's, too.
bool tells_all(const Json& results, const Json& own) {
  std::set<std::string> told;
  for (const Json& entry : results.at("benchmarks")) told.insert(run_of(entry));
  const Json& all = own.at("benchmarks");
  return std::all_of(all.begin(), all.end(), [&](const Json& entry) {
    return told.contains(run_of(entry));
  });
}

/// As checked_cases says.
void check_results(const Catalog& catalog,
                   const std::vector<CaseRecord>& cases) {
  if (!Folder(catalog.directory()).has(kResultsFile)) return;
  const Json results = read_results(catalog.directory());
  const Json own = results_json(cases, catalog.order(), Json::object());
  check_entries(catalog, results, own);
  const auto key = differing_key(results.at("context"), catalog.plan);
  if (results_version(results) == kResultsVersion && !key.empty() &&
      !is_earlier(results, catalog.plan) && tells_all(results, own))
    contradict(catalog, fmt::format("the context's {}", key));
}

}  // namespace

int results_version(const Json& results) {
  const auto own = results.at("context").find("physinv");
  if (own == results.at("context").end() || !own->is_object()) return 1;
  const auto version = own->find("schema_version");
  return version != own->end() && version->is_number_integer()
             ? version->get<int>()
             : 1;
}

Json sealed(Json results) {
  const auto sum = checksum_of(results);
  results["context"]["physinv"]["checksum"] = sum;
  return results;
}

Json read_results(const std::filesystem::path& directory) {
  return parse_results(Folder(directory).read(kResultsFile, kLargestData),
                       directory / kResultsFile);
}

Json parse_results(std::string_view bytes, const std::filesystem::path& path) {
  Json results;
  try {
    results = parse_json<Json>(bytes);
  } catch (const std::exception&) {  // as damaged as one of wrong types
  }
  if (!are_results(results) || !are_entries(results))
    refuse(path, "it does not contain results");
  if (!unseal(results)) refuse(path, "it has a wrong checksum");
  return results;
}

void check_entries(const Catalog& catalog,
                   const Json& results,
                   const Json& own) {
  if (results_version(results) < kResultsVersion) return;
  const Truth truth = truth_of(own);
  const auto known = known_runs(catalog);
  for (const Json& entry : results.at("benchmarks"))
    if (!agrees(entry, truth, known))
      contradict(catalog, entry.at("name").get<std::string>());
}

std::vector<CaseRecord> checked_cases(const Catalog& catalog) {
  auto cases = catalog.cases();
  add_repetitions(cases, read_repetitions(catalog.directory()));
  check_results(catalog, cases);
  return cases;
}

}  // namespace physinv
