/// What problems of flow keep of their runs for the way back: states before
/// every step and the limiters' decisions, a column of a slot for each register
/// of samples.
#pragma once

#include "problems/fluid/samples.h"

namespace physinv::fluid {

/// f(step t, step t + 1) for every step of a run of `kernel`: all states side
/// by side where decisions are kept, else two in turn.
template <class Kernel, class P, class F>
void for_steps(const Kernel& kernel,
               Index steps,
               P* states,
               std::uint8_t* decisions,
               F&& f) {
  const bool keep = decisions != nullptr;
  for (Index t = 0; t < steps; ++t)
    f(kernel.step(states, decisions, keep ? t : t % 2),
      kernel.step(states, nullptr, keep ? t + 1 : (t + 1) % 2));
}

/// Memory of a run: packs of all states, and of two; bytes of all decisions;
/// packs of scratch.
struct RunSize {
  template <class Kernel>
  RunSize(const Kernel& k, Index steps)
      : states((steps + 1) * k.state_packs()),
        two(2 * k.state_packs()),
        decisions(steps * k.state_bytes()),
        scratch(k.scratch_packs()) {}

  template <class T>
  double bytes() const {
    return double(states * kWidth<T>) * sizeof(T) + double(decisions);
  }

  Index states, two, decisions, scratch;
};

template <class T>
class RunTape {
 public:
  using P = Samples8<T>;

  /// Of the last `write`.
  explicit RunTape(const Tape& tape)
      : x(tape.view<T>(0)),
        given(tape.view<T>(1)),
        states_(tape.view<T>(2)),
        decisions_(tape.view<std::uint8_t>(3)),
        scratch_(tape.view<T>(4)) {}

  /// Keeps x and given; states and decisions if `keeps`, else each thread has
  /// two states behind its scratch.
  static RunTape write(Tape& tape,
                       BatchIn<T> x,
                       BatchIn<T> given,
                       const RunSize& size,
                       bool keeps = true) {
    constexpr Index w = kWidth<T>;
    const Index kept = keeps ? registers(x.cols(), w) : 0;
    tape.slot<T>(0, x.rows(), x.cols()) = x;
    tape.slot<T>(1, given.rows(), x.cols()) = given;
    tape.slot<T>(2, size.states * w, kept);
    tape.slot<std::uint8_t>(3, size.decisions, kept);
    tape.slot<T>(4,
                 (size.scratch + (keeps ? 0 : size.two)) * w,
                 count_of(tape.threads()));
    return RunTape(tape);
  }

  bool keeps() const { return states_.cols() > 0; }
  P* states(SampleBlock of) { return packs(states_, of.first / kWidth<T>); }
  std::uint8_t* decisions(SampleBlock of) {
    return keeps() ? decisions_.col(of.first / kWidth<T>).data() : nullptr;
  }
  P* scratch(int thread) { return packs(scratch_, thread); }

  Scratch<T> x, given;

 private:
  static P* packs(Scratch<T>& of, Index column) {
    return reinterpret_cast<P*>(of.col(column).data());
  }

  Scratch<T> states_;
  Scratch<std::uint8_t> decisions_;
  Scratch<T> scratch_;
};

}  // namespace physinv::fluid
