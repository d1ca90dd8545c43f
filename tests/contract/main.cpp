// Tests are made of what is registered.
#include <gtest/gtest.h>
#include <malloc.h>

#include "suite/harness/registry.h"

int main(int argc, char** argv) {
  // Trainings that begin anew all the time: what they gave back is kept, as
  // pages cost a quarter of the time otherwise.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_TOP_PAD, 64 << 20);
  physinv::register_all(physinv::registry());
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
