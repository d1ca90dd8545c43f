#include "optimizers/steps/rule.h"

#include <array>

namespace physinv {
namespace {

constexpr std::array<const char*, std::variant_size_v<StepOptions>> kHeaders = {
    "optimizers/steps/adam.h",
    "optimizers/steps/sgd.h",
    "optimizers/steps/adagrad.h",
    "optimizers/steps/adadelta.h",
    "optimizers/steps/rmsprop.h"};

}  // namespace

void add_sources(const StepOptions& options, Sources& sources) {
  for (std::size_t i = 0; i < kHeaders.size(); ++i)
    if (i != options.index())
      sources.unused.emplace_back("optimizers/steps/rule.h", kHeaders[i]);
}

}  // namespace physinv
