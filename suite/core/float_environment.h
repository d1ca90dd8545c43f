/// The floating-point environment that numbers are computed in: rounding to
/// nearest, subnormal numbers kept, no trap, no flag. That is FE_DFL_ENV of
/// <cfenv>, which clears flush-to-zero and denormals-are-zero, too.
#pragma once

#include <cfenv>

namespace physinv {

/// Of this thread, and of those that it starts from then on.
inline void set_default_float_environment() { std::fesetenv(FE_DFL_ENV); }

/// The same during its lifetime; then what was there before.
class DefaultFloatEnvironment {
 public:
  DefaultFloatEnvironment() {
    std::fegetenv(&before_);
    set_default_float_environment();
  }
  ~DefaultFloatEnvironment() { std::fesetenv(&before_); }
  DefaultFloatEnvironment(const DefaultFloatEnvironment&) = delete;
  DefaultFloatEnvironment& operator=(const DefaultFloatEnvironment&) = delete;

 private:
  std::fenv_t before_;
};

}  // namespace physinv
