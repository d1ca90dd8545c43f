#include "nlopt_solvers.h"

#include <fmt/format.h>
#include <nlopt.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <type_traits>

#include "library_stage.h"

namespace libraries {
namespace {

struct Kind {
  nlopt_algorithm algorithm;
  const char* name;
};

Kind kind_of(NloptAlgorithm algorithm) {
  switch (algorithm) {
    case NloptAlgorithm::lbfgs:
      return {NLOPT_LD_LBFGS, "nlopt_lbfgs"};
    case NloptAlgorithm::slsqp:
      return {NLOPT_LD_SLSQP, "nlopt_slsqp"};
    case NloptAlgorithm::mma:
      break;
  }
  return {NLOPT_LD_MMA, "nlopt_mma"};
}

struct Call {
  Objective& objective;
  nlopt_opt solver;
  Vector<double> gradient;
  double best;
  std::exception_ptr thrown = {};

  /// No exception passes NLopt, which is C: `force_stop` stops it instead.
  static double f(unsigned d, const double* x, double* slope, void* self) {
    auto& call = *static_cast<Call*>(self);
    double loss = std::numeric_limits<double>::quiet_NaN();
    try {
      loss = call.objective.evaluate(x, call.gradient.data());
    } catch (...) {
      call.thrown = std::current_exception();
      nlopt_force_stop(call.solver);
      return loss;
    }
    if (slope != nullptr) std::copy_n(call.gradient.data(), d, slope);
    if (loss < call.best) {
      call.best = loss;
      call.objective.iterate(x);
    }
    return loss;
  }
};

Status status_of(nlopt_result result) {
  if (result == NLOPT_MAXEVAL_REACHED || result == NLOPT_MAXTIME_REACHED)
    return Status::maxiter;
  if (result == NLOPT_FTOL_REACHED) return Status::ftol;
  return result > 0 ? Status::gtol : Status::linesearch;
}

LibraryEnd minimize(Kind kind,
                    const Task& task,
                    Objective& objective,
                    const Vector<double>& x0,
                    Index iterations) {
  using Handle = std::unique_ptr<std::remove_pointer_t<nlopt_opt>,
                                 decltype(&nlopt_destroy)>;
  const Handle solver(
      nlopt_create(kind.algorithm, static_cast<unsigned>(x0.size())),
      nlopt_destroy);
  if (solver == nullptr) throw std::bad_alloc();
  Call call{
      objective, solver.get(), x0, std::numeric_limits<double>::infinity()};
  nlopt_set_min_objective(solver.get(), Call::f, &call);
  // 0 would be no limit.
  nlopt_set_maxeval(solver.get(),
                    static_cast<int>(std::max<Index>(iterations, 1)));
  if (!task.lower.empty()) {
    nlopt_set_lower_bounds(solver.get(), task.lower.data());
    nlopt_set_upper_bounds(solver.get(), task.upper.data());
  }
  LibraryEnd end{.x = x0};
  const nlopt_result result =
      nlopt_optimize(solver.get(), end.x.data(), &end.loss);
  if (call.thrown) std::rethrow_exception(call.thrown);
  if (result == NLOPT_INVALID_ARGS)  // it evaluated nothing
    end.loss = std::numeric_limits<double>::quiet_NaN();
  end.status = status_of(result);
  end.success = physinv::converged(end.status);
  end.message = nlopt_result_to_string(result);
  return end;
}

std::string version() {
  int major = 0, minor = 0, fix = 0;
  nlopt_version(&major, &minor, &fix);
  return fmt::format("nlopt {}.{}.{}", major, minor, fix);
}

}  // namespace

std::shared_ptr<const physinv::Stage> nlopt_solve(NloptAlgorithm algorithm,
                                                  const Task& task) {
  const Kind kind = kind_of(algorithm);
  return library_solve(
      {.options = {{"algorithm", kind.name}, {"library", version()}},
       .task = task},
      [kind, task](double) -> Library {
        return [=](Objective& f, const Vector<double>& x0, Index limit) {
          return minimize(kind, task, f, x0, limit);
        };
      });
}

}  // namespace libraries
