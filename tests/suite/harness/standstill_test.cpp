#include "suite/harness/standstill.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <vector>

#include "suite/core/clock.h"

namespace physinv {
namespace {

TEST(Standstill, WhoNeitherTellsNorComputesIsFoundOnce) {
  Standstill still(60);
  EXPECT_FALSE(still.found(3, 1000, 0));  // no case at hand
  still.moved(3, 0);
  std::vector<double> found;
  for (double t = 1; t < 200; ++t)
    if (still.found(3, t, 7 + 1e-4 * t)) found.push_back(t);
  EXPECT_EQ(found, std::vector<double>{61});
  still.moved(3, 200);
  EXPECT_FALSE(still.found(3, 201, 7));
  for (double t = 202; t < 261; ++t) EXPECT_FALSE(still.found(3, t, 7));
  EXPECT_TRUE(still.found(3, 261, 7));
  still.moved(3, 262);
  still.idle(3);
  for (double t = 263; t < 400; ++t) EXPECT_FALSE(still.found(3, t, 7));
}

TEST(Standstill, WhoComputesOrWasStoppedWithUsIsNotFound) {
  Standstill still(60);
  still.moved(0, 0);
  for (double t = 1; t < 300; ++t) EXPECT_FALSE(still.found(0, t, t));
  still.moved(1, 0);
  EXPECT_FALSE(still.found(1, 1, 5));
  EXPECT_FALSE(still.found(1, 1000, 5));
}

TEST(Standstill, TimeOnACoreIsOfAllThreads) {
  const double before = cpu_seconds(getpid());
  const double end = now().cpu + 0.05;
  while (now().cpu < end) {
  }
  EXPECT_GT(cpu_seconds(getpid()), before + 0.02);
  EXPECT_EQ(cpu_seconds(-1), 0);
}

}  // namespace
}  // namespace physinv
