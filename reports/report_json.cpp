#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <stdexcept>

#include "reports/report.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

Json optional_number(std::optional<double> value) {
  return value ? Json(*value) : Json(nullptr);
}

Json to_json(const Series& s) {
  return {{"label", s.label},
          {"method", s.method},
          {"x", s.x},
          {"y", s.y},
          {"lo", s.lo},
          {"hi", s.hi},
          {"line", s.line},
          {"markers", s.markers},
          {"dashed", s.dashed}};
}

Json to_json(const Panel& p) {
  Json out{{"title", p.title},
           {"x_label", p.x_label},
           {"y_label", p.y_label},
           {"x_log", p.x_log},
           {"y_log", p.y_log},
           {"y_min", optional_number(p.y_min)},
           {"y_max", optional_number(p.y_max)},
           {"series", Json::array()},
           {"field", nullptr},
           {"arrows", nullptr}};
  if (p.x_min) out["x_min"] = *p.x_min;
  if (p.x_max) out["x_max"] = *p.x_max;
  if (p.space) out["space"] = true;
  for (const Series& s : p.series) out["series"].push_back(to_json(s));
  if (p.field) {
    out["field"] = {{"label", p.field->label},
                    {"log_scale", p.field->log_scale},
                    {"x", p.field->x},
                    {"x_names", p.field->x_names},
                    {"y_names", p.field->y_names},
                    {"y", p.field->y},
                    {"min", optional_number(p.field->min)},
                    {"max", optional_number(p.field->max)},
                    {"values", p.field->values}};
  }
  if (p.arrows) {
    out["arrows"] = {{"x", p.arrows->x},
                     {"y", p.arrows->y},
                     {"u", p.arrows->u},
                     {"v", p.arrows->v},
                     {"length", p.arrows->length}};
  }
  return out;
}

}  // namespace

nlohmann::ordered_json to_json(const Figure& figure) {
  Json out{{"id", figure.id},
           {"title", figure.title},
           {"source", figure.where},
           {"columns", figure.columns},
           {"moment", figure.moment},
           {"panels", Json::array()},
           {"note", figure.note}};
  for (const Panel& p : figure.panels) out["panels"].push_back(to_json(p));
  return out;
}

namespace {

Json to_json(const std::vector<ConditionResult>& conditions) {
  Json out = Json::array();
  for (const ConditionResult& c : conditions) {
    const bool finite = c.value && std::isfinite(*c.value);
    out.push_back({{"label", c.label},
                   {"bounds", c.bounds},
                   {"value", finite ? Json(*c.value) : Json(nullptr)},
                   {"spread", optional_number(c.spread)},
                   {"runs", c.runs},
                   {"holds", c.holds ? Json(*c.holds) : Json(nullptr)},
                   {"missing", c.missing}});
    if (!c.shown.empty()) out.back()["shown"] = c.shown;
  }
  return out;
}

std::vector<ConditionResult> conditions_from(const Json& list) {
  const auto number = [](const Json& value) {
    return value.is_number() ? std::optional(value.get<double>())
                             : std::nullopt;
  };
  std::vector<ConditionResult> out;
  for (const Json& c : list) {
    const Json& holds = c.at("holds");
    out.push_back({.label = c.at("label"),
                   .bounds = c.at("bounds"),
                   .value = number(c.at("value")),
                   .spread = number(c.at("spread")),
                   .runs = c.at("runs"),
                   .holds = holds.is_boolean()
                                ? std::optional(holds.get<bool>())
                                : std::nullopt,
                   .missing = c.at("missing"),
                   .shown = c.value("shown", "")});
    // One that is not finite is null, and was still decided.
    if (!out.back().value && out.back().holds) out.back().value = INFINITY;
  }
  return out;
}

}  // namespace

nlohmann::ordered_json to_json(const ClaimResult& claim) {
  return {{"id", claim.id},
          {"says", claim.says},
          {"from", claim.from},
          {"gates", claim.gates},
          {"verdict", words_of(claim.verdict)},
          {"evidence", claim.evidence},
          {"origin", claim.origin == Origin::paper ? "paper" : "suite"},
          {"where", claim.where},
          {"note", claim.note},
          {"cause", claim.cause},
          {"conditions", to_json(claim.conditions)},
          {"shown_by", to_json(claim.shown_by)}};
}

ClaimResult claim_from(const Json& claim) {
  const std::string words = claim.at("verdict");
  const auto verdict = verdict_of(words);
  if (!verdict)
    throw std::runtime_error(fmt::format(
        "not a digest of a campaign: '{}' is not a verdict", words));
  const bool paper = claim.at("origin") == "paper";
  return {
      .id = claim.at("id"),
      .says = claim.at("says"),
      .from = claim.value("from", ""),
      .gates = claim.value("gates", true),
      .verdict = *verdict,
      .evidence = claim.at("evidence"),
      .origin = paper ? Origin::paper : Origin::suite,
      .where = claim.value("where", ""),
      .note = claim.value("note", ""),
      .conditions = conditions_from(claim.value("conditions", Json::array())),
      .cause = claim.value("cause", ""),
      .shown_by = conditions_from(claim.value("shown_by", Json::array()))};
}

}  // namespace physinv
