/// A function on its own stack that can wait within a call, so that a library's
/// minimizer, which calls its objective, becomes one that asks for evaluations.
///
///   Fiber fiber([&](Fiber& self) { ...; self.suspend(); ...; });
///   while (!fiber.done()) fiber.resume();
///
/// Both sides run on one thread, one at a time.
#pragma once

#include <functional>
#include <memory>

namespace libraries {

class Fiber {
 public:
  /// The body runs from the first `resume` on. It throws nothing.
  explicit Fiber(std::function<void(Fiber& self)> body);
  /// A body that has not ended is left where it is: its memory of the stack is
  /// given back, what it holds elsewhere is not.
  ~Fiber();
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Runs the body until it suspends or ends. Throws std::bad_alloc if there is
  /// no memory for its stack.
  void resume();
  /// From within the body: returns at the next `resume`.
  void suspend();
  bool done() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace libraries
