#include "suite/cases/sip/wave_packet/values.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "suite/evidence/curve.h"
#include "suite/store/record.h"

namespace physinv::sip_wave_packet {
namespace {

/// f(t0, t0*) of the examples whose t0* is so far from the start.
template <class F>
RunRow of_examples(double from, double to, F f) {
  return [=](const Run& run) {
    std::vector<double> values;
    for (Index i = 0; i < run.stage->x.cols(); ++i) {
      const double truth = run.record->data.x(0, i);
      if (std::abs(truth) >= from && std::abs(truth) < to)
        values.push_back(f(run.stage->x(0, i), truth));
    }
    return values;
  };
}

constexpr double kAnywhere = std::numeric_limits<double>::infinity();

RunValue of_lbfgs(RunRow row) {
  return beside({"lbfgs"}, of_row(std::move(row), mean_of));
}

}  // namespace

RunRow errors(double from, double to) {
  return of_examples(
      from, to, [](double t0, double truth) { return std::abs(t0 - truth); });
}

RunRow moves(double from) {
  return of_examples(
      from, kAnywhere, [](double t0, double) { return std::abs(t0); });
}

RunRow off_period() {
  return of_examples(0, kAnywhere, [](double t0, double truth) {
    return std::abs(std::remainder(t0 - truth, kPeriod));
  });
}

RunRow off_missed_period(double from, double to) {
  return of_examples(from, to, [](double t0, double truth) {
    const double error = std::abs(t0 - truth);
    return error < kBasin ? kAnywhere
                          : std::abs(std::remainder(error, kPeriod));
  });
}

RunRow loss_over_lbfgs() {
  return [](const Run& run) -> std::vector<double> {
    const auto other = run.beside({"lbfgs"});
    if (!other || other->stage->loss.size() != run.stage->loss.size())
      return {};
    const auto& base = other->stage->loss.array();
    const Vector<double> left = (run.stage->loss.array() - base) / base;
    return {left.begin(), left.end()};
  };
}

RunValue in_basin() {
  return of_row(
      [](const Run& run) {
        std::vector<double> flags = errors()(run);
        for (double& e : flags) e = e <= kBasin ? 1 : 0;
        return flags;
      },
      mean_of);
}

RunValue passes_lbfgs() { return time_to(updates(), of_lbfgs(losses())); }

RunValue passes_lbfgs_error() {
  return [level = of_lbfgs(errors())](const Run& run) -> std::optional<double> {
    const auto error = level(run);
    if (!error) return {};
    return first_below(*error, {"metrics", kMeanError})(run);
  };
}

}  // namespace physinv::sip_wave_packet
