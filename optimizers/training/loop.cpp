#include "optimizers/training/loop.h"

#include <fmt/format.h>

#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {

template <class T>
Outcome run_training(const Training<T>& training, StageRun& run) {
  Signal<T>& signal = training.signal;
  Probe& probe = run.probe;
  Outcome out;
  const auto end = [&](const char* why) {
    probe.stop();
    out.stop = Stop::diverged;
    out.message = fmt::format(fmt::runtime(why), probe.iteration());
  };
  const auto look = [&] {
    if (!signal.look(probe.iteration() == probe.iterations()))
      end("no finite loss after iteration {}");
  };

  probe.begin_warmup();
  signal.warm_up();
  probe.begin();
  look();
  while (probe.proceed(training.estimate)) {
    if (training.batches != nullptr) training.batches->next();
    if (!training.rule(signal))
      end("update {} makes a parameter infinite; it was not taken");
    const Vector<T>& theta = training.model.parameters();
    probe.trace(theta.data(),
                sizeof(T) * static_cast<std::size_t>(theta.size()));
    look();
  }

  out.iterations.setConstant(run.oracle.count(),
                             static_cast<double>(probe.iteration()));
  out.bytes = training.model.bytes();
  signal.leave(out);
  training.rule.leave(out);
  run.oracle.add(training.model.counts());
  run.oracle.add(signal.counts());
  return out;
}

template Outcome run_training(const Training<float>&, StageRun&);
template Outcome run_training(const Training<double>&, StageRun&);

}  // namespace physinv
