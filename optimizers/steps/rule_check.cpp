#include "optimizers/steps/rule_check.h"

#include "suite/core/check.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

bool decays(double share) { return 0 <= share && share < 1; }

template <class T>
void check(const AdamOptions& o) {
  check_numbers<T>({{"rate", o.rate},
                    {"beta1", o.beta1},
                    {"beta2", o.beta2},
                    {"eps", o.eps}});
  SUITE_CHECK(o.rate >= 0 && o.eps >= 0, "rate and eps must not be negative");
  SUITE_CHECK(decays(o.beta1) && decays(o.beta2), "betas must be in [0, 1)");
}

template <class T>
void check(const SgdOptions& o) {
  check_numbers<T>({{"rate", o.rate}, {"momentum", o.momentum}});
  SUITE_CHECK(decays(o.momentum), "momentum must be in [0, 1)");
}

template <class T>
void check(const AdagradOptions& o) {
  check_numbers<T>(
      {{"rate", o.rate}, {"accumulator", o.accumulator}, {"eps", o.eps}});
  SUITE_CHECK(o.rate >= 0 && o.accumulator >= 0 && o.eps >= 0,
              "rate, accumulator and eps must not be negative");
}

/// Adadelta and RMSprop.
template <class T, class Options>
void check(const Options& o) {
  check_numbers<T>({{"rate", o.rate}, {"decay", o.decay}, {"eps", o.eps}});
  SUITE_CHECK(o.rate >= 0 && o.eps >= 0, "rate and eps must not be negative");
  SUITE_CHECK(decays(o.decay), "decay must be in [0, 1)");
}

}  // namespace

template <class T>
void check_rule(const StepOptions& options) {
  std::visit([](const auto& o) { check<T>(o); }, options);
}

template void check_rule<float>(const StepOptions&);
template void check_rule<double>(const StepOptions&);

}  // namespace physinv
