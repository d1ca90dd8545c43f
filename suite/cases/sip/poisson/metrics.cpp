#include "suite/cases/sip/poisson/metrics.h"

#include <fmt/format.h>

#include "problems/poisson/poisson.h"
#include "suite/core/oracle.h"

namespace physinv::poisson {

Metrics metrics() {
  return {.name = "poisson",
          .rows = {"error", "of_zero"},
          .evaluate = [](const Snapshot& s, VectorOut<double> values) {
            const Batch<double>& truth = s.oracle.data().x;
            values(kError) = (s.x - truth).colwise().lpNorm<1>().mean();
            values(kOfZero) = truth.colwise().lpNorm<1>().mean();
          }};
}

LateError late_error(Index rows, Index columns) {
  return {.name = fmt::format("error {}x{}", rows, columns),
          .share = 0.25,
          .of = [=](BatchIn<double> x, BatchIn<double> y) {
            double sum = 0;
            for (Index i = 0; i < x.cols(); ++i) {
              const Batch<double> field = Eigen::Map<const Batch<double>>(
                  y.col(i).data(), columns, rows);
              sum += (x.col(i) - laplacian(field).reshaped()).lpNorm<1>();
            }
            return sum / static_cast<double>(x.cols());
          }};
}

}  // namespace physinv::poisson
