#include "suite/diagnostics/diagnostic.h"

#include <cmath>

#include "suite/core/hash.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {

Options Diagnostic::options() const {
  return chained({{"algorithm", "diagnostic"}, {"diagnostic", kind()}},
                 settings());
}

Sources Diagnostic::sources() const {
  Sources all = Stage::sources();
  for (const auto& problem : problems()) all.roots.push_back(problem.source);
  return all;
}

Outcome Diagnostic::run(StageRun& run) const {
  Outcome out;
  out.x = run.oracle.start();
  diagnose(run, out);
  out.stop = Stop::converged;
  // The curve's only point, unless the diagnosis made some itself.
  const auto start = [&](BatchOut<double> x) { x = out.x; };
  run.probe.stop();
  if (run.probe.curve().points() == 0) run.probe.proceed(start);
  return out;
}

std::string fingerprint(const std::vector<ProblemRecipe>& problems) {
  std::string text;
  for (const auto& problem : problems) {
    text += problem.name + '\n';
    for (const auto& [name, value] : problem.options)
      text += name + '=' + value + '\n';
  }
  return hex64(hash_text(text));
}

double relative_distance(VectorIn<double> a, VectorIn<double> b) {
  const double scale = b.norm(), distance = (a - b).norm();
  return scale > 0 ? distance / scale : distance;
}

double number_or_none(double value) {
  return std::isfinite(value) ? value : -1;
}

}  // namespace physinv
