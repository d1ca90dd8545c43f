#include "suite/harness/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <future>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>

#include "suite/harness/errors.h"
#include "suite/harness/judge.h"
#include "suite/harness/sources.h"

namespace physinv {
namespace {

/// Fifty times the largest profile.
constexpr std::size_t kMostCases = 100'000;

bool is_word(std::string_view text, std::string_view extra = "") {
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || extra.find(c) != std::string_view::npos;
  });
}

bool is_path(std::string_view text) {
  return is_word(text, "/") && text.front() != '/' && text.back() != '/' &&
         text.find("//") == std::string_view::npos;
}

const Method* find_method(const Experiment& e, std::string_view id) {
  for (const Method& m : e.methods)
    if (m.id == id) return &m;
  return nullptr;
}

bool has_precision(const Method& method) {
  return std::any_of(method.chain.begin(),
                     method.chain.end(),
                     [](const auto& stage) { return stage->has_precision(); });
}

std::string method_ids(const Experiment& e) {
  std::vector<std::string> ids;
  for (const Method& m : e.methods) ids.push_back(m.id);
  return fmt::format("{}", fmt::join(ids, ", "));
}

/// Sizes of an experiment that do not change from case to case.
CaseSize size_of(const Experiment& e) {
  const auto problem = e.problem.make<double>();
  CaseSize size{};
  size.shape = problem->shape();
  size.problem_operations = problem->operations();
  const auto operations = [&](const NetworkRole& role, Index outputs) {
    if (!role.recipe.make_float) return 0.0;
    Index inputs = 0;
    for (const Field f : role.inputs) {
      inputs += f == Field::unknowns ? size.shape.unknowns
                : f == Field::given  ? size.shape.given
                                     : size.shape.observations;
    }
    return role.recipe.make<float>(inputs, outputs)->operations();
  };
  size.predictor_operations =
      operations(e.setting.predictor, size.shape.unknowns);
  size.surrogate_operations =
      operations(e.setting.surrogate, size.shape.observations);
  return size;
}

/// The name, from everything else.
void complete(Case& c) {
  const CaseInfo& i = c.info;
  c.info.name = fmt::format("{}/{}/n={}", i.experiment, i.method, i.n);
  if (has_precision(*c.method) && i.precision == Precision::f64)
    c.info.name += "/precision=f64";
  c.info.name += fmt::format("/seed={}", i.seed);
}

Case make_case(const std::shared_ptr<const Experiment>& e,
               const Method& method,
               const std::string& profile,
               const Row& row,
               Index n,
               std::uint64_t seed,
               const std::shared_future<CaseSize>& size) {
  Case c;
  c.size = size;
  c.experiment = e;
  c.method = &method;
  c.info.experiment = e->name;
  c.info.method = method.id;
  c.info.profile = profile;
  c.info.n = n;
  c.info.seed = seed;
  c.info.precision = has_precision(method) ? row.precision : Precision::f64;
  for (const auto& stage : method.chain) {
    c.info.stages.push_back(stage->name());
    c.stage_iterations.push_back(stage->takes_row_iterations() &&
                                         row.iterations > 0
                                     ? row.iterations
                                     : stage->default_iterations());
  }
  complete(c);
  return c;
}

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
      throw UsageError(fmt::format("n={} has no problems; n is at least 1", n));
  }
  if (o.iterations && *o.iterations < 1)
    throw UsageError("iterations must be at least 1");
  for (const auto& id : o.methods.value_or(std::vector<std::string>{})) {
    std::set<std::string> known;
    for (const auto& e : experiments)
      for (const Method& m : e->methods) known.insert(m.id);
    if (!known.contains(id))
      throw UsageError(fmt::format(
          "unknown method '{}'; known are {}", id, fmt::join(known, ", ")));
  }
}

/// Two rows may name the same case only if they mean the same.
bool same_work(const Case& a, const Case& b) {
  return a.stage_iterations == b.stage_iterations &&
         a.info.precision == b.info.precision;
}

/// What the stages of an experiment say about their sources and is not so.
std::set<std::string> unknown_sources(const Experiment& e) {
  std::set<std::string> wrong;
  for (const Method& m : e.methods) {
    if (m.chain.empty()) continue;
    for (const Sources& sources : chain_sources(e, m, m.chain.size() - 1))
      for (auto& text : project_sources().errors(sources))
        wrong.insert(std::move(text));
  }
  return wrong;
}

std::vector<std::string> problems_of(const Experiment& e) {
  std::vector<std::string> wrong;
  const auto add = [&](const std::string& text) {
    wrong.push_back(e.name + ": " + text);
  };
  if (!is_path(e.name)) add("the name is no path of [a-z0-9_-]");
  if (!e.problem.make_float || !e.problem.make_double)
    add("there is no problem");
  std::set<std::string> seen;
  for (const Method& m : e.methods) {
    if (!is_word(m.id)) add("method '" + m.id + "' is not in [a-z0-9_-]");
    if (!seen.insert(m.id).second) add("method " + m.id + " appears twice");
    if (m.chain.empty()) add("method " + m.id + " has no stages");
    std::set<std::string> stages;
    for (const auto& stage : m.chain) {
      if (!is_word(stage->name()))
        add("stage '" + stage->name() + "' is not in [a-z0-9_-]");
      if (!stages.insert(stage->name()).second)
        add("method " + m.id + " has two stages " + stage->name());
    }
    if (!contains(e.problem.provided, m.needs()))
      add(fmt::format("method {} needs {}, problem {} provides {}",
                      m.id,
                      to_text(m.needs()),
                      e.problem.name,
                      to_text(e.problem.provided)));
  }
  for (const auto& text : unknown_sources(e)) add(text);
  seen.clear();
  for (const Profile& p : e.profiles) {
    if (!is_word(p.name)) add("profile '" + p.name + "' is not in [a-z0-9_-]");
    if (!seen.insert(p.name).second)
      add("profile " + p.name + " appears twice");
    for (const Row& row : p.rows) {
      for (const auto& id : row.methods) {
        if (find_method(e, id) == nullptr)
          add(fmt::format("profile {} names method {}, known are {}",
                          p.name,
                          id,
                          method_ids(e)));
      }
      for (const Index n : row.n)
        if (n < 1) add(fmt::format("profile {} has n={}", p.name, n));
      if (row.methods.empty() || row.n.empty() || row.seeds.empty())
        add("profile " + p.name + " has a row without cases");
    }
  }
  return wrong;
}

/// Whether `profile`, or a later one, runs the method on a size selected.
bool runs_from(const Experiment& e,
               const std::string& profile,
               const Select& select) {
  bool reached = false;
  for (const Profile& p : e.profiles) {
    reached = reached || p.name == profile;
    if (!reached) continue;
    for (const Row& row : p.rows) {
      const bool size = std::any_of(row.n.begin(), row.n.end(), [&](Index n) {
        return n >= select.first && n <= select.last;
      });
      if (size &&
          std::find(row.methods.begin(), row.methods.end(), select.method) !=
              row.methods.end())
        return true;
    }
  }
  return false;
}

/// What is wrong with the runs that a claim asks for, "" if nothing.
std::string objection(const Registry& registry,
                      const std::string& experiment,
                      const Claim& claim,
                      const Select& select) {
  const std::string& name =
      select.experiment.empty() ? experiment : select.experiment;
  const auto e = registry.find(name);
  if (!e) return fmt::format("the unknown experiment '{}'", name);
  const Method* m = find_method(*e, select.method);
  if (m == nullptr)
    return fmt::format("the unknown method '{}' of {}", select.method, name);
  const bool stage =
      std::any_of(m->chain.begin(), m->chain.end(), [&](const auto& s) {
        return select.stage.empty() || s->name() == select.stage;
      });
  if (!stage)
    return fmt::format("the unknown stage '{}' of {}", select.stage, m->id);
  if (!runs_from(*e, claim.from, select))
    return fmt::format(
        "'{}', which no profile from {} on runs", select.text(), claim.from);
  return "";
}

void check_claims(const Registry& registry,
                  const std::string& experiment,
                  const std::vector<Claim>& claims,
                  const std::vector<std::string>& profiles,
                  std::vector<std::string>& wrong) {
  std::set<std::string> ids;
  for (const Claim& claim : claims) {
    if (!ids.insert(claim.id).second)
      wrong.push_back(experiment + ": claim " + claim.id + " appears twice");
    for (const auto& problem : problems_of(claim, profiles))
      wrong.push_back(experiment + ": " + problem);
    for (const Condition& c : claim.conditions) {
      for (const Quantity& q : c.quantities) {
        for (const Select& select : q.runs()) {
          const auto why = objection(registry, experiment, claim, select);
          if (!why.empty())
            wrong.push_back(fmt::format(
                "{}: claim {} asks for {}", experiment, claim.id, why));
        }
      }
    }
  }
}

}  // namespace

Case resized(const Case& c, Index n, std::vector<Index> iterations) {
  Case out = c;
  out.info.n = n;
  out.info.keys.clear();
  out.stage_iterations = std::move(iterations);
  complete(out);
  return out;
}

double Case::operations(std::size_t stage) const {
  CaseSize of_stage = size.get();
  of_stage.n = info.n;
  of_stage.iterations = stage_iterations[stage];
  return method->chain[stage]->operations(of_stage);
}

double Case::operations() const {
  double all = 0;
  for (std::size_t k = 0; k < method->chain.size(); ++k) all += operations(k);
  return all;
}

std::string to_text(Needs needs) {
  constexpr std::pair<Needs, std::string_view> kNames[] = {
      {Needs::forward, "forward"},
      {Needs::vjp, "vjp"},
      {Needs::jacobian, "jacobian"},
      {Needs::inverse, "inverse"},
      {Needs::hessian, "hessian"},
      {Needs::labels, "labels"},
      {Needs::jvp, "jvp"},
      {Needs::pullback_tangent, "pullback_tangent"}};
  std::string text;
  for (const auto& [bit, name] : kNames) {
    if (!contains(needs, bit)) continue;
    if (!text.empty()) text += '|';
    text += name;
  }
  return text;
}

void Registry::add(Experiment experiment) {
  if (auto claims = claims_.extract(experiment.name))
    std::move(claims.mapped().begin(),
              claims.mapped().end(),
              std::back_inserter(experiment.claims));
  if (auto report = reports_.extract(experiment.name))
    experiment.report = std::move(report.mapped());
  experiments_.push_back(
      std::make_shared<const Experiment>(std::move(experiment)));
}

void Registry::add_claims(const std::string& experiment,
                          std::vector<Claim> claims) {
  for (auto& e : experiments_) {
    if (e->name != experiment) continue;
    Experiment with = *e;
    std::move(claims.begin(), claims.end(), std::back_inserter(with.claims));
    e = std::make_shared<const Experiment>(std::move(with));
    return;
  }
  auto& waiting = claims_[experiment];
  std::move(claims.begin(), claims.end(), std::back_inserter(waiting));
}

void Registry::add_report(const std::string& experiment, Report report) {
  for (auto& e : experiments_) {
    if (e->name != experiment) continue;
    Experiment with = *e;
    with.report = std::move(report);
    e = std::make_shared<const Experiment>(std::move(with));
    return;
  }
  reports_[experiment] = std::move(report);
}

void Registry::add(Overview overview) {
  overviews_.push_back(std::move(overview));
}

std::shared_ptr<const Experiment> Registry::find(std::string_view name) const {
  for (const auto& e : experiments_)
    if (e->name == name) return e;
  return nullptr;
}

std::vector<std::string> Registry::problems() const {
  std::vector<std::string> wrong;
  std::set<std::string> names;
  for (const auto& e : experiments_) {
    if (!names.insert(e->name).second)
      wrong.push_back(e->name + ": registered twice");
    const auto own = problems_of(*e);
    wrong.insert(wrong.end(), own.begin(), own.end());
    check_claims(*this, e->name, e->claims, profile_names(*e), wrong);
  }
  for (const auto& [name, claims] : claims_)
    wrong.push_back("claims of the unknown experiment " + name);
  for (const auto& [name, report] : reports_)
    wrong.push_back("a report of the unknown experiment " + name);
  for (const Overview& o : overviews_)
    check_claims(*this, o.paper, o.claims, o.profiles, wrong);
  if (!wrong.empty()) return wrong;
  for (const auto& profile : profiles()) {
    try {
      expand(profile);
    } catch (const std::exception& error) {
      wrong.push_back(error.what());
    }
  }
  return wrong;
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
    for (const Profile& p : e->profiles)
      if (std::find(names.begin(), names.end(), p.name) == names.end())
        names.push_back(p.name);
  }
  return names;
}

std::vector<Case> Registry::expand(std::string_view profile,
                                   const Overrides& overrides) const {
  const auto known = profiles();
  if (std::find(known.begin(), known.end(), profile) == known.end())
    throw UsageError(fmt::format(
        "unknown profile '{}'; known are {}", profile, fmt::join(known, ", ")));
  check_overrides(overrides, experiments_);
  const bool as_declared = !overrides.n && !overrides.iterations &&
                           !overrides.methods && !overrides.seeds &&
                           !overrides.precision;
  std::vector<Case> cases;
  std::map<std::string, std::size_t> by_name;
  std::size_t made = 0;
  const auto add = [&](Case c) {
    if (++made > kMostCases)
      throw UsageError(fmt::format(
          "profile {} has more than {} cases so; fewer n or seeds are right",
          profile,
          kMostCases));
    const auto [at, is_new] = by_name.emplace(c.info.name, cases.size());
    if (is_new) {
      cases.push_back(std::move(c));
    } else if (as_declared && !same_work(cases[at->second], c)) {
      throw std::logic_error(fmt::format(
          "{} stands in two rows of profile {} with different options",
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
        for (const Index n : row.n) {
          for (const auto& id : row.methods) {
            const Method* method = find_method(*e, id);
            if (method == nullptr) continue;  // another experiment has it
            for (const auto seed : row.seeds)
              add(make_case(e, *method, p.name, row, n, seed, size));
          }
        }
      }
    }
  }
  return cases;
}

Registry& registry() {
  // Not torn down at exit: it is large, and nobody looks.
  static auto& the = *new Registry;
  return the;
}

bool register_experiment(Experiment experiment) {
  registry().add(std::move(experiment));
  return true;
}

bool register_claims(const std::string& experiment, std::vector<Claim> claims) {
  registry().add_claims(experiment, std::move(claims));
  return true;
}

bool register_report(const std::string& experiment, Report report) {
  registry().add_report(experiment, std::move(report));
  return true;
}

bool register_overview(Overview overview) {
  registry().add(std::move(overview));
  return true;
}

}  // namespace physinv
