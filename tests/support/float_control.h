/// What the processor does with roundings and subnormal numbers, in this
/// thread.
#pragma once

#include <cstdint>
#ifdef __x86_64__
#include <xmmintrin.h>
#endif

namespace physinv {

/// The register that says it, without the flags of exceptions that were.
inline std::uint64_t float_control() {
#ifdef __x86_64__
  constexpr unsigned kFlags = 0x3f;
  return _mm_getcsr() & ~kFlags;
#elif defined(__aarch64__)
  std::uint64_t control;
  asm volatile("mrs %0, fpcr" : "=r"(control));
  return control;
#endif
}

/// From now on subnormal numbers are zero.
inline void flush_subnormals() {
#ifdef __x86_64__
  _mm_setcsr(_mm_getcsr() | 0x8040);
#elif defined(__aarch64__)
  asm volatile("msr fpcr, %0" ::"r"(float_control() | 1 << 24));
#endif
}

}  // namespace physinv
