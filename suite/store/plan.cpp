#include "suite/store/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "suite/store/folder.h"
#include "suite/store/json.h"
#include "suite/store/names.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kPlanVersion = 2;
constexpr std::string_view kRenew =
    "run the campaign's command there again: finished stages are reused";

bool is_text(const json& j) { return j.is_string(); }
bool is_name(const json& j) {
  return is_text(j) && is_case_name(j.get_ref<const std::string&>());
}
bool is_stage(const json& j) {
  return is_text(j) && physinv::is_word(j.get_ref<const std::string&>());
}
bool is_key_text(const json& j) {
  return is_text(j) && is_key(j.get_ref<const std::string&>());
}

template <class Is>
bool is_list(const json& j, Is&& is) {
  return j.is_array() && std::all_of(j.begin(), j.end(), is);
}

/// By the name of a case.
template <class Is>
bool is_table(const json& j, Is&& is) {
  if (!j.is_object()) return false;
  for (const auto& [name, value] : j.items())
    if (!is_case_name(name) || !is(value)) return false;
  return true;
}

template <bool (*is)(const json&)>
bool is_table_of_lists(const json& j) {
  return is_table(j, [](const json& list) { return is_list(list, is); });
}

/// What is there of an object has its type.
template <class Is>
bool may_hold(const json& object, const char* key, Is&& is) {
  const auto at = object.find(key);
  return at == object.end() || is(*at);
}

/// The flags of the run that are read again.
bool are_options(const json& j) {
  const auto texts = [](const json& all) { return is_list(all, is_text); };
  if (j.is_null()) return true;
  if (!j.is_object() || !may_hold(j, "filter", texts) ||
      !may_hold(j, "set", texts))
    return false;
  for (const char* key : {"profile", "seeds", "shard", "cases", "out"})
    if (!may_hold(j, key, is_text)) return false;
  return true;
}

bool well_formed(const json& plan) {
  if (!plan.is_object()) return false;
  const auto holds = [&](const char* key, auto&& is) {
    return plan.contains(key) && may_hold(plan, key, is);
  };
  return holds("cases", [](const json& j) { return is_list(j, is_name); }) &&
         holds("context",
               [](const json& j) {
                 return j.is_object() && may_hold(j, "options", are_options) &&
                        may_hold(j, "physinv", [](const json& own) {
                          return own.is_object();
                        });
               }) &&
         holds("profile", is_text) && holds("fingerprint", is_text) &&
         holds("schema_version",
               [](const json& j) { return j.is_number_integer() && j > 0; }) &&
         may_hold(plan,
                  "recipes",
                  [](const json& j) { return is_table(j, is_text); }) &&
         may_hold(plan, "keys", is_table_of_lists<is_key_text>) &&
         may_hold(plan, "stages", is_table_of_lists<is_stage>) &&
         may_hold(plan, "results", is_text) &&
         may_hold(plan, "merged", [](const json& j) { return j.is_boolean(); });
}

bool intact(const json& plan) {
  if (!well_formed(plan)) return false;
  // One wrong byte cannot turn a plan with a checksum into one without.
  if (plan["schema_version"] == 1 && !plan.contains("checksum")) return true;
  return plan.value("checksum", json()) == checksum_of(plan);
}

}  // namespace

json make_plan(const std::vector<CaseInfo>& cases,
               const json& context,
               std::vector<PlannedCase> campaign) {
  if (campaign.empty())
    for (const auto& info : cases) campaign.push_back({info.name, ""});
  json names = json::array(), recipes = json::object();
  json keys = json::object(), stages = json::object();
  for (const auto& c : campaign) {
    names.push_back(c.name);
    if (!c.recipe.empty()) recipes[c.name] = c.recipe;
  }
  for (const auto& info : cases) {
    keys[info.name] = info.keys;
    stages[info.name] = info.stages;
  }
  return {{"schema_version", kPlanVersion},
          {"cases", std::move(names)},
          {"recipes", std::move(recipes)},
          {"keys", std::move(keys)},
          {"stages", std::move(stages)},
          {"profile", cases.empty() ? "" : cases.front().profile},
          {"fingerprint", context.value("fingerprint", "")},
          {"context", context}};
}

json extend_plan(const json& earlier, json plan) {
  if (!earlier.is_object()) return plan;
  for (const char* what : {"profile", "fingerprint"})
    if (earlier.at(what) != plan.at(what)) return plan;
  const std::vector<std::string> old = earlier.at("cases");
  const std::vector<std::string> now = plan.at("cases");
  const std::set<std::string> asked(now.begin(), now.end());
  if (std::any_of(old.begin(), old.end(), [&](const auto& name) {
        return !asked.contains(name);
      })) {
    json names = old;
    const std::set<std::string> seen(old.begin(), old.end());
    for (const auto& name : now)
      if (!seen.contains(name)) names.push_back(name);
    plan["cases"] = std::move(names);
  }
  for (const char* what : {"recipes", "keys", "stages"}) {
    json all = earlier.value(what, json::object());
    all.update(plan.value(what, json::object()));
    plan[what] = std::move(all);
  }
  return plan;
}

std::string plan_text(json plan) {
  plan["schema_version"] = kPlanVersion;
  plan["checksum"] = checksum_of(plan);
  return plan.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

json read_plan(const fs::path& path, std::string* warning) {
  const Folder store(path.has_parent_path() ? path.parent_path() : ".");
  if (!store.has(path.filename())) {
    *warning =
        fmt::format("{} is missing, so the selected cases are unknown ({})",
                    path.string(),
                    kRenew);
    return nullptr;
  }
  return parse_plan(store.read(path.filename(), kLargestText), path, warning);
}

json parse_plan(std::string_view bytes,
                const fs::path& path,
                std::string* warning) {
  json plan;
  try {
    plan = parse_json(bytes);
  } catch (const std::exception&) {  // as damaged as one of wrong types
  }
  const json version =
      plan.is_object() ? plan.value("schema_version", json()) : json();
  if (version.is_number_integer() && version > kPlanVersion)
    throw UnreadableInput(
        fmt::format("{} has a newer schema than this program reads, {} (use "
                    "the program that wrote it or a newer one)",
                    path.string(),
                    kPlanVersion));
  if (!intact(plan))
    throw StoreError(
        fmt::format("{} is damaged: its checksum or its content is wrong "
                    "(delete it and {})",
                    path.string(),
                    kRenew));
  if (version == 1)
    *warning = fmt::format(
        "{} was written by an older version, without a checksum ({})",
        path.string(),
        kRenew);
  return plan;
}

std::vector<std::string> planned_keys(const json& plan,
                                      const std::string& case_name,
                                      std::vector<std::string> otherwise) {
  if (!plan.is_object() || !plan.contains("keys")) return otherwise;
  return plan["keys"].value(case_name, std::move(otherwise));
}

std::vector<std::string> planned_stages(const json& plan,
                                        const std::string& case_name) {
  const std::vector<std::string> none;
  if (!plan.is_object() || !plan.contains("stages")) return none;
  return plan["stages"].value(case_name, none);
}

}  // namespace physinv
