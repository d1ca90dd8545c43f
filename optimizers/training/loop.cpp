#include "optimizers/training/loop.h"

#include <fmt/format.h>

#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {

namespace {

/// Everything that the updates to come depend on, and what was found so far,
/// between an update and the evaluation after it.
template <class T>
class State {
 public:
  State(const Training<T>& training, StageRun& run)
      : training_(training), run_(run) {}

  void restore() {
    if (run_.checkpoint == nullptr) return;
    auto last = run_.checkpoint->last();
    if (!last) return;
    serialize(*last);
    SUITE_CHECK(last->at_end(), "the checkpoint belongs to another training");
  }

  void save() {
    const Probe& probe = run_.probe;
    const bool ends =
        probe.stopped() || probe.iteration() == probe.iterations();
    if (run_.checkpoint == nullptr || ends || !run_.checkpoint->due()) return;
    const Probe::Aside aside = run_.probe.recording();
    Archive archive;
    serialize(archive);
    run_.checkpoint->save(probe.iteration(), archive);
  }

  /// Of model and signal, wherever they ran.
  Counts counts() const {
    Counts all = earlier_;
    all += training_.model.counts();
    all += training_.signal.counts();
    return all;
  }

 private:
  void serialize(Archive& archive) {
    Counts all = counts();
    archive(all, run_.probe, run_.oracle);
    archive(training_.model, training_.signal, training_.rule);
    if (training_.batches != nullptr) archive(*training_.batches);
    if (training_.serialize) training_.serialize(archive);
    if (archive.reading()) earlier_ = all;
  }

  const Training<T>& training_;
  StageRun& run_;
  Counts earlier_;
};

}  // namespace

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
  const auto evaluate = [&] {
    if (!signal.evaluate(probe.iteration() == probe.iterations()))
      end("no finite loss after iteration {}");
  };

  probe.begin_warmup();
  signal.warm_up();
  State<T> state(training, run);
  state.restore();
  probe.begin();
  evaluate();
  while (probe.proceed(training.estimate, training.measured)) {
    if (training.batches != nullptr) training.batches->next();
    if (!training.rule(signal))
      end("update {} makes a parameter infinite; it was not taken");
    const Vector<T>& theta = training.model.parameters();
    probe.trace(theta.data(),
                sizeof(T) * static_cast<std::size_t>(theta.size()));
    state.save();
    evaluate();
  }

  out.iterations.setConstant(run.oracle.count(),
                             static_cast<double>(probe.iteration()));
  out.bytes = training.model.bytes();
  signal.export_to(out);
  training.rule.export_to(out);
  run.oracle.add(state.counts());
  return out;
}

template Outcome run_training(const Training<float>&, StageRun&);
template Outcome run_training(const Training<double>&, StageRun&);

}  // namespace physinv
