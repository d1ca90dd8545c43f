#include "suite/harness/registry_errors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <set>
#include <stdexcept>
#include <utility>

#include "suite/harness/errors.h"
#include "suite/harness/judge.h"
#include "suite/harness/outside.h"
#include "suite/harness/sources.h"
#include "suite/store/names.h"

namespace physinv {
namespace {

std::vector<std::string>& elsewhere() {
  static std::vector<std::string> names;
  return names;
}

std::string method_ids(const Experiment& e) {
  std::vector<std::string> ids;
  for (const Method& m : e.methods) ids.push_back(m.id);
  return fmt::format("{}", fmt::join(ids, ", "));
}

/// What the stages of an experiment say about their sources and is not so.
std::set<std::string> unknown_sources(const Experiment& e) {
  std::set<std::pair<std::vector<std::string>, UnusedIncludes>> seen;
  std::set<std::string> wrong;
  for (const Method& m : e.methods) {
    if (m.chain.empty()) continue;
    for (const Sources& sources : chain_sources(e, m, m.chain.size() - 1)) {
      if (!seen.emplace(sources.roots, sources.unused).second) continue;
      for (auto& text : project_sources().errors(sources))
        wrong.insert(std::move(text));
    }
  }
  return wrong;
}

/// Sources from outside that no stage names: an edit of them would change no
/// key. Where experiments are left out, theirs are not known.
std::vector<std::string> unreached_sources(const Registry& registry) {
  std::vector<std::string> wrong = outside_problems();
  if (outsides().empty() || !elsewhere().empty()) return wrong;
  std::set<std::string> reached;
  for (const auto& e : registry.experiments())
    for (const Method& m : e->methods)
      if (!m.chain.empty())
        reached.merge(project_sources().closure(
            chain_sources(*e, m, m.chain.size() - 1)));
  for (const Outside& o : outsides())
    for (const std::string_view path : o.computing)
      if (!reached.contains(std::string(path)))
        wrong.push_back(
            fmt::format("{}: no stage depends on it, so edits would not "
                        "invalidate results; name it like the header that it "
                        "implements, or list it in sources() of its stage",
                        path));
  return wrong;
}

std::vector<std::string> errors_of(const Experiment& e) {
  std::vector<std::string> wrong;
  const auto add = [&](const std::string& text) {
    wrong.push_back(e.name + ": " + text);
  };
  if (!is_path(e.name)) add("the name is not a path of [a-z0-9_-]");
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
          add(fmt::format("profile {} names method {}; known methods: {}",
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
  if (!e && is_elsewhere(name)) return "";
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
  if (!runs_from(*e, claim.judged_from(), select))
    return fmt::format("'{}', which neither profile {} nor a later one runs",
                       select.text(),
                       claim.judged_from());
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
    for (const auto& problem : errors_of(claim, profiles))
      wrong.push_back(experiment + ": " + problem);
    for (const Condition& c : all_conditions(claim)) {
      for (const Quantity& q : c.quantities) {
        for (const Select& select : q.runs()) {
          const auto why = objection(registry, experiment, claim, select);
          if (!why.empty())
            wrong.push_back(fmt::format(
                "{}: claim {} needs {}", experiment, claim.id, why));
        }
      }
    }
  }
}

/// Of those experiments that are `chosen`, and of the names of all.
template <class F>
std::vector<std::string> problems_of_experiments(const Registry& registry,
                                                 const F& chosen) {
  std::vector<std::string> wrong = unreached_sources(registry);
  std::set<std::string> names;
  for (const auto& e : registry.experiments()) {
    if (!names.insert(e->name).second)
      wrong.push_back(e->name + ": registered twice");
    if (!chosen(*e)) continue;
    const auto own = errors_of(*e);
    wrong.insert(wrong.end(), own.begin(), own.end());
    check_claims(registry, e->name, e->claims, profile_names(*e), wrong);
  }
  return wrong;
}

}  // namespace

void validate(const Registry& registry, const std::vector<Case>& cases) {
  std::set<const Experiment*> chosen;
  for (const Case& c : cases) chosen.insert(c.experiment.get());
  const auto wrong = problems_of_experiments(
      registry, [&](const Experiment& e) { return chosen.contains(&e); });
  if (wrong.empty()) return;
  const auto text = fmt::format("{}", fmt::join(wrong, "; "));
  // A mistake in the suite's sources, or in those of a program built on it.
  if (outsides().empty()) throw std::logic_error(text);
  throw UsageError(text);
}

void name_elsewhere(std::vector<std::string> experiments) {
  elsewhere() = std::move(experiments);
}

bool is_elsewhere(std::string_view experiment) {
  return std::any_of(
      elsewhere().begin(), elsewhere().end(), [&](std::string_view name) {
        return name.ends_with('*')
                   ? experiment.starts_with(name.substr(0, name.size() - 1))
                   : experiment == name;
      });
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

std::vector<std::string> Registry::problems() const {
  auto wrong =
      problems_of_experiments(*this, [](const Experiment&) { return true; });
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

}  // namespace physinv
