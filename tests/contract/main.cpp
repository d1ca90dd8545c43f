// Tests are made of what is registered.
#include <gtest/gtest.h>

#include "suite/harness/registry.h"
#include "tests/support/kept_memory.h"

int main(int argc, char** argv) {
  physinv::test::keep_memory();
  physinv::register_all(physinv::registry());
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
