#include "suite/results/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "suite/results/checksum.h"
#include "suite/results/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kPlanVersion = 2;
constexpr std::string_view kRenew =
    "run the campaign's command there again: finished stages are kept";

std::string checksum(json plan) {
  plan.erase("checksum");
  return fmt::format(
      "{:08x}",
      crc32c(plan.dump(-1, ' ', false, json::error_handler_t::replace)));
}

bool well_formed(const json& plan) {
  const auto holds = [&](const char* key, auto&& is) {
    const auto at = plan.find(key);
    return at != plan.end() && is(*at);
  };
  const auto object = [](const json& j) { return j.is_object(); };
  const auto text = [](const json& j) { return j.is_string(); };
  return plan.is_object() &&
         holds("cases",
               [&](const json& j) {
                 return j.is_array() && std::all_of(j.begin(), j.end(), text);
               }) &&
         holds("context", object) && holds("profile", text) &&
         holds("fingerprint", text) && holds("schema_version", [](auto& j) {
           return j.is_number_integer() && j > 0;
         });
}

bool intact(const json& plan) {
  if (!well_formed(plan)) return false;
  // One wrong byte cannot turn a plan with a checksum into one without.
  if (plan["schema_version"] == 1 && !plan.contains("checksum")) return true;
  return plan.value("checksum", json()) == checksum(plan);
}

}  // namespace

json make_plan(const std::vector<CaseInfo>& cases,
               const json& context,
               std::vector<PlannedCase> campaign) {
  if (campaign.empty())
    for (const auto& info : cases) campaign.push_back({info.name, ""});
  json names = json::array(), recipes = json::object(), keys = json::object();
  for (const auto& c : campaign) {
    names.push_back(c.name);
    if (!c.recipe.empty()) recipes[c.name] = c.recipe;
  }
  for (const auto& info : cases) keys[info.name] = info.keys;
  return {{"schema_version", kPlanVersion},
          {"cases", std::move(names)},
          {"recipes", std::move(recipes)},
          {"keys", std::move(keys)},
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
  for (const char* what : {"recipes", "keys"}) {
    json all = earlier.value(what, json::object());
    all.update(plan.at(what));
    plan[what] = std::move(all);
  }
  return plan;
}

std::string plan_text(json plan) {
  plan["schema_version"] = kPlanVersion;
  plan["checksum"] = checksum(plan);
  return plan.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

json read_plan(const fs::path& path, std::string* warning) {
  if (!fs::exists(path)) {
    *warning =
        fmt::format("{} is missing, so what was asked for is not known ({})",
                    path.string(),
                    kRenew);
    return nullptr;
  }
  json plan = json::parse(read_file(path), nullptr, false);
  if (plan.is_object() && plan.value("schema_version", json()) > kPlanVersion)
    throw UnreadableInput(
        fmt::format("{} has a newer schema than this program reads, {} (use "
                    "the program that wrote it or a newer one)",
                    path.string(),
                    kPlanVersion));
  if (!intact(plan))
    throw StoreError(
        fmt::format("{} is damaged: it fails its checksum (delete it and {})",
                    path.string(),
                    kRenew));
  if (plan["schema_version"] == 1)
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
  const auto at = plan["keys"].find(case_name);
  return at == plan["keys"].end() ? otherwise
                                  : at->get<std::vector<std::string>>();
}

}  // namespace physinv
