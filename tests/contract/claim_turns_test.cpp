// Every condition of every claim can fail and can hold: on campaigns that are
// made up from the records of the smoke profile, with all numbers drawn again,
// and then perturbed. What none of them turns is listed with its reason.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "suite/core/hash.h"
#include "suite/diagnostics/stability_sweep.h"
#include "suite/harness/registry.h"
#include "suite/results/published.h"
#include "suite/results/results.h"
#include "tests/support/kept_memory.h"
#include "tests/support/made_up.h"

namespace physinv {
namespace {

using test::all_cases, test::Cases, test::Dice, test::is_axis, test::Models,
    test::Variants;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

/// Some methods of each experiment.
template <class F>
void change_some(Cases& cases, Dice& dice, F&& change) {
  std::map<std::string, bool> chosen;
  for (CaseRecord& c : cases) {
    const auto [at, first] = chosen.try_emplace(
        c.info.experiment + ' ' + c.info.method, dice.chance(0.4));
    if (at->second)
      for (StageRecord& s : c.stages) change(s);
  }
}

/// Every number of a stage that is measured.
template <class F>
void each_array(StageRecord& s, F&& change) {
  for (auto& [name, array] : s.arrays)
    if (!is_axis(name)) change(array);
}

void scale(StageRecord& s, double factor) {
  s.loss *= factor, s.curve.loss *= factor;
  each_array(s, [&](Batch<double>& array) { array *= factor; });
}
void ten_times(Cases& cases, Dice& dice) {
  change_some(cases, dice, [](StageRecord& s) { scale(s, 10); });
}
void a_tenth(Cases& cases, Dice& dice) {
  change_some(cases, dice, [](StageRecord& s) { scale(s, 0.1); });
}
void some_diverge(Cases& cases, Dice& dice) {
  change_some(cases, dice, [](StageRecord& s) {
    s.stop = Stop::diverged;
    s.loss.setConstant(kInfinity);
  });
}

/// Nothing happens.
void some_constant(Cases& cases, Dice& dice) {
  change_some(cases, dice, [](StageRecord& s) {
    const auto level = [](Batch<double>& array) {
      if (array.size() > 0) array.setConstant(array(0, 0));
    };
    level(s.curve.loss);
    each_array(s, level);
    if (Batch<double>& x = s.curve.x; x.cols() > 0)
      x = Batch<double>(x.col(0).replicate(1, x.cols()));
  });
}
/// What fell rises.
void some_reversed(Cases& cases, Dice& dice) {
  change_some(cases, dice, [](StageRecord& s) {
    s.curve.loss = Batch<double>(s.curve.loss.rowwise().reverse());
    each_array(s, [](Batch<double>& array) {
      array = Batch<double>(array.rowwise().reverse());
    });
  });
}
void signs_drawn(Cases& cases, Dice& dice) {
  change_some(cases, dice, [&](StageRecord& s) {
    each_array(s, [&](Batch<double>& array) {
      for (Index k = 0; k < array.cols(); ++k)
        if (dice.chance(0.5)) array.col(k) *= -1;
    });
  });
}
/// Of sweeps: how each point ended.
void statuses_drawn(Cases& cases, Dice& dice) {
  change_some(cases, dice, [&](StageRecord& s) {
    if (!s.arrays.contains("status")) return;
    for (double& status : s.arrays.at("status").reshaped())
      status = static_cast<double>(dice.below(kSweepStatusNames.size()));
  });
}
/// Two methods find the same.
void ties(Cases& cases, Dice&) {
  exchange(cases, [](CaseRecord& a, CaseRecord& b) { a.stages = b.stages; });
}
/// Some methods end where another one does, whatever their stages, in all
/// experiments.
void losses_shared(Cases& cases, Dice& dice) {
  const auto problems = [](const CaseRecord& c) {
    return fmt::format("{} {} {}", c.info.experiment, c.info.n, c.info.seed);
  };
  std::map<std::string, Vector<double>> first;
  for (const CaseRecord& c : cases)
    first.try_emplace(problems(c), c.stages.back().loss);
  std::map<std::string, bool> chosen;
  for (CaseRecord& c : cases) {
    const auto [at, is_new] =
        chosen.try_emplace(c.info.method, dice.chance(0.5));
    const Vector<double>& loss = first[problems(c)];
    for (StageRecord& s : c.stages)
      if (at->second && s.loss.size() == loss.size()) s.loss = loss;
  }
}
void estimates_anywhere(Cases& cases, Dice& dice) {
  change_some(cases, dice, [&](StageRecord& s) {
    const double far = std::pow(10, dice.uniform(-2, 2));
    for (double& v : s.x.reshaped()) v = far * dice.normal();
  });
}
void some_take_more(Cases& cases, Dice& dice) {
  change_some(cases, dice, [&](StageRecord& s) {
    s.example_iterations *= 100, s.example_evaluations *= 100;
    s.buffer_bytes *= 10'000;
  });
}

using Perturbation = void (*)(Cases&, Dice&);
constexpr std::pair<const char*, Perturbation> kPerturbations[] = {
    {"methods exchanged", methods_exchanged},
    {"times exchanged", times_exchanged},
    {"seeds shuffled", seeds_shuffled},
    {"losses of some methods times 10", ten_times},
    {"losses of some methods times 1/10", a_tenth},
    {"curves of some methods reversed", some_reversed},
    {"curves of some methods constant", some_constant},
    {"signs of some methods drawn", signs_drawn},
    {"statuses of some methods drawn", statuses_drawn},
    {"methods tie", ties},
    {"losses of some methods are another's", losses_shared},
    {"estimates of some methods anywhere", estimates_anywhere},
    {"some methods take more iterations and memory", some_take_more},
    {"some methods diverge", some_diverge}};

// ---- what turns -------------------------------------------------------------

/// What was seen of one condition.
struct Seen {
  bool held = false, failed = false, turned = false;
  std::string error;  ///< or what is missing
};

std::optional<bool> decided(const Condition& c, const Evidence& e, Seen& seen) {
  try {
    const ConditionResult r = c.judge(e);
    const auto holds = r.holds;
    if (!holds) seen.error = r.missing;
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

/// What none of these campaigns turns, and why: conditions by the start of
/// their name.
struct Steady {
  std::string_view start, why;
};
constexpr Steady kSteady[] = {
    {"jpo P9: ", "numbers of parameters hang on networks, on no run"},
    {"sip P2: ", "no run of the smoke profile keeps cosines of updates"},
    {"sip/poisson P10: ", "numbers of parameters hang on networks, on no run"},
    {"sip/sine-xi32-phi45 P5: ",
     "of the problem's derivatives at the targets, whatever was run"},
    {"jpo/gradient-alignment P7: ",
     "no run of the smoke profile clips gradients"},
    {"jpo/navier-stokes P11: share beyond the training range",
     "its 8 n samples of each seed are drawn with their flows: 20 seconds"},
    {"sip/heat P4: loss on the test set",
     "no run of the smoke profile leaves what a small training set does"},
    {"physgrad/comparison P14: points where",
     "a second derivative of 0 is 0 however it is scaled"},
    {"numerics/half-inverse N4: cells with J = 0",
     "how many the sweep has hangs on its axes, on no run"}};

const Steady* steady(const std::string& name) {
  for (const Steady& s : kSteady)
    if (name.starts_with(s.start)) return &s;
  return nullptr;
}

/// Most conditions turn in the first one or two; what has failed is left then.
constexpr std::size_t kDraws = 30;

/// The conditions of an experiment that nothing has turned yet.
class Untold {
 public:
  Untold(const Asked& asked, std::map<std::string, Seen>& seen) : seen_(seen) {
    for (const Claim& claim : *asked.claims)
      for (const Condition& c : claim.conditions)
        add(fmt::format("{} {}: {}", asked.name, claim.id, c.label), c);
  }

  bool none() const { return left_.empty(); }
  /// What can fail is known to depend on what was measured.
  void leave_what_failed() {
    std::erase_if(left_, [&](const Entry& e) { return seen_[e.name].failed; });
  }

  void judge(const Evidence& evidence, bool base) {
    for (Entry& e : left_) {
      Seen& seen = seen_[e.name];
      const auto holds = decided(*e.condition, evidence, seen);
      if (base)
        e.before = holds;
      else if (holds && e.before && *holds != *e.before)
        seen.turned = true;
    }
    std::erase_if(left_, [&](const Entry& e) { return seen_[e.name].turned; });
  }

 private:
  void add(std::string name, const Condition& c) {
    if (c.bounds.empty()) return;
    seen_[name];
    if (steady(name) == nullptr) left_.push_back({std::move(name), &c});
  }

  struct Entry {
    std::string name;
    const Condition* condition;
    std::optional<bool> before = {};
  };
  std::map<std::string, Seen>& seen_;
  std::vector<Entry> left_;
};

void look(const Asked& asked,
          const std::vector<const Variants*>& cases,
          const Models& models,
          const Published& published,
          std::map<std::string, Seen>& seen) {
  Dice dice(hash_text(asked.name));
  Untold untold(asked, seen);
  for (std::size_t k = 0; k < kDraws && !untold.none(); ++k) {
    const Results base(test::draw(cases, k, models, dice));
    untold.judge({base, published, asked.name}, true);
    for (const auto& [what, perturb] : kPerturbations) {
      if (untold.none()) break;
      Cases changed = base.cases();
      perturb(changed, dice);
      const Results results(std::move(changed));
      untold.judge({results, published, asked.name}, false);
    }
    if (k >= 1) untold.leave_what_failed();
  }
}

/// The result of every condition on three campaigns, its cause's included, a
/// line each: the same before and after an edit of claims that changes none.
void print_values(const Asked& asked,
                  const std::vector<const Variants*>& cases,
                  const Models& models,
                  const Published& published) {
  Dice dice(hash_text(asked.name));
  for (std::size_t k = 0; k < 3; ++k) {
    const Results results(draw(cases, k, models, dice));
    for (const Claim& claim : *asked.claims)
      for (const Condition& c : all_conditions(claim)) {
        ConditionResult r;
        try {
          r = c.judge({results, published, asked.name});
        } catch (const std::exception& error) {
          r.missing = error.what();
        }
        fmt::print("{} {} {}: {}|{}|{}|{}|{}|{}|{}\n",
                   asked.name,
                   claim.id,
                   k,
                   c.label,
                   r.label,
                   r.bounds,
                   r.value.value_or(NAN),
                   r.spread.value_or(NAN),
                   r.holds ? *r.holds ? "holds" : "fails" : r.missing,
                   r.runs);
      }
  }
  std::fflush(stdout);
}

const char* end_of(const Seen& s) {
  if (s.turned) return "turned";
  if (!s.held && !s.failed) return "undecided";
  if (!s.failed) return "never fails";
  return s.held ? "fails and holds" : "never holds";
}

/// Says what was not turned, and whether each has a reason.
bool print(const std::string& of, const std::map<std::string, Seen>& seen) {
  std::map<std::string, int> counts;
  int unknown = 0;
  for (const auto& [name, s] : seen) {
    const std::string end = end_of(s);
    ++counts[end];
    if (end != "undecided" && end != "never fails") continue;
    const Steady* why = steady(name);
    unknown += why == nullptr;
    fmt::print("{}: {}: {}{}\n",
               end,
               name,
               why == nullptr ? "no reason" : why->why,
               s.error.empty() ? "" : " (" + s.error + ")");
  }
  fmt::print("{}:", of);
  for (const auto& [end, count] : counts) fmt::print(" {} {},", count, end);
  fmt::print(" {} without a reason\n", unknown);
  std::fflush(stdout);
  return unknown == 0;
}

/// In a process of its own, which may crash on numbers that no run recorded.
bool apart(const Asked& asked,
           const std::vector<const Variants*>& cases,
           const Models& models,
           const Published& published,
           bool values) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0 && values) {
    print_values(asked, cases, models, published);
    _exit(0);
  }
  if (child == 0) {
    std::map<std::string, Seen> seen;
    look(asked, cases, models, published, seen);
    const bool good = print(asked.name, seen);
    if (std::getenv("PHYSINV_TURNS_CPU"))
      fmt::print(
          "CPU {} {:.2f}\n", asked.name, double(clock()) / CLOCKS_PER_SEC),
          std::fflush(stdout);
    _exit(good ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status))
    fmt::print("{}: ended by signal {}\n", asked.name, WTERMSIG(status));
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace
}  // namespace physinv

int main(int argc, char** argv) {
  using namespace physinv;
  const std::string_view how = argc > 2 ? argv[2] : "";
  const bool full = how == "--full", but = how == "--all-but",
             values = how == "--values";
  const std::set<std::string> named(
      argv + std::min(argc, full || but || values ? 3 : 2), argv + argc);
  if (argc < 2) {
    fmt::print(
        "usage: claim_turns_test STORE-OF-SMOKE [--full | --all-but | "
        "--values] [EXPERIMENT...]\n"
        "--values: prints what every condition comes to instead\n"
        "--full: only where PHYSINV_FULL is set, else status 77\n");
    return 2;
  }
  if (full && std::getenv("PHYSINV_FULL") == nullptr) {
    fmt::print("a CPU-minute: ./check --full\n");
    return 77;
  }
  test::keep_memory();
  register_all(registry());
  const Models models(load_results(argv[1]));
  const Published published(PHYSINV_SOURCE_DIR "/reports/published");
  const auto cases = all_cases();
  bool good = true;
  for (const Asked& asked : everything()) {
    if (asked.claims->empty() ||
        !(named.empty() || named.contains(asked.name) != but))
      continue;
    std::vector<const Variants*> own;
    for (const std::string& experiment : asked.experiments)
      if (const auto at = cases.find(experiment); at != cases.end())
        for (const Variants& c : at->second) own.push_back(&c);
    good = apart(asked, own, models, published, values) && good;
  }
  return good ? 0 : 1;
}
