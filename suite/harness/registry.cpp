#include "suite/harness/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <future>
#include <iterator>
#include <set>
#include <stdexcept>
#include <unordered_map>

#include "suite/harness/errors.h"
#include "suite/results/nearest.h"

namespace physinv {
namespace {

/// Fifty times the largest profile.
constexpr std::size_t kMostCases = 100'000;

Row overridden(Row row, const Overrides& o) {
  if (o.methods) row.methods = *o.methods;
  if (o.n) row.n = *o.n;
  if (o.seeds) row.seeds = *o.seeds;
  if (o.iterations) row.iterations = *o.iterations;
  if (o.precision) row.precision = *o.precision;
  return row;
}

void check_overrides(const Overrides& o,
                     const Registry::Experiments& experiments) {
  for (const Index n : o.n.value_or(std::vector<Index>{})) {
    if (n < 1)
      throw UsageError(
          fmt::format("n={} has no problems; n must be at least 1", n));
  }
  if (o.iterations && *o.iterations < 1)
    throw UsageError("iterations must be at least 1");
  for (const auto& id : o.methods.value_or(std::vector<std::string>{})) {
    std::set<std::string> known;
    for (const auto& e : experiments)
      for (const Method& m : e->methods) known.insert(m.id);
    if (!known.contains(id))
      throw UsageError(fmt::format(
          "unknown method '{}' of {}; nearest: {}",
          id,
          known.size(),
          fmt::join(nearest_words({known.begin(), known.end()}, id), ", ")));
  }
}

/// Two rows may name the same case only if they mean the same.
bool same_work(const Case& a, const Case& b) {
  return a.stage_iterations == b.stage_iterations &&
         a.info.precision == b.info.precision;
}

}  // namespace

void Registry::add(Experiment experiment) {
  if (auto claims = claims_.extract(experiment.name))
    std::move(claims.mapped().begin(),
              claims.mapped().end(),
              std::back_inserter(experiment.claims));
  if (auto report = reports_.extract(experiment.name))
    experiment.report = std::move(report.mapped());
  experiments_.push_back(std::make_shared<Experiment>(std::move(experiment)));
}

Experiment* Registry::registered(const std::string& name) {
  const auto e = find(name);
  return std::const_pointer_cast<Experiment>(e).get();
}

void Registry::add_claims(const std::string& experiment,
                          std::vector<Claim> claims) {
  Experiment* there = registered(experiment);
  auto& all = there != nullptr ? there->claims : claims_[experiment];
  std::move(claims.begin(), claims.end(), std::back_inserter(all));
}

void Registry::add_report(const std::string& experiment, Report report) {
  Experiment* there = registered(experiment);
  (there != nullptr ? there->report : reports_[experiment]) = std::move(report);
}

void Registry::add(Overview overview) {
  overviews_.push_back(std::move(overview));
}

std::shared_ptr<const Experiment> Registry::find(std::string_view name) const {
  for (const auto& e : experiments_)
    if (e->name == name) return e;
  return nullptr;
}

std::vector<std::string> Registry::unknown_printed(
    const Published& published) const {
  std::vector<std::string> wrong;
  const auto add = [&](const auto& claims, const std::string& of) {
    for (auto& line : physinv::unknown_printed(claims, of, published))
      wrong.push_back(std::move(line));
  };
  for (const auto& e : experiments_) add(e->claims, e->name);
  for (const Overview& o : overviews_) add(o.claims, o.paper);
  return wrong;
}

void Registry::validate() const {
  const auto wrong = problems();
  if (!wrong.empty())
    throw std::logic_error(fmt::format("{}", fmt::join(wrong, "; ")));
}

std::vector<std::string> Registry::profiles() const {
  std::vector<std::string> names;
  for (const auto& e : experiments_) {
    // A new one is put in front of the next that is known.
    auto next = names.end();
    for (auto p = e->profiles.rbegin(); p != e->profiles.rend(); ++p) {
      const auto known = std::find(names.begin(), names.end(), p->name);
      next = known != names.end() ? known : names.insert(next, p->name);
    }
  }
  return names;
}

std::vector<Case> Registry::expand(std::string_view profile,
                                   const Overrides& overrides) const {
  const auto known = profiles();
  if (std::find(known.begin(), known.end(), profile) == known.end())
    throw UsageError(fmt::format("unknown profile '{}'; known profiles: {}",
                                 profile,
                                 fmt::join(known, ", ")));
  check_overrides(overrides, experiments_);
  const bool as_declared = !overrides.n && !overrides.iterations &&
                           !overrides.methods && !overrides.seeds &&
                           !overrides.precision;
  std::vector<Case> cases;
  std::unordered_map<std::string, std::size_t> by_name;
  std::size_t count = 0;
  // Before any is made, which takes longer than to count.
  const auto add_count = [&](const Experiment& e, const Row& row) {
    const auto there = std::count_if(
        row.methods.begin(), row.methods.end(), [&](const auto& id) {
          return find_method(e, id) != nullptr;
        });
    count += row.n.size() * row.seeds.size() * static_cast<std::size_t>(there);
    if (count > kMostCases)
      throw UsageError(fmt::format(
          "profile {} would have more than {} cases; give fewer n or seeds",
          profile,
          kMostCases));
  };
  const auto add = [&](Case c) {
    const auto [at, is_new] = by_name.emplace(c.info.name, cases.size());
    if (is_new) {
      cases.push_back(std::move(c));
    } else if (as_declared && !same_work(cases[at->second], c)) {
      throw std::logic_error(
          fmt::format("{} is in two rows of profile {} with different options",
                      c.info.name,
                      profile));
    }
  };
  for (const auto& e : experiments_) {
    for (const Profile& p : e->profiles) {
      if (p.name != profile) continue;
      const auto size = std::async(std::launch::deferred, [e] {
                          return size_of(*e);
                        }).share();
      for (const Row& declared : p.rows) {
        const Row row = overridden(declared, overrides);
        add_count(*e, row);
        for (const Index n : row.n) {
          for (const auto& id : row.methods) {
            const Method* method = find_method(*e, id);
            if (method == nullptr) continue;  // another experiment has it
            for (const auto seed : row.seeds)
              add(declared_case(e, *method, p.name, row, n, seed, size));
          }
        }
      }
    }
  }
  return cases;
}

Registry& registry() {
  // Not destroyed at exit, which would take time for nothing.
  static auto& the = *new Registry;
  return the;
}

bool register_experiment(Experiment experiment) {
  registry().add(std::move(experiment));
  return true;
}

}  // namespace physinv
