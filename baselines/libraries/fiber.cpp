#include "fiber.h"

#include <cxxabi.h>
#include <sys/mman.h>
#include <ucontext.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <new>
#include <utility>

namespace libraries {
namespace {

/// What is not touched takes no memory; the lowest page is never touched.
constexpr std::size_t kStack = 1 << 20, kGuard = 1 << 16;

/// Which exceptions are being handled, as the C++ ABI lays it down: a pointer
/// and a number. Either side has its own.
using Handled = std::array<void*, 2>;

void exchange_handled(Handled& other) {
  Handled mine;
  void* const globals = abi::__cxa_get_globals();
  std::memcpy(&mine, globals, sizeof mine);
  std::memcpy(globals, &other, sizeof other);
  other = mine;
}

}  // namespace

struct Fiber::State {
  std::function<void(Fiber&)> body;
  Fiber* self = nullptr;
  ucontext_t inside{}, outside{};
  void* stack = MAP_FAILED;
  Handled handled{};
  bool done = false;

  void begin();
  /// makecontext passes integers alone.
  static void enter(unsigned high, unsigned low) {
    const auto address = std::uint64_t{high} << 32 | low;
    auto* state = std::bit_cast<State*>(address);
    state->body(*state->self);
    state->done = true;
  }
};

void Fiber::State::begin() {
  stack = mmap(nullptr,
               kStack,
               PROT_READ | PROT_WRITE,
               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE,
               -1,
               0);
  if (stack == MAP_FAILED) throw std::bad_alloc();
  mprotect(stack, kGuard, PROT_NONE);
  getcontext(&inside);
  inside.uc_stack.ss_sp = stack;
  inside.uc_stack.ss_size = kStack;
  inside.uc_link = &outside;
  const auto address = std::bit_cast<std::uint64_t>(this);
  makecontext(&inside,
              reinterpret_cast<void (*)()>(&State::enter),
              2,
              static_cast<unsigned>(address >> 32),
              static_cast<unsigned>(address));
}

Fiber::Fiber(std::function<void(Fiber&)> body)
    : state_(std::make_unique<State>()) {
  state_->body = std::move(body);
  state_->self = this;
}

Fiber::~Fiber() {
  if (state_->stack != MAP_FAILED) munmap(state_->stack, kStack);
}

void Fiber::resume() {
  if (state_->done) return;
  if (state_->stack == MAP_FAILED) state_->begin();
  exchange_handled(state_->handled);
  swapcontext(&state_->outside, &state_->inside);
  exchange_handled(state_->handled);
}

void Fiber::suspend() { swapcontext(&state_->inside, &state_->outside); }

bool Fiber::done() const { return state_->done; }

}  // namespace libraries
