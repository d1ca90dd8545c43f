/// A stage of a method from its facts and a function that runs it.
///
///   make_stage({.name = "fit", ...},
///              [options]<class T>(StageRun& run) {
///                return fit<T>(options, run);
///              });
///
/// The function is a template on the precision, or, where the stage is in
/// double whatever the case's precision, takes the run alone.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "suite/core/method.h"

namespace physinv {

/// A value, or a function that makes it when it is asked for: of a program's
/// stages most are never looked at.
template <class T>
class Deferred {
 public:
  Deferred(T value = {}) : make_([v = std::move(value)] { return v; }) {}
  template <std::invocable Make>
  Deferred(Make make) : make_(std::move(make)) {}
  T operator()() const { return make_(); }

 private:
  std::function<T()> make_;
};

struct StageFacts {
  std::string name;
  Needs needs;
  Deferred<Options> options;
  Index iterations;
  bool own_length = false;  ///< `iterations` is used, whatever a row says
  Networks networks = Networks::predictor;
  std::function<double(const CaseSize& size)> operations;
  /// What the options bring in, and leave without effect.
  Deferred<Sources> sources = {};
  const char* source = __builtin_FILE();  ///< where the stage is written
};

using RunStage = std::function<Outcome(StageRun& run)>;

/// In double alone if `in_float` is empty.
std::shared_ptr<const Stage> make_stage(StageFacts facts,
                                        RunStage in_float,
                                        RunStage in_double);

template <class Run>
std::shared_ptr<const Stage> make_stage(StageFacts facts, Run run) {
  if constexpr (std::invocable<const Run&, StageRun&>) {
    return make_stage(std::move(facts), nullptr, std::move(run));
  } else {
    return make_stage(
        std::move(facts),
        [run](StageRun& r) { return run.template operator()<float>(r); },
        [run](StageRun& r) { return run.template operator()<double>(r); });
  }
}

}  // namespace physinv
