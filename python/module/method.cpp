#include "python/module/method.h"

#include <fmt/format.h>
#include <pthread.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <numeric>

#include "python/module/arrays.h"
#include "suite/app/verbs.h"
#include "suite/core/hash.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/harness/registry.h"

namespace physinv {

/// What `run` says of itself.
const Program& program() {
  static const Program python{
      .name = "physinv",
      .verbs = {{"run", "[flags]", "run cases", run_verb}},
      .examples = {},
      .environment = ""};
  return python;
}

}  // namespace physinv

namespace physinv::python {
namespace {

/// What a method may see of its case, for as long as it runs.
class Solving {
 public:
  explicit Solving(StageRun& run) : run_(&run) {}

  Index n() const { return oracle().count(); }
  Index iterations() const { return get().iterations; }
  double gtol() const { return get().setting.gtol; }
  Array<double> start() const {
    return to_array(Batch<double>(oracle().start()));
  }
  Array<double> given() const { return to_array(oracle().given()); }
  Array<double> observations() const {
    return to_array(oracle().observations());
  }
  std::uint64_t seed() const { return get().method.stream().bits(); }

  Array<double> loss(const Array<double>& x,
                     const std::optional<std::vector<Index>>& active) const {
    const auto chosen = problems(active);
    const auto in = points(x, chosen);
    Vector<double> loss(in.cols());
    oracle().evaluate<double>(chosen, in, loss);
    return to_array(loss);
  }
  py::tuple loss_and_gradient(
      const Array<double>& x,
      const std::optional<std::vector<Index>>& active) const {
    const auto chosen = problems(active);
    const auto in = points(x, chosen);
    Vector<double> loss(in.cols());
    auto gradient = make_array<double>(in.cols(), in.rows());
    oracle().evaluate<double>(chosen, in, loss, writable(gradient));
    return py::make_tuple(to_array(loss), gradient);
  }
  py::tuple labelled(Index per_problem) const {
    const auto& s = oracle().labelled(per_problem);
    return py::make_tuple(to_array(s.x), to_array(s.y), to_array(s.given));
  }

  bool proceed(const Array<double>& x) {
    const auto in = points(x, problems({}));
    told_ = true;
    return get().probe.proceed([&](BatchOut<double> out) { out = in; });
  }
  void accept(Index example,
              Index iteration,
              const Array<double>& x,
              double loss) {
    if (example < 0 || example >= n())
      throw py::value_error(
          fmt::format("example {} of {} from 0 on", example, n()));
    if (iteration < 0 || iteration > iterations())
      throw py::value_error(fmt::format(
          "iteration {} of {}, which are the budget", iteration, iterations()));
    if (x.ndim() != 1 || x.shape(0) != oracle().shape().unknowns)
      throw py::value_error(fmt::format("x has the {} unknowns of an example",
                                        oracle().shape().unknowns));
    told_ = accepted_ = true;
    get().probe.accept(example, iteration, x.data(), loss);
  }

  View<double> points(const Array<double>& x,
                      const std::vector<Index>& chosen) const {
    return view<double>(
        x, "x", static_cast<Index>(chosen.size()), oracle().shape().unknowns);
  }
  std::vector<Index> problems(
      const std::optional<std::vector<Index>>& active) const {
    if (!active) return {oracle().all().begin(), oracle().all().end()};
    for (const Index i : *active)
      if (i < 0 || i >= n())
        throw py::value_error(
            fmt::format("problem {} of {} from 0 on", i, n()));
    return *active;
  }

  void end() {
    if (!told_)
      throw std::runtime_error(
          "the method called neither run.proceed nor run.accept, so that there "
          "is no curve of it");
    if (accepted_) get().probe.finish();
    run_ = nullptr;
  }

 private:
  StageRun& get() const {
    if (run_ == nullptr) throw std::runtime_error("this run has ended");
    return *run_;
  }
  Oracle& oracle() const { return get().oracle; }

  StageRun* run_;
  bool told_ = false, accepted_ = false;
};

Status status_of(const std::string& name) {
  for (const Status s :
       {Status::gtol, Status::maxiter, Status::linesearch, Status::nonfinite})
    if (name == to_string(s)) return s;
  throw py::value_error("there is no status '" + name +
                        "'; gtol, maxiter, linesearch and nonfinite are");
}

Vector<double> counts_of(const py::object& values) {
  const auto array = Array<double>::ensure(values);
  if (!array || array.ndim() != 1) {
    PyErr_Clear();
    throw py::value_error("iterations and evaluations are lists of numbers");
  }
  return Eigen::Map<const Vector<double>>(array.data(), array.shape(0));
}

/// x, or x and a dict of status, iterations and evaluations per example.
Outcome outcome_of(py::object result, const Solving& solving) {
  py::dict more;
  if (py::isinstance<py::tuple>(result) && py::len(result) == 2) {
    more = result.cast<py::tuple>()[1].cast<py::dict>();
    result = result.cast<py::tuple>()[0];
  }
  const auto x = Array<double>::ensure(result);
  if (!x) throw py::value_error("a method returns x, (samples, unknowns)");
  Outcome out;
  out.x = solving.points(x, solving.problems({}));
  for (const auto& [key, value] : more) {
    const auto name = key.cast<std::string>();
    const auto given = py::reinterpret_borrow<py::object>(value);
    if (name == "status") {
      for (const auto& one : given.cast<std::vector<std::string>>())
        out.status.push_back(status_of(one));
    } else if (name == "iterations") {
      out.iterations = counts_of(given);
    } else if (name == "evaluations") {
      out.evaluations = counts_of(given);
    } else {
      throw py::value_error("a method has no '" + name +
                            "'; status, iterations and evaluations are known");
    }
  }
  if (std::all_of(out.status.begin(),
                  out.status.end(),
                  [](Status s) { return s == Status::gtol; }) &&
      !out.status.empty())
    out.stop = Stop::converged;
  return out;
}

class PythonStage final : public Stage {
 public:
  PythonStage(py::function solve,
              Needs needs,
              Options options,
              Index iterations)
      : solve_(std::move(solve)),
        needs_(needs),
        options_(std::move(options)),
        iterations_(iterations) {}
  std::string name() const override { return "solve"; }
  Needs needs() const override { return needs_; }
  /// With the hash of the source, which so stands in the key.
  Options options() const override { return options_; }
  Index default_iterations() const override { return iterations_; }
  Networks networks() const override { return Networks::none; }
  /// Beside that, what the method sees of the suite.
  Sources sources() const override {
    return {.roots = {"suite/core/oracle.h", "suite/core/probe.h"},
            .unused = {}};
  }
  double operations(const CaseSize& size) const override {
    return 3 * size.problem_operations *
           static_cast<double>(size.n * size.iterations);
  }
  Outcome run(StageRun& run) const override {
    const py::gil_scoped_acquire held;
    const auto solving = std::make_shared<Solving>(run);
    try {
      Outcome out = outcome_of(solve_(solving), *solving);
      solving->end();
      return out;
    } catch (const py::error_already_set& error) {
      throw std::runtime_error(
          fmt::format("{}: {}",
                      error.type().attr("__name__").cast<std::string>(),
                      py::str(error.value()).cast<std::string>()));
    }
  }

 private:
  py::function solve_;
  Needs needs_;
  Options options_;
  Index iterations_;
};

Needs needs_of(const std::vector<std::string>& names) {
  Needs all = Needs::forward;
  for (const auto& name : names) {
    unsigned bit = 1;
    while (bit < 256 && to_text(static_cast<Needs>(bit)) != name) bit *= 2;
    if (bit == 256)
      throw py::value_error("there is no ability '" + name + "'; " +
                            to_text(static_cast<Needs>(255)) + " are");
    all = all | static_cast<Needs>(bit);
  }
  return all;
}

/// Wherever a profile of the experiment has rows, on their n and seeds.
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
std::vector<std::string> add_method(
    const std::string& id,
    const py::function& solve,
    const std::vector<std::string>& experiments,
    const std::vector<std::string>& needs,
    const std::vector<std::pair<std::string, std::string>>& options,
    Index iterations) {
  Options all = {{"algorithm", "python"}};
  all.insert(all.end(), options.begin(), options.end());
  const Method method{.id = id,
                      .chain = {std::make_shared<PythonStage>(
                          solve, needs_of(needs), all, iterations)}};
  Registry next;
  std::vector<std::string> added;
  for (const auto& e : registry().experiments()) {
    const bool chosen =
        std::count(experiments.begin(), experiments.end(), e->name) > 0 &&
        contains(e->problem.provided, method.needs());
    if (!chosen) {
      next.add(Experiment(*e));
      continue;
    }
    const Method* there = find_method(*e, id);
    if (there != nullptr &&
        dynamic_cast<const PythonStage*>(there->chain.front().get()) == nullptr)
      throw py::value_error(
          fmt::format("{} has a method {} of the suite's; give yours another "
                      "name",
                      e->name,
                      id));
    added.push_back(e->name);
    next.add(with_method(*e, method));
  }
  for (const Overview& o : registry().overviews()) next.add(o);
  registry() = std::move(next);
  return added;
}

bool running = false;

/// A worker is a fork, and Python is to know.
void after_fork() {
  if (running) PyOS_AfterFork_Child();
}

/// Status and last words of the verb `run`, in this process.
py::tuple run(const Arguments& arguments) {
  static const int kRegistered = pthread_atfork(nullptr, nullptr, after_fork);
  (void)kRegistered;
  running = true;
  int status = static_cast<int>(ExitCode::good);
  std::string words;
  try {
    status = static_cast<int>(run_verb(arguments));
  } catch (const ExitError& error) {
    status = static_cast<int>(error.code());
    words = error.what();
  } catch (const std::exception& error) {
    status = static_cast<int>(ExitCode::internal);
    words = error.what();
  }
  running = false;
  std::fflush(stdout);
  return py::make_tuple(status, words);
}

}  // namespace

void define_method(py::module_& module) {
  py::options signatures;
  signatures.disable_function_signatures();
  const auto active = py::arg("active") = py::none();
  py::class_<Solving, std::shared_ptr<Solving>>(
      module,
      "Run",
      "What a method sees of its case: n problems without their solutions, all "
      "calls\ncounted, a budget. Arrays are in double.")
      .def_property_readonly("n", &Solving::n, "Problems of the case.")
      .def_property_readonly("iterations", &Solving::iterations, "The budget.")
      .def_property_readonly(
          "gtol",
          &Solving::gtol,
          "The norm of a gradient (largest entry) at which a problem counts as "
          "solved.")
      .def_property_readonly(
          "start", &Solving::start, "First guesses: (n, unknowns).")
      .def_property_readonly(
          "given", &Solving::given, "Side input: (n, side input).")
      .def_property_readonly("observations",
                             &Solving::observations,
                             "What x is sought for: (n, observations).")
      .def_property_readonly(
          "seed",
          &Solving::seed,
          "For the method's own random numbers; each reading "
          "gives another.")
      .def(
          "loss",
          &Solving::loss,
          py::arg("x"),
          active,
          "loss($self, x, active=None)\n--\n\n"
          "Losses (k,) at x (k, unknowns) of the problems `active`, by default "
          "all n;\ncounted.")
      .def("loss_and_gradient",
           &Solving::loss_and_gradient,
           py::arg("x"),
           active,
           "loss_and_gradient($self, x, active=None)\n--\n\n"
           "Losses (k,) and d loss / d x (k, unknowns); counted. Needs vjp.")
      .def("labelled",
           &Solving::labelled,
           py::arg("per_problem") = 1,
           "labelled($self, per_problem=1)\n--\n\n"
           "x, y and given, so many for each problem, to learn from. Needs "
           "labels.")
      .def(
          "proceed",
          &Solving::proceed,
          py::arg("x"),
          "proceed($self, x)\n--\n\n"
          "while run.proceed(x): counts an iteration, measures x (n, unknowns) "
          "while the\nclock stands still, and is False when the budget is "
          "spent.")
      .def("accept",
           &Solving::accept,
           py::arg("example"),
           py::arg("iteration"),
           py::arg("x"),
           py::arg("loss"),
           "accept($self, example, iteration, x, loss)\n--\n\n"
           "For solvers that go example by example: its iterate x (unknowns,), "
           "from\niteration 0, the start, on.");
  module.def("add_method", &add_method);
  module.def("run", &run);
}

}  // namespace physinv::python
