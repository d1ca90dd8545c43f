#include "suite/results/tidy.h"

#include <gtest/gtest.h>

#include <limits>

#include "suite/store/catalog.h"
#include "suite/store/missing_work.h"

namespace physinv {
namespace {

TEST(Tidy, WhatAMethodSaysOfItsWorkStandsBesideWhatWasCounted) {
  CaseRecord c;
  c.info.name = "a/case";
  c.info.n = 2;
  StageRecord r;
  r.stage = "solve";
  r.loss = Vector<double>::Ones(2);
  r.status.assign(2, Status::maxiter);
  r.example_iterations = r.example_evaluations =
      Vector<double>::Constant(2, 7.0);
  Batch<double> claimed(1, 2);
  claimed << 12, std::numeric_limits<double>::quiet_NaN();
  r.arrays[ArrayKey::own("claimed_iterations")] = claimed;
  claimed << 2, 0;
  r.arrays[ArrayKey::own("overrun")] = claimed;
  c.stages = {r};
  const std::string text = tidy_csv(Catalog(), {c}, {});
  EXPECT_NE(text.find(",iterations,evaluations,claimed_iterations,"
                      "claimed_evaluations,overrun,"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(",maxiter,7,7,12,,2,"), std::string::npos) << text;
  EXPECT_NE(text.find(",maxiter,7,7,,,0,"), std::string::npos) << text;
}

}  // namespace
}  // namespace physinv
