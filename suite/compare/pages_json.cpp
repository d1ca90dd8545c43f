#include <cmath>
#include <nlohmann/json.hpp>

#include "suite/compare/pages.h"
#include "suite/results/verdict_words.h"
#include "suite/store/json.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json number_or_null(const std::optional<double>& value) {
  return value ? finite(*value) : Json(nullptr);
}

Json to_json(const Quartiles& q) {
  return {{"median", finite(q.median)},
          {"low", finite(q.low)},
          {"high", finite(q.high)}};
}

Json to_json(const std::optional<Quartiles>& q) {
  return q ? to_json(*q) : Json(nullptr);
}

Json to_json(const Reading& r) {
  Json counts = Json::object(), ends = Json::object();
  Json statuses = Json::object();
  add_counts(counts, r.counts);
  for (const auto& [end, count] : r.ends)
    ends[std::string(to_string(end))] = count;
  for (const Status s : kStatuses)
    if (const Index n = r.statuses[static_cast<std::size_t>(s)]; n > 0)
      statuses[std::string(to_string(s))] = n;
  return {{"stages", r.stages},
          {"same_bits", r.same_bits},
          {"loss_median", finite(r.loss.median)},
          {"loss", to_json(r.loss)},
          {"losses_not_finite", r.nonfinite},
          {"seconds", r.times ? finite(r.times->wall.median) : Json(nullptr)},
          {"wall_seconds", r.times ? to_json(r.times->wall) : Json(nullptr)},
          {"cpu_seconds", r.times ? to_json(r.times->cpu) : Json(nullptr)},
          {"threads", r.times ? Json(r.times->threads) : Json(nullptr)},
          {"crowded", r.times ? Json(r.times->crowded) : Json(nullptr)},
          {"iterations", r.iterations},
          {"ends", std::move(ends)},
          {"message", r.message},
          {"statuses", std::move(statuses)},
          {"counts", std::move(counts)}};
}

Json against_json(const Compared& row, std::size_t s) {
  const Against sum = against(row, s);
  Json worst = nullptr;
  if (sum.worst != nullptr) {
    const auto& a = sum.worst->sides.front();
    const auto& b = sum.worst->sides[s];
    worst = {
        {"n", sum.worst->id.n},
        {"seed", sum.worst->id.seed},
        {"loss_ratio", b ? finite(loss_ratio(*a, *b)) : Json(nullptr)},
        {"raised_time_ratio",
         b ? number_or_null(raised_ratio(time_ratio(*a, *b))) : Json(nullptr)},
        {"end", b ? Json(to_string(end_direction(*a, *b))) : Json("missing")},
        {"ends", b ? Json(end_text(*a, *b)) : Json(nullptr)}};
  }
  return {{"pairs", sum.pairs},
          {"wins", sum.wins},
          {"ties", sum.ties},
          {"worse_ends", sum.worse},
          {"timed", sum.timed},
          {"no_time", sum.no_time},
          {"loss_ratio", to_json(sum.loss)},
          {"time_ratio", to_json(sum.time)},
          {"simulations_ratio", to_json(sum.simulations)},
          {"passes_ratio", to_json(sum.passes)},
          {"worst", std::move(worst)}};
}

}  // namespace

Json to_json(const Comparison& c,
             const std::vector<ChangedClaim>& changed,
             const std::vector<SideRank>& ranks) {
  Json rows = Json::array(), claims = Json::array(), tests = Json::array();
  for (const SideRank& r : ranks)
    tests.push_back({{"experiment", r.experiment},
                     {"method", r.method},
                     {"stage", r.stage},
                     {"side", r.side},
                     {"problems", r.test.pairs},
                     {"lower", r.test.below},
                     {"equal", r.test.ties},
                     {"p", r.test.p},
                     {"p_holm", r.p}});
  for (const Compared& row : c.rows) {
    Json sides = Json::array();
    for (const auto& r : row.sides)
      sides.push_back(r ? to_json(*r) : Json(nullptr));
    Json held = Json::array();
    for (std::size_t s = 1; s < row.sides.size(); ++s)
      held.push_back(against_json(row, s));
    Json out{{"experiment", row.id.experiment},
             {"method", row.id.method},
             {"stage", row.id.stage},
             {"n", row.id.n < 0 ? Json(nullptr) : Json(row.id.n)},
             {"seed", row.id.seed < 0 ? Json(nullptr) : Json(row.id.seed)},
             {"sides", std::move(sides)},
             {"against_first", std::move(held)}};
    rows.push_back(std::move(out));
  }
  for (const ChangedClaim& claim : changed) {
    Json verdicts = Json::array();
    Json directions = Json::array();
    for (std::size_t s = 0; s < claim.sides.size(); ++s) {
      verdicts.push_back(claim.sides[s]
                             ? Json(words_of(claim.sides[s]->verdict))
                             : Json(nullptr));
      if (s > 0)
        directions.push_back(
            to_string(direction(claim.verdict(0), claim.verdict(s))));
    }
    claims.push_back({{"experiment", claim.experiment},
                      {"id", claim.id()},
                      {"verdicts", std::move(verdicts)},
                      {"directions", std::move(directions)}});
  }
  return {{"labels", c.labels},
          {"rows", std::move(rows)},
          {"changed_claims", std::move(claims)},
          {"rank_tests", std::move(tests)}};
}

}  // namespace physinv
