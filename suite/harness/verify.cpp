#include "suite/harness/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "suite/core/hash.h"

namespace physinv {
namespace {

/// Loss of one example alone.
double loss_of(const Problem<double>& problem,
               const CaseData& data,
               const Batch<double>& x,
               Index i,
               Workspace& work) {
  Batch<double> y(data.y.rows(), 1);
  Vector<double> loss(1);
  Batch<double> given(data.given.rows(), 1);
  if (given.rows() > 0) given = data.given.col(i);
  problem.forward({x.col(i), given}, y, work);
  problem.loss(y, data.y.col(i), loss);
  return loss(0);
}

/// Estimates of all examples by plain loops through the setting's predictor;
/// empty if they cannot be made.
Batch<double> plain_estimates(const Experiment& experiment,
                              const Problem<double>& problem,
                              const CaseData& data,
                              const Vector<double>& parameters) {
  const NetworkRole& role = experiment.setting.predictor;
  if (parameters.size() == 0 || !role.recipe.make_double ||
      experiment.setting.output_form != OutputForm::linear)
    return {};
  Index rows = 0;
  for (const Field field : role.inputs) {
    if (field == Field::unknowns) return {};
    rows += field == Field::given ? data.given.rows() : data.y.rows();
  }
  const Shape shape = problem.shape();
  const auto net = role.recipe.make<double>(rows, shape.unknowns);
  if (net->parameter_count() != parameters.size()) return {};
  const Vector<double> start = problem.start();
  Batch<double> x(shape.unknowns, data.y.cols());
  Vector<double> in(rows), out;
  for (Index i = 0; i < x.cols(); ++i) {
    Index at = 0;
    for (const Field field : role.inputs) {
      const auto& part = field == Field::given ? data.given : data.y;
      in.segment(at, part.rows()) = part.col(i);
      at += part.rows();
    }
    if (!net->evaluate_plainly(parameters, in, out)) return {};
    for (Index j = 0; j < x.rows(); ++j)
      x(j, i) = start(j) + experiment.setting.output_scale * out(j);
  }
  return x;
}

/// Each parameter moved by what rounding moves a sum of a layer's length, to
/// either side.
Vector<double> rounded(const Vector<double>& parameters) {
  constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
  Vector<double> moved = parameters;
  for (Index k = 0; k < moved.size(); ++k) {
    const bool up = hash_bytes(&k, sizeof(k)) % 2 == 0;
    moved(k) *= 1 + (up ? kRounding : -kRounding);
  }
  return moved;
}

enum class Match { bitwise, close, none };

Match compare(double a, double b, double relative, double absolute = 0) {
  if (std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
      (!std::isfinite(a) && !std::isfinite(b)))
    return Match::bitwise;
  const double size = std::max(std::abs(a), std::abs(b));
  return std::abs(a - b) <= relative * size + absolute ? Match::close
                                                       : Match::none;
}

/// "case stage example 3: recorded 1, is 2"
std::string mismatch(const CaseRecord& c,
                     const StageRecord& stage,
                     const std::string& what,
                     double recorded,
                     double is) {
  return fmt::format("{} {} {}: recorded {:.17g}, is {:.17g}",
                     c.info.name,
                     stage.stage,
                     what,
                     recorded,
                     is);
}

std::string example(Index i) { return fmt::format("example {}", i); }

/// What is stored of some examples alone, and their mean.
void verify_by_network(const Experiment& experiment,
                       const Problem<double>& problem,
                       const CaseRecord& c,
                       const StageRecord& stage,
                       Workspace& work,
                       VerifyReport& report) {
  const Index n = stage.loss.size();
  const auto stored = stage.arrays.find("parameters");
  const Vector<double> parameters =
      stored != stage.arrays.end() ? Vector<double>(stored->second.reshaped())
                                   : Vector<double>();
  const auto losses = [&](const Vector<double>& p) {
    const Batch<double> x = plain_estimates(experiment, problem, c.data, p);
    Vector<double> loss(x.cols());
    for (Index i = 0; i < x.cols(); ++i)
      loss(i) = loss_of(problem, c.data, x, i, work);
    return loss;
  };
  const Vector<double> loss = losses(parameters);
  if (loss.size() != n) {
    report.not_again += static_cast<std::size_t>(n - stage.x.cols());
    return;
  }
  // How far rounding alone moves them, if somebody asks.
  std::optional<Vector<double>> moves;
  const auto expect =
      [&](const std::string& what, double recorded, double is, auto&& move) {
        ++report.losses;
        ++report.by_network;
        if (compare(recorded, is, kPlainTolerance, 1e-13) != Match::none)
          return;
        if (!moves) moves = (losses(rounded(parameters)) - loss).cwiseAbs();
        if (std::abs(recorded - is) <= kRoundings * move(*moves)) return;
        report.mismatches.push_back(mismatch(c, stage, what, recorded, is) +
                                    " by plain loops");
      };
  for (Index i = stage.x.cols(); i < n; ++i)
    expect(example(i), stage.loss(i), loss(i), [&](const auto& m) {
      return m(i);
    });
  const auto mean = stage.arrays.find("mean_loss");
  if (mean == stage.arrays.end() || mean->second.size() == 0) return;
  // Arrays hold the largest number where there is none.
  const double is = std::isfinite(loss.mean())
                        ? loss.mean()
                        : std::numeric_limits<double>::max();
  expect(
      "mean_loss", mean->second.reshaped()(Eigen::last), is, [](const auto& m) {
        return m.mean();
      });
}

void verify_stage(const Experiment& experiment,
                  const Problem<double>& problem,
                  const CaseRecord& c,
                  const StageRecord& stage,
                  Workspace& work,
                  VerifyReport& report) {
  ++report.stages;
  const Index n = c.data.y.cols();
  const Shape shape = problem.shape();
  if (stage.x.cols() > n || stage.x.cols() == 0 || stage.loss.size() != n ||
      stage.x.rows() != shape.unknowns ||
      c.data.y.rows() != shape.observations ||
      c.data.given.rows() != shape.given || c.data.given.cols() != n) {
    report.mismatches.push_back(fmt::format(
        "{} {}: the store has solutions of {} examples, but data of {}",
        c.info.name,
        stage.stage,
        stage.x.cols(),
        n));
    return;
  }
  for (Index i = 0; i < stage.x.cols(); ++i) {
    ++report.losses;
    const double again = loss_of(problem, c.data, stage.x, i, work);
    switch (compare(again, stage.loss(i), kVerifyTolerance)) {
      case Match::bitwise:
        ++report.bitwise;
        break;
      case Match::close:
        ++report.close;
        break;
      case Match::none:
        report.mismatches.push_back(
            mismatch(c, stage, example(i), stage.loss(i), again));
    }
  }
  if (stage.x.cols() < n)
    verify_by_network(experiment, problem, c, stage, work, report);
}

}  // namespace

VerifyReport verify_results(const Results& results, const Registry& registry) {
  VerifyReport report;
  std::map<std::string, std::unique_ptr<Problem<double>>> problems;
  Workspace work;
  for (const CaseRecord& c : results.cases()) {
    const auto experiment = registry.find(c.info.experiment);
    if (!experiment) {
      if (std::find(report.unknown.begin(),
                    report.unknown.end(),
                    c.info.experiment) == report.unknown.end())
        report.unknown.push_back(c.info.experiment);
      continue;
    }
    auto& problem = problems[c.info.experiment];
    if (!problem) problem = experiment->problem.make<double>();
    for (const StageRecord& stage : c.stages) {
      if (stage.stop == Stop::failed || stage.stop == Stop::skipped) continue;
      verify_stage(*experiment, *problem, c, stage, work, report);
    }
  }
  return report;
}

}  // namespace physinv
