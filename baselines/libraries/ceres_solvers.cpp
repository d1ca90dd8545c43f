#include "ceres_solvers.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <ceres/version.h>
#include <glog/logging.h>

#include <algorithm>
#include <string>

#include "library_stage.h"

namespace libraries {
namespace {

using Options = ceres::GradientProblemSolver::Options;

Options defaults(CeresDirection direction) {
  Options options;
  options.line_search_direction_type =
      direction == CeresDirection::bfgs ? ceres::BFGS : ceres::LBFGS;
  return options;
}

/// Deleted by its ceres::GradientProblem.
class Function final : public ceres::FirstOrderFunction {
 public:
  Function(Objective& objective, Index d)
      : objective_(objective), unused_(Vector<double>::Zero(d)) {}

  bool Evaluate(const double* x,
                double* loss,
                double* gradient) const override {
    *loss =
        objective_.evaluate(x, gradient == nullptr ? unused_.data() : gradient);
    return true;
  }
  int NumParameters() const override {
    return static_cast<int>(unused_.size());
  }

 private:
  Objective& objective_;
  mutable Vector<double> unused_;
};

/// Ceres moves x on after every iteration.
class Iterates final : public ceres::IterationCallback {
 public:
  Iterates(Objective& objective, const Vector<double>& x)
      : objective_(objective), x_(x) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary&) override {
    objective_.iterate(x_.data());
    return ceres::SOLVER_CONTINUE;
  }

 private:
  Objective& objective_;
  const Vector<double>& x_;
};

/// Which tolerance was reached is only in the message.
Status status_of(const ceres::GradientProblemSolver::Summary& summary) {
  switch (summary.termination_type) {
    case ceres::CONVERGENCE:
      return summary.message.starts_with("Function tolerance") ? Status::ftol
                                                               : Status::gtol;
    case ceres::NO_CONVERGENCE:
      return Status::maxiter;
    default:
      return Status::linesearch;
  }
}

/// Without the numbers of the one problem: "Gradient tolerance reached".
std::string words_of(const ceres::GradientProblemSolver::Summary& summary) {
  std::string words = summary.message;
  words.resize(std::min(
      {words.find(". "), words.find_first_of("0123456789"), words.size()}));
  words.resize(words.find_last_not_of(" .:") + 1);
  return std::string(ceres::TerminationTypeToString(summary.termination_type)) +
         ", " + words;
}

LibraryEnd minimize(CeresDirection direction,
                    Objective& objective,
                    const Vector<double>& x0,
                    Index iterations) {
  LibraryEnd end{.x = x0};
  Iterates iterates(objective, end.x);
  Options options = defaults(direction);
  options.max_num_iterations = static_cast<int>(iterations);
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = true;
  options.callbacks = {&iterates};
  const ceres::GradientProblem problem(new Function(objective, x0.size()));
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, end.x.data(), &summary);
  end.loss = summary.final_cost;
  end.status = status_of(summary);
  end.success = physinv::converged(end.status);
  end.message = words_of(summary);
  return end;
}

}  // namespace

std::shared_ptr<const physinv::Stage> ceres_solve(CeresDirection direction,
                                                  const Task& task) {
  const bool bfgs = direction == CeresDirection::bfgs;
  const Options options = defaults(direction);
  return library_solve(
      {.options = {{"algorithm", bfgs ? "ceres_bfgs" : "ceres_lbfgs"},
                   {"function_tolerance",
                    physinv::text_of(options.function_tolerance)},
                   {"gradient_tolerance",
                    physinv::text_of(options.gradient_tolerance)},
                   {"parameter_tolerance",
                    physinv::text_of(options.parameter_tolerance)},
                   {"library", "ceres " CERES_VERSION_STRING}},
       .task = task},
      [direction](double) -> Library {
        FLAGS_minloglevel = google::GLOG_FATAL;  // the end has its own words
        return
            [direction](Objective& f, const Vector<double>& x0, Index limit) {
              return minimize(direction, f, x0, limit);
            };
      });
}

}  // namespace libraries
