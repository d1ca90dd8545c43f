#include "dlib_solvers.h"

#include <dlib/optimization/optimization.h>
#include <dlib/revision.h>
#include <fmt/format.h>

#include <algorithm>

#include "library_stage.h"
#include "suite/core/check.h"

namespace libraries {
namespace {

using Column = dlib::matrix<double, 0, 1>;

/// dlib asks for the loss and then, at the same point, for the gradient.
struct Function {
  Objective& objective;
  mutable Column slope;

  double loss(const Column& x) const {
    slope.set_size(x.size());
    return objective.evaluate(&x(0), &slope(0));
  }
  Column gradient(const Column& x) const { return loss(x), slope; }
};

/// dlib's test, and its answer; copies share it.
struct Test {
  Objective& objective;
  dlib::objective_delta_stop_strategy changes;
  Index left;
  bool& converged;

  bool should_continue_search(const Column& x,
                              double loss,
                              const Column& gradient) {
    objective.iterate(&x(0));
    converged = !changes.should_continue_search(x, loss, gradient);
    return !converged && left-- > 0;
  }
};

Column column(const std::vector<double>& numbers) { return dlib::mat(numbers); }

/// `strategy` makes it in its place: dlib copies members that are not set yet.
template <class Strategy>
LibraryEnd minimize(const Task& task,
                    const DlibOptions& options,
                    Strategy strategy,
                    Objective& objective,
                    const Vector<double>& x0,
                    Index iterations) {
  const Function f{objective, {}};
  bool converged = false;
  Column x(x0.size());
  std::copy_n(x0.data(), x0.size(), x.begin());
  const Test test{objective,
                  dlib::objective_delta_stop_strategy(options.min_delta),
                  iterations,
                  converged};
  const auto value = [&f](const Column& at) { return f.loss(at); };
  const auto slope = [&f](const Column& at) { return f.gradient(at); };
  const double loss =
      task.lower.empty()
          ? dlib::find_min(strategy(), test, value, slope, x, options.min_loss)
          : dlib::find_min_box_constrained(strategy(),
                                           test,
                                           value,
                                           slope,
                                           x,
                                           column(task.lower),
                                           column(task.upper));
  return {.x = Eigen::Map<const Vector<double>>(&x(0), x0.size()),
          .loss = loss,
          .status = converged ? Status::ftol : Status::maxiter,
          .success = converged,
          .message = converged ? "change of the loss below min_delta"
                               : "limit of iterations"};
}

}  // namespace

std::shared_ptr<const physinv::Stage> dlib_solve(const Task& task,
                                                 const DlibOptions& options) {
  SUITE_CHECK(options.min_delta >= 0 && options.memory > 0,
              "dlib: min_delta must not be negative, memory must be positive");
  return library_solve(
      {.options = physinv::chained(physinv::describe(options),
                                   {{"library",
                                     fmt::format("dlib {}.{}.{}",
                                                 DLIB_MAJOR_VERSION,
                                                 DLIB_MINOR_VERSION,
                                                 DLIB_PATCH_VERSION)}}),
       .task = task},
      [task, options](double) -> Library {
        return [=](Objective& f, const Vector<double>& x0, Index limit) {
          if (options.strategy == DlibStrategy::bfgs)
            return minimize(
                task,
                options,
                [] { return dlib::bfgs_search_strategy(); },
                f,
                x0,
                limit);
          return minimize(
              task,
              options,
              [&] {
                return dlib::lbfgs_search_strategy(
                    static_cast<unsigned long>(options.memory));
              },
              f,
              x0,
              limit);
        };
      });
}

}  // namespace libraries
