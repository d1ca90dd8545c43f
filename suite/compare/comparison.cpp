#include "suite/compare/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "suite/evidence/statistics.h"
#include "suite/results/curves.h"

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

double median_loss(const StageRecord& s) {
  std::vector<double> loss;
  for (const double a : s.loss)
    loss.push_back(std::isfinite(a) ? a : kInfinite);
  return loss.empty() ? kInfinite : median(std::move(loss));
}

void add(Reading& reading, const StageRecord& s, const StageRecord* first) {
  ++reading.stages;
  if (first != nullptr && has_result(s) &&
      results_hash(s) == results_hash(*first))
    ++reading.same_bits;
  ++reading.ends[std::string(to_string(s.stop))];
  for (const Status status : s.status)
    ++reading.states[std::string(to_string(status))];
  reading.seconds += s.clocks.solve.wall;
  reading.iterations += s.iterations;
  reading.counts += s.counts;
}

Reading reading_of(const std::vector<const StageRecord*>& stages,
                   const std::vector<const StageRecord*>& first) {
  Reading reading;
  std::vector<double> losses;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    add(reading, *stages[i], first.empty() ? nullptr : first[i]);
    losses.push_back(median_loss(*stages[i]));
  }
  reading.loss = median(std::move(losses));
  return reading;
}

StageId group_of(StageId id, By by) {
  if (by != By::seed) id.seed = -1;
  if (by == By::method) id.n = -1;
  return id;
}

bool everywhere(const std::vector<const StageRecord*>& stages) {
  return std::find(stages.begin(), stages.end(), nullptr) == stages.end();
}

/// Those that all sides have; if there are none, those that each side has.
Compared compared(const StageId& id,
                  const std::vector<std::vector<const StageRecord*>>& group,
                  std::size_t sides) {
  const bool shared = std::any_of(group.begin(), group.end(), everywhere);
  Compared row{.id = id, .sides = {}};
  std::vector<const StageRecord*> first;
  for (std::size_t s = 0; s < sides; ++s) {
    std::vector<const StageRecord*> own;
    for (const auto& stages : group)
      if (stages[s] != nullptr && (!shared || everywhere(stages)))
        own.push_back(stages[s]);
    if (s == 0 && shared) first = own;
    row.sides.push_back(own.empty()
                            ? std::nullopt
                            : std::optional<Reading>(reading_of(own, first)));
  }
  return row;
}

double decades(double a, double b) {
  return a > 0 && b > 0 ? std::abs(std::log10(b / a)) : 0;
}

}  // namespace

double Reading::simulations() const {
  double sum = 0;
  for (const Counter c :
       {Counter::forward, Counter::vjp, Counter::jacobian, Counter::inverse})
    sum += static_cast<double>(counts[c]);
  return sum;
}

double Reading::passes() const {
  return static_cast<double>(counts[Counter::network_forward] +
                             counts[Counter::network_backward]);
}

double loss_ratio(const Reading& a, const Reading& b) {
  if (std::isinf(a.loss) && std::isinf(b.loss)) return 1;
  return std::max(b.loss, kSolvedLoss) / std::max(a.loss, kSolvedLoss);
}

std::string StageId::text() const {
  std::string out = experiment + "/" + method;
  if (n >= 0) out += fmt::format("/n={}", n);
  if (seed >= 0) out += fmt::format("/seed={}", seed);
  return out + " " + stage;
}

bool Compared::missing() const {
  return std::find(sides.begin(), sides.end(), std::nullopt) != sides.end();
}

bool Compared::ends_changed() const {
  return std::any_of(sides.begin(), sides.end(), [&](const auto& r) {
    return r && sides.front() && r->ends != sides.front()->ends;
  });
}

double Compared::change() const {
  double most = 0;
  for (const auto& r : sides) {
    if (!r || !sides.front()) continue;
    const Reading& a = *sides.front();
    const double ratio = loss_ratio(a, *r);
    const double loss =
        ratio > 0 && std::isfinite(ratio) ? std::abs(std::log10(ratio)) : 100;
    most = std::max({most,
                     loss,
                     decades(a.simulations(), r->simulations()),
                     decades(a.passes(), r->passes()),
                     decades(a.seconds, r->seconds)});
  }
  return most + (ends_changed() ? 1e3 : 0) + (missing() ? 1e6 : 0);
}

Comparison compare(const std::vector<Side>& sides, By by) {
  Comparison out;
  for (const Side& s : sides) out.labels.push_back(s.label);
  std::map<StageId, std::vector<std::vector<const StageRecord*>>> groups;
  for (auto& [id, stages] : pair_stages(sides))
    groups[group_of(id, by)].push_back(stages);
  for (const auto& [id, group] : groups)
    out.rows.push_back(compared(id, group, sides.size()));
  std::stable_sort(
      out.rows.begin(), out.rows.end(), [](const auto& a, const auto& b) {
        return a.change() > b.change();
      });
  return out;
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
  for (auto& [id, claim] : all) {
    const auto verdict = [](const std::optional<ClaimResult>& c) {
      return c ? c->verdict : Verdict::not_judged;
    };
    const auto first = verdict(claim.sides.front());
    if (std::any_of(claim.sides.begin(), claim.sides.end(), [&](const auto& c) {
          return verdict(c) != first;
        }))
      changed.push_back(std::move(claim));
  }
  return changed;
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
