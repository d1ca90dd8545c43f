#include "suite/compare/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "suite/core/math.h"

namespace physinv {
namespace {

/// One stage on each side, null where a side lacks it.
using Paired = std::map<StageId, std::vector<const StageRecord*>>;

Paired pair_stages(const std::vector<Side>& sides) {
  Paired paired;
  for (std::size_t s = 0; s < sides.size(); ++s) {
    for (const CaseRecord& c : sides[s].results.cases()) {
      for (const StageRecord& stage : c.stages) {
        auto& all = paired[{c.info.experiment,
                            c.info.method,
                            c.info.n,
                            static_cast<std::int64_t>(c.info.seed),
                            stage.stage}];
        all.resize(sides.size());
        all[s] = &stage;
      }
    }
  }
  return paired;
}

StageId group_id(StageId id, By by) {
  if (by != By::seed) id.seed = -1;
  if (by == By::method) id.n = -1;
  return id;
}

/// What every side says of one stage.
Compared stage_of(const StageId& id,
                  const std::vector<const StageRecord*>& stages,
                  const std::vector<Side>& sides,
                  const Thresholds& thresholds) {
  Compared line{.id = id, .sides = {}, .members = {}};
  for (std::size_t s = 0; s < sides.size(); ++s) {
    line.sides.emplace_back();
    if (stages[s] != nullptr)
      line.sides.back() = reading_of(*stages[s], stages.front(), thresholds);
  }
  return line;
}

/// Of the stages that all sides have; if there are none, of those that each
/// side has.
Compared group_of(const StageId& id, std::vector<Compared> stages) {
  const bool shared = std::any_of(
      stages.begin(), stages.end(), [](auto& s) { return !s.missing(); });
  Compared line{.id = id, .sides = {}, .members = std::move(stages)};
  for (std::size_t s = 0; s < line.members.front().sides.size(); ++s) {
    std::vector<const Reading*> own;
    for (const Compared& stage : line.members)
      if (stage.sides[s] && (!shared || !stage.missing()))
        own.push_back(&*stage.sides[s]);
    line.sides.emplace_back();
    if (!own.empty()) line.sides.back() = reading_of(own);
  }
  return line;
}

double decades(double ratio) {
  return ratio > 0 && std::isfinite(ratio) ? std::abs(math::log10(ratio)) : 0;
}

/// b over a; 1 if both are 0.
std::optional<double> ratio_of(double a, double b) {
  if (a == b) return 1;
  return a > 0 ? std::optional(b / a) : std::nullopt;
}

std::optional<double> ratio_of_work(const Reading& a,
                                    const Reading& b,
                                    double (Reading::*work)() const) {
  return costs_compare(a, b) ? ratio_of((a.*work)(), (b.*work)())
                             : std::nullopt;
}

double change_of(const Reading& a, const Reading& b) {
  constexpr double kMost = 100;  // to a loss that is not finite, or from one
  const double loss = loss_ratio(a, b);
  double most = std::isfinite(loss) && loss > 0 ? decades(loss) : kMost;
  for (const auto& ratio : {ratio_of_work(a, b, &Reading::simulations),
                            ratio_of_work(a, b, &Reading::passes),
                            raised_ratio(time_ratio(a, b))})
    most = std::max(most, decades(ratio.value_or(1)));
  return most;
}

bool within(std::optional<double> ratio, double factor) {
  return !ratio || *ratio == 1 || (*ratio<factor&& * ratio> 1 / factor);
}

bool same_apart_from_noise(const Reading& a,
                           const Reading& b,
                           const Thresholds& thresholds) {
  constexpr double kEqual = 1.01;
  return a.ends == b.ends && a.statuses == b.statuses &&
         a.nonfinite == b.nonfinite && a.solved == b.solved &&
         within(loss_ratio(a, b), kEqual) &&
         within(ratio_of_work(a, b, &Reading::simulations), kEqual) &&
         within(ratio_of_work(a, b, &Reading::passes), kEqual) &&
         within(raised_ratio(time_ratio(a, b)), thresholds.factor);
}

/// Larger is worse.
using Badness = std::tuple<int, double, double>;
Badness badness(const Compared& stage, std::size_t side) {
  const auto& a = stage.sides.front();
  const auto& b = stage.sides[side];
  if (!a) return {-1, 0, 0};
  if (!b) return {2, 0, 0};
  return {end_direction(*a, *b) == Direction::worse ? 1 : 0,
          loss_ratio(*a, *b),
          raised_ratio(time_ratio(*a, *b)).value_or(0)};
}

/// Ratios of a side's pairs.
class Ratios {
 public:
  void add(std::optional<double> ratio) {
    if (ratio) all_.push_back(*ratio);
  }
  std::size_t count() const { return all_.size(); }
  std::optional<Quartiles> quartiles() const {
    return all_.empty() ? std::nullopt : std::optional(quartiles_of(all_));
  }

 private:
  std::vector<double> all_;
};

}  // namespace

std::string StageId::text() const {
  std::string out = experiment + "/" + method;
  if (n >= 0) out += fmt::format("/n={}", n);
  if (seed >= 0) out += fmt::format("/seed={}", seed);
  return out + " " + stage;
}

std::span<const Compared> Compared::stages() const {
  return members.empty() ? std::span(this, 1) : std::span(members);
}

bool Compared::missing() const {
  return std::find(sides.begin(), sides.end(), std::nullopt) != sides.end();
}

bool Compared::ends_changed() const {
  const auto changed = [](const Compared& stage) {
    const auto& a = stage.sides.front();
    return std::any_of(
        stage.sides.begin(), stage.sides.end(), [&](const auto& b) {
          return a && b && a->ends != b->ends;
        });
  };
  return std::any_of(stages().begin(), stages().end(), changed);
}

bool Compared::unchanged_on(std::size_t side,
                            const Thresholds& thresholds) const {
  return std::all_of(stages().begin(), stages().end(), [&](const auto& stage) {
    const auto &a = stage.sides.front(), &b = stage.sides[side];
    return a && b && same_apart_from_noise(*a, *b, thresholds);
  });
}

bool Compared::unchanged(const Thresholds& thresholds) const {
  for (std::size_t s = 1; s < sides.size(); ++s)
    if (!unchanged_on(s, thresholds)) return false;
  return true;
}

double Compared::change() const {
  double most = 0;
  for (const Compared& stage : members) most = std::max(most, stage.change());
  if (!members.empty()) return most;
  for (const auto& b : sides)
    if (b && sides.front())
      most = std::max(most, change_of(*sides.front(), *b));
  return most + (ends_changed() ? 1e3 : 0);
}

Against against(const Compared& line, std::size_t side) {
  Against sum;
  Ratios loss, time, raised, simulations, passes;
  for (const Compared& stage : line.stages()) {
    const auto& a = stage.sides.front();
    const auto& b = stage.sides[side];
    if (a && (sum.worst == nullptr ||
              badness(stage, side) > badness(*sum.worst, side)))
      sum.worst = &stage;
    if (!a || !b) continue;
    ++sum.pairs;
    const double ratio = loss_ratio(*a, *b);
    sum.wins += ratio < 1;
    sum.ties += ratio == 1;
    sum.worse += end_direction(*a, *b) == Direction::worse;
    loss.add(ratio);
    const TimeRatio times = time_ratio(*a, *b);
    if (!times.why.empty()) sum.no_time = times.why;
    time.add(times.value);
    raised.add(raised_ratio(times));
    simulations.add(ratio_of_work(*a, *b, &Reading::simulations));
    passes.add(ratio_of_work(*a, *b, &Reading::passes));
  }
  sum.timed = time.count();
  sum.loss = loss.quartiles();
  sum.time = time.quartiles();
  sum.raised_time = raised.quartiles();
  sum.simulations = simulations.quartiles();
  sum.passes = passes.quartiles();
  return sum;
}

Comparison compare(const std::vector<Side>& sides,
                   By by,
                   const Thresholds& thresholds) {
  Comparison out{.labels = {}, .rows = {}, .thresholds = thresholds};
  for (const Side& s : sides) out.labels.push_back(s.label);
  std::map<StageId, std::vector<Compared>> groups;
  for (const auto& [id, stages] : pair_stages(sides))
    groups[group_id(id, by)].push_back(stage_of(id, stages, sides, thresholds));
  for (auto& [id, stages] : groups)
    out.rows.push_back(by == By::seed ? std::move(stages.front())
                                      : group_of(id, std::move(stages)));
  std::stable_sort(
      out.rows.begin(), out.rows.end(), [](const auto& a, const auto& b) {
        return std::pair(a.missing(), -a.change()) <
               std::pair(b.missing(), -b.change());
      });
  return out;
}

Comparison common(const Comparison& all) {
  Comparison own{all.labels, {}, all.thresholds};
  for (const Compared& row : all.rows)
    if (!row.missing()) own.rows.push_back(row);
  return own;
}

Comparison changed(const Comparison& all) {
  Comparison own{all.labels, {}, all.thresholds};
  for (const Compared& row : all.rows)
    if (!row.unchanged(all.thresholds)) own.rows.push_back(row);
  return own;
}

std::string ChangedClaim::id() const {
  for (const auto& side : sides)
    if (side) return side->id;
  return "";
}

Verdict ChangedClaim::verdict(std::size_t side) const {
  return sides[side] ? sides[side]->verdict : Verdict::not_judged;
}

std::vector<ChangedClaim> changed_claims(const std::vector<Side>& sides) {
  std::map<std::pair<std::string, std::string>, ChangedClaim> all;
  for (std::size_t s = 0; s < sides.size(); ++s) {
    for (const JudgedClaim& c : sides[s].claims) {
      ChangedClaim& found = all[{c.experiment, c.claim.id}];
      found.experiment = c.experiment;
      found.sides.resize(sides.size());
      found.sides[s] = c.claim;
    }
  }
  std::vector<ChangedClaim> changed;
  for (auto& [id, claim] : all)
    for (std::size_t s = 1; s < sides.size(); ++s)
      if (claim.verdict(s) != claim.verdict(0)) {
        changed.push_back(std::move(claim));
        break;
      }
  return changed;
}

std::vector<ChangedClaim> judged_everywhere(
    const std::vector<ChangedClaim>& changed) {
  std::vector<ChangedClaim> judged;
  for (const ChangedClaim& claim : changed) {
    bool all = true;
    for (std::size_t s = 0; s < claim.sides.size(); ++s)
      all = all && claim.verdict(s) != Verdict::not_judged;
    if (all) judged.push_back(claim);
  }
  return judged;
}

std::vector<Side> sides_by_revision(const std::vector<Side>& sides) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<CaseRecord>> cases;
  for (const Side& side : sides) {
    for (const CaseRecord& c : side.results.cases()) {
      std::map<std::string, CaseRecord> parts;
      for (const StageRecord& s : c.stages) {
        auto& part =
            parts.try_emplace(s.revision, CaseRecord{c.info, c.data, {}})
                .first->second;
        part.stages.push_back(s);
      }
      for (auto& [revision, part] : parts) {
        if (!cases.contains(revision)) order.push_back(revision);
        cases[revision].push_back(std::move(part));
      }
    }
  }
  std::vector<Side> out;
  for (const auto& revision : order)
    out.push_back({.label = revision.substr(0, 12),
                   .results = Results(std::move(cases[revision])),
                   .claims = {}});
  return out;
}

Results pooled(const std::vector<Side>& sides) {
  std::vector<CaseRecord> all;
  for (const Side& side : sides) {
    for (CaseRecord c : side.results.cases()) {
      c.info.method += ", " + side.label;
      all.push_back(std::move(c));
    }
  }
  return Results(std::move(all));
}

}  // namespace physinv
