#include "python/module/method.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pthread.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <set>

#include "python/module/arrays.h"
#include "python/module/solving.h"
#include "python/module/user_experiment.h"
#include "python/module/words.h"
#include "python/module/worker.h"
#include "suite/app/verbs.h"
#include "suite/core/float_environment.h"
#include "suite/core/threads.h"
#include "suite/harness/registry.h"
#include "suite/harness/sources.h"
#include "suite/store/errors.h"

namespace physinv::python {
namespace {

Status status_of(const std::string& name) {
  std::vector<std::string_view> known;
  for (const Status s : kStatuses) {
    if (name == to_string(s)) return s;
    known.push_back(to_string(s));
  }
  throw py::value_error(
      fmt::format("there is no status '{}'; known statuses: {}",
                  name,
                  fmt::join(known, ", ")));
}

/// One number per problem.
Batch<double> numbers_of(const py::object& values,
                         const std::string& name,
                         Index n) {
  const auto array = taken<double>(values, name);
  if (array.ndim() != 1 || array.size() != n)
    throw py::value_error(
        fmt::format("{} must have a number for each of {} problems", name, n));
  return Eigen::Map<const Vector<double>>(array.data(), n).transpose();
}

/// What a method says that it took, one count per problem.
Batch<double> counts_of(const py::object& values,
                        const std::string& name,
                        Index n) {
  Batch<double> counts = numbers_of(values, name, n);
  if (!counts.allFinite() || (counts.array() < 0).any())
    throw py::value_error(name + " must be counts of at least 0");
  return counts;
}

std::vector<Status> statuses_of(const py::object& values, Index n) {
  std::vector<Status> all;
  for (const auto& one : values.cast<std::vector<std::string>>())
    all.push_back(status_of(one));
  if (static_cast<Index>(all.size()) != n)
    throw py::value_error(
        fmt::format("status has {} entries for {} problems", all.size(), n));
  return all;
}

/// x, or x and a dict of status, iterations, evaluations and arrays per
/// example and of a message. The record has the counts of the suite, and what a
/// method reports in addition.
Outcome outcome_of(py::object result, const Solving& solving) {
  py::dict more;
  if (py::isinstance<py::tuple>(result) && py::len(result) == 2) {
    more = result.cast<py::tuple>()[1].cast<py::dict>();
    result = result.cast<py::tuple>()[0];
  }
  if (result.is_none())
    throw py::value_error(
        "it returned None; expected x with the shape (samples, unknowns)");
  Outcome out;
  out.x = solving.estimates(result);
  out.iterations = solving.counted_iterations();
  out.evaluations = solving.counted_evaluations();
  for (const auto& [key, value] : more) {
    const auto name = key.cast<std::string>();
    const auto given = py::reinterpret_borrow<py::object>(value);
    if (name == "status") {
      out.status = statuses_of(given, solving.n());
    } else if (name == "iterations" || name == "evaluations") {
      const std::string claimed = "claimed_" + name;
      out.arrays[ArrayKey::own(claimed)] = counts_of(given, name, solving.n());
    } else if (name == "message") {
      out.message = given.cast<std::string>();
    } else if (name == "arrays") {
      for (const auto& [own, values] : given.cast<py::dict>()) {
        const auto text = own.cast<std::string>();
        out.arrays[ArrayKey::own(text)] =
            numbers_of(py::reinterpret_borrow<py::object>(values),
                       "the array " + text,
                       solving.n());
      }
    } else {
      throw py::value_error("a method cannot return '" + name +
                            "'; known keys: status, iterations, evaluations, "
                            "message, arrays");
    }
  }
  if (std::ranges::all_of(out.status, converged) && !out.status.empty())
    out.stop = Stop::converged;
  return out;
}

/// What a method declares that it uses.
struct Wanted {
  Needs needs = Needs::forward;
  Networks networks = Networks::none;
};

/// Python's libraries compute with as many threads as the case has, during its
/// lifetime (physinv/_threads.py).
class CaseThreads {
 public:
  explicit CaseThreads(int count)
      : module_(py::module_::import("physinv._threads")),
        before_(module_.attr("limit")(count)) {}
  ~CaseThreads() {
    try {
      module_.attr("restore")(before_);
    } catch (const py::error_already_set&) {
      // A library that refuses keeps what it has.
    }
  }
  CaseThreads(const CaseThreads&) = delete;
  CaseThreads& operator=(const CaseThreads&) = delete;

 private:
  py::module_ module_;
  py::object before_;
};

/// Closes what a method was given: later calls through a kept copy fail.
struct Ending {
  Solving& solving;
  ~Ending() { solving.end(); }
};

class PythonStage final : public Stage {
 public:
  /// `words` returns what the key has of the method, for options().
  PythonStage(py::function solve,
              Wanted wanted,
              py::function words,
              Index iterations)
      : solve_(std::move(solve)),
        words_(std::move(words)),
        wanted_(wanted),
        iterations_(iterations) {
    renew();
  }
  /// Asks for the words again, as what the method refers to may have changed.
  void renew() const {
    const auto words =
        words_().cast<std::vector<std::pair<std::string, std::string>>>();
    options_ = {{"algorithm", "python"}};
    options_.insert(options_.end(), words.begin(), words.end());
  }
  std::string name() const override { return "solve"; }
  Needs needs() const override { return wanted_.needs; }
  /// With the hash of the source, which is so part of the key.
  Options options() const override { return options_; }
  Index default_iterations() const override { return iterations_; }
  Networks networks() const override { return wanted_.networks; }
  /// In addition, what the method sees of the suite.
  Sources sources() const override {
    Sources all = {.roots = {"suite/core/oracle.h", "suite/core/probe.h"},
                   .unused = {}};
    if (wanted_.networks != Networks::none)
      all.roots.emplace_back("optimizers/network_model.h");
    return all;
  }
  double operations(const CaseSize& size) const override {
    return 3 * size.problem_operations *
           static_cast<double>(size.n * size.iterations);
  }
  Outcome run(StageRun& run) const override {
    const py::gil_scoped_acquire held;
    const auto solving = std::make_shared<Solving>(run);
    const Ending ending{*solving};
    try {
      const CaseThreads threads(run.threads == nullptr ? 1
                                                       : run.threads->count());
      Outcome out = outcome_of(solve_(solving), *solving);
      solving->finish();
      return out;
    } catch (const py::error_already_set& error) {
      throw std::runtime_error(words_of(error));
    }
  }

 private:
  py::function solve_, words_;
  Wanted wanted_;
  mutable Options options_;
  Index iterations_;
};

Wanted wanted_of(const std::vector<std::string>& names) {
  Wanted all;
  for (const auto& name : names) {
    if (name == "network") {
      all.networks = Networks::predictor;
      continue;
    }
    unsigned bit = 1;
    while (bit < 256 && to_text(static_cast<Needs>(bit)) != name) bit *= 2;
    if (bit == 256)
      throw py::value_error("there is no capability '" + name + "'; " +
                            to_text(static_cast<Needs>(255)) +
                            " and network are");
    all.needs = all.needs | static_cast<Needs>(bit);
  }
  return all;
}

bool provides(const Experiment& e, const Wanted& wanted) {
  return contains(e.problem.provided, wanted.needs) &&
         (wanted.networks == Networks::none ||
          !e.setting.predictor.inputs.empty());
}

/// Null for a method of the suite's.
const PythonStage* python_stage(const Method& method) {
  return dynamic_cast<const PythonStage*>(method.chain.front().get());
}

bool in_python(const Method* method) {
  return method != nullptr && python_stage(*method) != nullptr;
}

/// Before any verb, so that keys are of what the methods are now.
void renew_methods() {
  std::set<const PythonStage*> renewed = {nullptr};
  for (const auto& e : registry().experiments())
    for (const Method& method : e->methods)
      if (const PythonStage* stage = python_stage(method);
          renewed.insert(stage).second)
        stage->renew();
}

/// Wherever a profile of the experiment has rows of the suite's methods, on
/// their n and seeds.
Experiment with_method(const Experiment& e, const Method& method) {
  Experiment with = e;
  std::erase_if(with.methods,
                [&](const Method& m) { return m.id == method.id; });
  with.methods.push_back(method);
  for (Profile& profile : with.profiles) {
    std::vector<Row> rows;
    for (Row& row : profile.rows) {
      std::erase(row.methods, method.id);
      if (row.methods.empty()) continue;
      rows.push_back(row);
      if (in_python(find_method(e, row.methods.front()))) continue;
      row.methods = {method.id};
      row.iterations = 0;
      row.precision = Precision::f64;
      rows.push_back(row);
    }
    profile.rows = std::move(rows);
  }
  return with;
}

/// Adds a method to the experiments of these names that provide what it needs;
/// returns them. One of the suite's own keeps its name.
std::vector<std::string> add_method(const std::string& id,
                                    const py::function& solve,
                                    const std::vector<std::string>& experiments,
                                    const std::vector<std::string>& needs,
                                    const py::function& words,
                                    Index iterations) {
  const Wanted wanted = wanted_of(needs);
  const Method method{.id = id,
                      .chain = {std::make_shared<PythonStage>(
                          solve, wanted, words, iterations)}};
  Registry next;
  std::vector<std::string> added;
  for (const auto& e : registry().experiments()) {
    const bool chosen =
        std::count(experiments.begin(), experiments.end(), e->name) > 0 &&
        provides(*e, wanted);
    if (!chosen) {
      next.add(Experiment(*e));
      continue;
    }
    const Method* there = find_method(*e, id);
    if (there != nullptr && !in_python(there))
      throw py::value_error(fmt::format(
          "{} already has a method {}; choose another name", e->name, id));
    added.push_back(e->name);
    next.add(with_method(*e, method));
  }
  for (const Overview& o : registry().overviews()) next.add(o);
  registry() = std::move(next);
  return added;
}

/// Of the sources of all problems, for methods that call them by themselves.
std::string problem_sources() {
  Sources all;
  for (const auto& e : registry().experiments())
    all.roots.push_back(e->problem.source);
  return project_sources().fingerprint({all});
}

bool running = false, forked = false;

/// A worker is a fork: Python must be notified, and OpenMP, whose threads a
/// child does not have.
void before_fork() {
  if (!running) return;
  try {
    py::module_::import("physinv._threads").attr("before_fork")();
  } catch (const py::error_already_set&) {
    // A child without threads of OpenMP is one that uses a single one.
  }
  PyOS_BeforeFork();
}

void after_fork_here() {
  if (running) PyOS_AfterFork_Parent();
}

void after_fork_there() {
  if (running) PyOS_AfterFork_Child();
  forked = forked || running;
  running = false;  // what it forks is its own affair
}

const Verb& verb_named(const std::string& name) {
  for (const Verb& verb : program().verbs)
    if (verb.name == name) return verb;
  throw py::value_error("there is no verb '" + name + "'");
}

/// Status and last words of a verb, in this process, which has the methods.
py::tuple call(const std::string& name, const Arguments& arguments) {
  static const int kRegistered =
      pthread_atfork(before_fork, after_fork_here, after_fork_there);
  (void)kRegistered;
  const Verb& verb = verb_named(name);
  renew_problems();
  renew_methods();
  const DefaultFloatEnvironment floats;
  running = true;
  ExitCode status = ExitCode::internal;
  std::string words;
  try {
    status = verb.call(arguments);
  } catch (const ExitError& error) {
    status = error.code(), words = error.what();
  } catch (const UnreadableInput& error) {
    status = ExitCode::usage, words = error.what();
  } catch (const StoreError& error) {
    status = ExitCode::environment, words = error.what();
  } catch (const std::exception& error) {
    words = fmt::format("internal error: {}", error.what());
  }
  running = false;
  std::fflush(stdout);
  const auto text = py::reinterpret_steal<py::str>(PyUnicode_DecodeUTF8(
      words.data(), static_cast<py::ssize_t>(words.size()), "surrogateescape"));
  return py::make_tuple(static_cast<int>(status), text);
}

}  // namespace

bool in_worker() { return forked; }

Experiment with_methods_of(const Experiment& before, Experiment fresh) {
  for (const Method& method : before.methods)
    if (const PythonStage* stage = python_stage(method);
        stage != nullptr && contains(fresh.problem.provided, method.needs()))
      fresh = with_method(fresh, method);
  return fresh;
}

void define_method(py::module_& module) {
  define_solving(module);
  module.def("add_method", &add_method);
  module.def("problem_sources", &problem_sources);
  module.def("call", &call);
}

}  // namespace physinv::python
