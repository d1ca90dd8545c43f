// Every condition of every claim can fail and can hold: on campaigns that are
// made up from the records of the smoke profile, with all numbers drawn anew,
// and then perturbed. What none of them turns is listed with its reason.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "suite/harness/registry.h"
#include "suite/results/published.h"
#include "suite/results/results.h"

namespace physinv {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ---- made-up campaigns ------------------------------------------------------

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}

  double uniform() {
    return std::ldexp(static_cast<double>(engine_() >> 11), -53);
  }
  double uniform(double low, double high) {
    return low + (high - low) * uniform();
  }
  double normal() {
    return std::sqrt(-2 * std::log(1 - uniform())) *
           std::cos(2 * std::numbers::pi * uniform());
  }
  bool chance(double p) { return uniform() < p; }
  std::size_t below(std::size_t n) { return engine_() % n; }

 private:
  std::mt19937_64 engine_;
};

/// How far numbers are thrown, in decades: a draw of its own.
struct Throw {
  double method = 0, example = 0;

  static Throw of(Dice& dice) {
    constexpr double kWidths[] = {0, 0.02, 0.1, 0.5, 2};
    return {kWidths[dice.below(5)], kWidths[dice.below(5)]};
  }
};

double decades(Dice& dice, double width) {
  return std::pow(10, width * dice.normal());
}

/// As many columns, again from the first one; of fields as many as there are.
Batch<double> columns(const Batch<double>& of, Index count) {
  constexpr Index kField = 64;
  if (of.rows() > kField) return of;
  Batch<double> out(of.rows(), of.cols() == 0 ? 0 : count);
  for (Index i = 0; i < out.cols(); ++i) out.col(i) = of.col(i % of.cols());
  return out;
}
Vector<double> entries(const Vector<double>& of, Index count) {
  return columns(of.transpose(), count).transpose();
}

template <class M>
void scatter(M& values, Dice& dice, const Throw& t) {
  for (Index r = 0; r < values.rows(); ++r) {
    const double row = decades(dice, t.method);
    const double sign = t.method > 0.2 && dice.chance(0.3) ? -1 : 1;
    for (Index c = 0; c < values.cols(); ++c)
      values(r, c) *= sign * row * decades(dice, t.example);
  }
}

/// Estimates near the truth or far from it.
void scatter_around(const Batch<double>& truth, Batch<double>& x, Dice& dice) {
  if (x.rows() != truth.rows() || x.cols() > truth.cols()) return;
  const double far = std::pow(10, dice.uniform(-6, 1));
  for (Index i = 0; i < x.cols(); ++i)
    for (Index j = 0; j < x.rows(); ++j)
      x(j, i) = truth(j, i) + far * dice.normal();
}

StageRecord made_up(const StageRecord& model,
                    const Case& c,
                    std::size_t position,
                    const CaseData& data,
                    Dice& dice,
                    const Throw& t) {
  StageRecord s = model;
  const Index n = c.info.n, was = model.loss.size();
  const double level = decades(dice, 2 * t.method);
  s.case_name = c.info.name, s.crowded = false;
  s.loss = entries(model.loss, n);
  for (double& loss : s.loss) loss *= level * decades(dice, t.example);
  s.x = columns(model.x, model.x.cols() == was ? n : model.x.cols());
  scatter_around(data.x, s.x, dice);
  s.example_iterations = entries(model.example_iterations, n);
  s.example_evaluations = entries(model.example_evaluations, n);
  scatter(s.example_iterations, dice, t);
  s.example_iterations = s.example_iterations.cwiseAbs();
  if (!model.status.empty()) s.status.resize(static_cast<std::size_t>(n));

  s.iterations = c.stage_iterations[position];
  Curve& curve = s.curve;
  if (curve.points() > 0) {
    const double last = std::max(1.0, curve.iteration.back());
    const double stretch = static_cast<double>(s.iterations) / last;
    for (double& k : curve.iteration) k = std::round(k * stretch);
    const double slower = stretch * decades(dice, t.method);
    for (double& seconds : curve.seconds) seconds *= slower;
    if (curve.loss.rows() == was)
      curve.loss = columns(curve.loss.transpose(), n).transpose();
    curve.loss *= level;
    const Index unknowns = s.x.rows();
    const double far = std::pow(10, dice.uniform(-3, 1));
    for (Index r = 0; r < curve.x.rows() && unknowns > 0; ++r)
      for (Index k = 0; k < curve.x.cols(); ++k)
        curve.x(r, k) += far * dice.normal();
  }
  for (auto& [name, array] : s.arrays) {
    if (array.cols() == was && array.cols() != curve.points())
      array = columns(array, n);
    scatter(array, dice, t);
    if (name == "mean_loss") array = array.cwiseAbs();
  }
  if (dice.chance(0.02)) s.stop = Stop::diverged;
  s.clocks.solve.cpu *= decades(dice, t.method);
  s.clocks.solve.wall = s.clocks.solve.cpu;
  return s;
}

using Cases = std::vector<CaseRecord>;

/// Records of the smoke profile, by experiment and method.
class Models {
 public:
  explicit Models(const Results& smoke) {
    for (const CaseRecord& c : smoke.cases())
      models_.try_emplace({c.info.experiment, c.info.method}, c);
  }

  /// Of the method, else of one of the experiment with the same stages; null.
  const CaseRecord* of(const CaseInfo& info) const {
    const auto own = models_.find({info.experiment, info.method});
    if (own != models_.end()) return &own->second;
    for (const auto& [key, model] : models_)
      if (key.first == info.experiment && model.info.stages == info.stages)
        return &model;
    return nullptr;
  }

 private:
  std::map<std::pair<std::string, std::string>, CaseRecord> models_;
};

CaseRecord made_up(const CaseRecord& model,
                   const Case& c,
                   Dice& dice,
                   const Throw& t) {
  CaseRecord out{.info = c.info, .data = model.data, .stages = {}};
  for (Batch<double>* part : {&out.data.x, &out.data.y, &out.data.given})
    *part = columns(*part, c.info.n);
  for (std::size_t k = 0; k < model.stages.size(); ++k)
    out.stages.push_back(made_up(model.stages[k], c, k, out.data, dice, t));
  return out;
}

/// All profiles but the smallest of these experiments, every case once.
std::vector<Case> cases_of(const std::set<std::string>& experiments) {
  std::map<std::string, Case> all;
  for (const std::string& profile : registry().profiles())
    if (profile != "smoke")
      for (Case& c : registry().expand(profile))
        if (experiments.contains(c.info.experiment))
          all.insert_or_assign(c.info.name, std::move(c));
  std::vector<Case> out;
  for (auto& [name, c] : all) out.push_back(std::move(c));
  return out;
}

Cases draw(const std::vector<Case>& of, const Models& models, Dice& dice) {
  std::map<std::pair<std::string, std::string>, Throw> throws;
  Cases all;
  for (const Case& c : of) {
    const CaseRecord* model = models.of(c.info);
    if (model == nullptr || model->stages.size() != c.info.stages.size())
      continue;
    const auto [t, first] =
        throws.try_emplace({c.info.experiment, c.info.method}, Throw::of(dice));
    all.push_back(made_up(*model, c, dice, t->second));
  }
  return all;
}

// ---- perturbations ----------------------------------------------------------

/// Pairs of cases of one experiment, n and seed whose stages have the same
/// names.
template <class F>
void exchange(Cases& cases, F&& swap) {
  std::map<std::string, CaseRecord*> waiting;
  for (CaseRecord& c : cases) {
    const auto key = fmt::format("{} {} {} {}",
                                 c.info.experiment,
                                 c.info.n,
                                 c.info.seed,
                                 fmt::join(c.info.stages, " "));
    CaseRecord*& other = waiting[key];
    if (other == nullptr) {
      other = &c;
      continue;
    }
    swap(*other, c), other = nullptr;
  }
}

void methods_exchanged(Cases& cases, Dice&) {
  exchange(cases,
           [](CaseRecord& a, CaseRecord& b) { std::swap(a.stages, b.stages); });
}
void times_exchanged(Cases& cases, Dice&) {
  exchange(cases, [](CaseRecord& a, CaseRecord& b) {
    for (std::size_t k = 0; k < a.stages.size(); ++k) {
      std::swap(a.stages[k].clocks, b.stages[k].clocks);
      std::swap(a.stages[k].curve.seconds, b.stages[k].curve.seconds);
    }
  });
}
void seeds_shuffled(Cases& cases, Dice& dice) {
  std::map<std::string, std::vector<CaseRecord*>> groups;
  for (CaseRecord& c : cases)
    groups[fmt::format("{} {} {}", c.info.experiment, c.info.method, c.info.n)]
        .push_back(&c);
  for (auto& [name, group] : groups)
    for (std::size_t k = group.size(); k > 1; --k)
      std::swap(group[k - 1]->stages, group[dice.below(k)]->stages);
}

/// One method of each experiment.
template <class F>
void change_one(Cases& cases, Dice& dice, F&& change) {
  std::map<std::string, std::set<std::string>> methods;
  for (const CaseRecord& c : cases)
    methods[c.info.experiment].insert(c.info.method);
  std::map<std::string, std::string> chosen;
  for (const auto& [experiment, all] : methods)
    chosen[experiment] = *std::next(
        all.begin(), static_cast<std::ptrdiff_t>(dice.below(all.size())));
  for (CaseRecord& c : cases)
    if (chosen[c.info.experiment] == c.info.method)
      for (StageRecord& s : c.stages) change(s);
}

void scale(StageRecord& s, double factor) {
  s.loss *= factor, s.curve.loss *= factor;
  for (auto& [name, array] : s.arrays) array *= factor;
}
void ten_times(Cases& cases, Dice& dice) {
  change_one(cases, dice, [](StageRecord& s) { scale(s, 10); });
}
void a_tenth(Cases& cases, Dice& dice) {
  change_one(cases, dice, [](StageRecord& s) { scale(s, 0.1); });
}
void one_diverges(Cases& cases, Dice& dice) {
  change_one(cases, dice, [](StageRecord& s) {
    s.stop = Stop::diverged;
    s.loss.setConstant(kInfinity);
  });
}

using Perturbation = void (*)(Cases&, Dice&);
constexpr std::pair<const char*, Perturbation> kPerturbations[] = {
    {"methods exchanged", methods_exchanged},
    {"times exchanged", times_exchanged},
    {"seeds shuffled", seeds_shuffled},
    {"losses of one method times 10", ten_times},
    {"losses of one method times 1/10", a_tenth},
    {"one method diverges", one_diverges}};

// ---- what turns -------------------------------------------------------------

/// What was seen of one condition.
struct Seen {
  bool held = false, failed = false, turned = false;
  std::string error;
};

std::optional<bool> decided(const Condition& c, const Evidence& e, Seen& seen) {
  try {
    const auto holds = c.judge(e).holds;
    seen.held = seen.held || (holds && *holds);
    seen.failed = seen.failed || (holds && !*holds);
    return holds;
  } catch (const std::exception& error) {
    seen.error = error.what();
    return {};
  }
}

struct Asked {
  std::string name;
  const std::vector<Claim>* claims;
  std::set<std::string> experiments;
};

std::vector<Asked> everything() {
  std::vector<Asked> all;
  for (const auto& e : registry().experiments())
    all.push_back({e->name, &e->claims, {e->name}});
  for (const Overview& o : registry().overviews())
    all.push_back({o.paper, &o.claims, {}});
  for (Asked& a : all)
    for (const Claim& claim : *a.claims)
      for (const Condition& c : claim.conditions)
        for (const Quantity& q : c.quantities)
          for (const Select& s : q.runs())
            a.experiments.insert(s.experiment.empty() ? a.name : s.experiment);
  return all;
}

constexpr int kDraws = 24;

void look(const Asked& asked,
          const Models& models,
          const Published& published,
          std::map<std::string, Seen>& seen) {
  const auto cases = cases_of(asked.experiments);
  Dice dice(std::hash<std::string>{}(asked.name));
  const auto judge = [&](const Cases& campaign, auto&& each) {
    const Results results(campaign);
    const Evidence evidence{results, published, asked.name};
    for (const Claim& claim : *asked.claims)
      for (const Condition& c : claim.conditions) {
        if (c.bounds.empty()) continue;
        const std::string name =
            fmt::format("{} {}: {}", asked.name, claim.id, c.label);
        each(name, decided(c, evidence, seen[name]));
      }
  };
  for (int k = 0; k < kDraws; ++k) {
    const Cases base = draw(cases, models, dice);
    std::map<std::string, std::optional<bool>> before;
    judge(base, [&](const std::string& name, std::optional<bool> holds) {
      before[name] = holds;
    });
    for (const auto& [what, perturb] : kPerturbations) {
      Cases changed = base;
      perturb(changed, dice);
      judge(changed, [&](const std::string& name, std::optional<bool> holds) {
        if (holds && before[name] && *holds != *before[name])
          seen[name].turned = true;
      });
    }
  }
}

}  // namespace
}  // namespace physinv

int main(int argc, char** argv) {
  using namespace physinv;
  if (argc < 2) {
    fmt::print("usage: claim_turns_test STORE-OF-SMOKE [EXPERIMENT]\n");
    return 2;
  }
  const Models models(load_results(argv[1]));
  const Published published(PHYSINV_SOURCE_DIR "/reports/published");
  std::map<std::string, Seen> seen;
  for (const Asked& asked : everything())
    if (!asked.claims->empty() && (argc < 3 || asked.name == argv[2]))
      look(asked, models, published, seen);
  int undecided = 0, never_failed = 0, never_held = 0, never_turned = 0;
  for (const auto& [name, s] : seen) {
    const bool open = !s.held && !s.failed;
    undecided += open;
    never_failed += !open && !s.failed;
    never_held += !open && !s.held;
    never_turned += !s.turned;
    if (!s.turned)
      fmt::print("{}: {} {}\n",
                 open        ? "undecided"
                 : !s.failed ? "never failed"
                 : !s.held   ? "never held"
                             : "never turned",
                 name,
                 s.error);
  }
  fmt::print(
      "{} conditions: {} turned by a perturbation, {} undecided, {} never "
      "failed, {} never held\n",
      seen.size(),
      seen.size() - static_cast<std::size_t>(never_turned),
      undecided,
      never_failed,
      never_held);
  return 0;
}
