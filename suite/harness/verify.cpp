#include "suite/harness/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <memory>

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
  problem.forward(x.col(i), given, y, work);
  problem.loss(y, data.y.col(i), loss);
  return loss(0);
}

enum class Match { bitwise, close, none };

Match compare(double a, double b) {
  if (std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
      (!std::isfinite(a) && !std::isfinite(b)))
    return Match::bitwise;
  return std::abs(a - b) <=
                 kVerifyTolerance * std::max(std::abs(a), std::abs(b))
             ? Match::close
             : Match::none;
}

void verify_stage(const Problem<double>& problem,
                  const CaseRecord& c,
                  const StageRecord& stage,
                  Workspace& work,
                  VerifyReport& report) {
  ++report.stages;
  const Index n = c.data.y.cols();
  if (stage.x.cols() > n || stage.x.cols() == 0 || stage.loss.size() != n ||
      stage.x.rows() != problem.shape().unknowns) {
    report.mismatches.push_back(
        fmt::format("{} {}: solutions of {} examples stored, data of {}",
                    c.info.name,
                    stage.stage,
                    stage.x.cols(),
                    n));
    return;
  }
  for (Index i = 0; i < stage.x.cols(); ++i) {
    ++report.losses;
    const double again = loss_of(problem, c.data, stage.x, i, work);
    switch (compare(again, stage.loss(i))) {
      case Match::bitwise:
        ++report.bitwise;
        break;
      case Match::close:
        ++report.close;
        break;
      case Match::none:
        report.mismatches.push_back(
            fmt::format("{} {} example {}: recorded {:.17g}, is {:.17g}",
                        c.info.name,
                        stage.stage,
                        i,
                        stage.loss(i),
                        again));
    }
  }
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
      verify_stage(*problem, c, stage, work, report);
    }
  }
  return report;
}

}  // namespace physinv
