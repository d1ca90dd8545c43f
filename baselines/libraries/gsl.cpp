#include "gsl.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multimin.h>
#include <gsl/gsl_version.h>

#include <memory>
#include <new>
#include <string>

#include "library_stage.h"
#include "suite/core/check.h"

namespace libraries {
namespace {

using Minimizer = std::unique_ptr<gsl_multimin_fdfminimizer,
                                  decltype(&gsl_multimin_fdfminimizer_free)>;

/// GSL's three functions; loss and gradient come together, and a second call at
/// one point is answered from the first.
struct Functions {
  Objective& objective;
  Vector<double> x, gradient;

  double at(const gsl_vector* point, gsl_vector* slope) {
    for (Index j = 0; j < x.size(); ++j)
      x(j) = gsl_vector_get(point, static_cast<std::size_t>(j));
    const double loss = objective.evaluate(x.data(), gradient.data());
    for (Index j = 0; slope != nullptr && j < x.size(); ++j)
      gsl_vector_set(slope, static_cast<std::size_t>(j), gradient(j));
    return loss;
  }
  static double f(const gsl_vector* x, void* self) {
    return static_cast<Functions*>(self)->at(x, nullptr);
  }
  static void df(const gsl_vector* x, void* self, gsl_vector* slope) {
    static_cast<Functions*>(self)->at(x, slope);
  }
  static void fdf(const gsl_vector* x,
                  void* self,
                  double* loss,
                  gsl_vector* slope) {
    *loss = static_cast<Functions*>(self)->at(x, slope);
  }
};

Status status_of(int code) {
  switch (code) {
    case GSL_SUCCESS:
      return Status::gtol;
    case GSL_CONTINUE:
      return Status::maxiter;
    default:
      return Status::linesearch;
  }
}

LibraryEnd minimize(const GslOptions& options,
                    double gtol,
                    Objective& objective,
                    const Vector<double>& x0,
                    Index iterations) {
  const auto d = static_cast<std::size_t>(x0.size());
  Functions functions{objective, x0, x0};
  gsl_multimin_function_fdf fdf{
      Functions::f, Functions::df, Functions::fdf, d, &functions};
  const Minimizer minimizer(gsl_multimin_fdfminimizer_alloc(
                                gsl_multimin_fdfminimizer_vector_bfgs2, d),
                            gsl_multimin_fdfminimizer_free);
  if (minimizer == nullptr) throw std::bad_alloc();
  const gsl_vector_const_view start = gsl_vector_const_view_array(x0.data(), d);
  int code = gsl_multimin_fdfminimizer_set(
      minimizer.get(), &fdf, &start.vector, options.step, options.tol);
  if (code == GSL_SUCCESS) code = GSL_CONTINUE;
  const auto x = [&] {
    return Eigen::Map<const Vector<double>>(
        gsl_multimin_fdfminimizer_x(minimizer.get())->data, x0.size());
  };
  for (Index k = 0; k < iterations && code == GSL_CONTINUE; ++k) {
    code = gsl_multimin_fdfminimizer_iterate(minimizer.get());
    if (code != GSL_SUCCESS) break;
    objective.iterate(x().data());
    code = gsl_multimin_test_gradient(
        gsl_multimin_fdfminimizer_gradient(minimizer.get()), gtol);
  }
  return {.x = x(),
          .loss = gsl_multimin_fdfminimizer_minimum(minimizer.get()),
          .status = status_of(code),
          .success = code == GSL_SUCCESS,
          .message = gsl_strerror(code)};
}

}  // namespace

std::shared_ptr<const physinv::Stage> gsl_bfgs2(const Task& task,
                                                const GslOptions& options) {
  SUITE_CHECK(options.step > 0 && options.tol > 0,
              "GSL: step and tol must be positive");
  return library_solve(
      {.options =
           physinv::chained(physinv::describe(options),
                            {{"library", std::string("gsl ") + gsl_version}}),
       .task = task},
      [options](double gtol) -> Library {
        gsl_set_error_handler_off();  // errors are values
        return [options, gtol](
                   Objective& f, const Vector<double>& x0, Index iterations) {
          return minimize(options, gtol, f, x0, iterations);
        };
      });
}

}  // namespace libraries
