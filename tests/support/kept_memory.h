/// For tests that give back much memory and soon take it again: the C library
/// keeps it. Pages that come and go cost a quarter of the time of some contract
/// tests, and half of what turns claims.
#pragma once

#include <malloc.h>

namespace physinv::test {

inline void keep_memory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_TOP_PAD, 64 << 20);
}

}  // namespace physinv::test
