#include "optimizers/metrics.h"

#include <cmath>
#include <limits>

#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {

MetricsRecorder::MetricsRecorder(const Metrics& metrics, const StageRun& run)
    : metrics_(metrics),
      run_(run),
      values_(static_cast<Index>(metrics.rows.size()), 0) {}

void MetricsRecorder::operator()(VectorIn<double> parameters,
                                 BatchIn<double> x,
                                 BatchIn<double> y) {
  values_.conservativeResize(Eigen::NoChange, values_.cols() + 1);
  Vector<double> now(values_.rows());
  metrics_.evaluate({run_.probe.iteration(), parameters, x, y, run_.oracle},
                    now);
  values_.rightCols(1) = now;
}

Batch<double> as_row(const std::vector<double>& values) {
  return Eigen::Map<const Batch<double>>(
      values.data(), 1, static_cast<Index>(values.size()));
}

void keep_finite(Arrays& arrays) {
  for (auto& [name, array] : arrays)
    array = array.unaryExpr([](double value) {
      constexpr double kMost = std::numeric_limits<double>::max();
      return std::isfinite(value) ? value : kMost;
    });
}

}  // namespace physinv
