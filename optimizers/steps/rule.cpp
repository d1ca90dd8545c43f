#include "optimizers/steps/rule.h"

#include <fmt/format.h>

#include <array>

namespace physinv {
namespace {

std::string text(double value) { return fmt::format("{}", value); }

Options named(const AdamOptions& o) {
  return {
      {"step", "adam"},
      {"rate", text(o.rate)},
      {"beta1", text(o.beta1)},
      {"beta2", text(o.beta2)},
      {"eps", text(o.eps)},
      {"eps_before_correction", fmt::format("{}", o.eps_before_correction)}};
}

Options named(const SgdOptions& o) {
  return {
      {"step", "sgd"}, {"rate", text(o.rate)}, {"momentum", text(o.momentum)}};
}

Options named(const AdagradOptions& o) {
  return {{"step", "adagrad"},
          {"rate", text(o.rate)},
          {"accumulator", text(o.accumulator)},
          {"eps", text(o.eps)}};
}

Options named(const AdadeltaOptions& o) {
  return {{"step", "adadelta"},
          {"rate", text(o.rate)},
          {"decay", text(o.decay)},
          {"eps", text(o.eps)}};
}

Options named(const RmspropOptions& o) {
  return {{"step", "rmsprop"},
          {"rate", text(o.rate)},
          {"decay", text(o.decay)},
          {"eps", text(o.eps)}};
}

constexpr std::array<const char*, std::variant_size_v<StepOptions>> kHeaders = {
    "optimizers/steps/adam.h",
    "optimizers/steps/sgd.h",
    "optimizers/steps/adagrad.h",
    "optimizers/steps/adadelta.h",
    "optimizers/steps/rmsprop.h"};

}  // namespace

Options describe(const StepOptions& options) {
  return std::visit([](const auto& o) { return named(o); }, options);
}

void add_sources(const StepOptions& options, Sources& sources) {
  for (std::size_t i = 0; i < kHeaders.size(); ++i)
    if (i != options.index())
      sources.unused.emplace_back("optimizers/steps/rule.h", kHeaders[i]);
}

}  // namespace physinv
