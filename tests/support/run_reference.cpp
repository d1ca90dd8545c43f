#include "tests/support/run_reference.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace physinv::test {
int scipy_status(Status status) {
  return converged(status) ? 0 : status == Status::maxiter ? 1 : 2;
}

void expect_run(const Json& entry,
                const Json& stored,
                const RecordedRun& run,
                Index compared) {
  const EntryTolerance tolerance(entry);
  const Batch<double> iterates = columns(stored.at("iterates"));
  ASSERT_GE(iterates.cols(), 1);
  const Vector<double> losses = vector(stored.at("losses"), iterates.cols());
  const double loss = stored.at("loss");
  // What the file says twice.
  EXPECT_EQ(losses(losses.size() - 1), loss);
  EXPECT_EQ(iterates.rightCols<1>(), vector(stored.at("x"), iterates.rows()));
  const auto near = tolerance.iterates();
  EXPECT_TRUE(near(run.losses(0), losses(0)));
  const Index count =
      std::min({compared + 1, iterates.cols(), run.iterates.cols()});
  ASSERT_GE(run.iterates.cols(), std::min(compared + 1, iterates.cols()));
  if (tolerance.first_only()) {
    for (Index k = 0; k < count; ++k)
      EXPECT_TRUE(near(run.iterates.col(k), iterates.col(k))) << "at " << k;
  } else {
    EXPECT_TRUE(near(run.iterates.leftCols(count), iterates.leftCols(count)));
  }

  const int status = stored.at("status");
  const Index iterations = stored.at("iterations");
  const double evaluations = stored.at("evaluations");
  const bool short_run = status == 0 && iterations < 30;
  if (status != 2) {
    EXPECT_EQ(scipy_status(run.status), status);
  }
  if (short_run) {
    EXPECT_NEAR(static_cast<double>(run.iterations),
                static_cast<double>(iterations),
                1);
    EXPECT_NEAR(static_cast<double>(run.evaluations), evaluations, 2);
  }
  const double last = run.losses(run.losses.size() - 1);
  const auto ends = tolerance.final_loss(last, loss, 1e-6);
  EXPECT_TRUE(status == 2 || ends) << ends.message();
}

}  // namespace physinv::test
