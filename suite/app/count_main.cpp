// physinv-count [--perf] PROFILE CASE...: runs cases, here and on one thread,
// for programs that count the instructions of `physinv_counted`: callgrind from
// outside, or with --perf this program, which prints them. It is built for
// x86-64-v3, as valgrind does not support AVX-512.
#include <fmt/format.h>
#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "suite/harness/registry.h"
#include "suite/harness/run_case.h"

/// Of this name in the program, whatever compiler.
extern "C" __attribute__((noinline)) void physinv_counted(
    const physinv::Case& c) {
  physinv::CaseHooks hooks;
  hooks.finished = [](const physinv::StageRecord& record) {
    if (!physinv::has_result(record))
      throw std::runtime_error(record.stage + ": " + record.message);
  };
  physinv::run_case(c, {}, {}, nullptr, hooks);
}

namespace physinv {
namespace {

/// Instructions of this thread outside of the kernel.
class PerfCounter {
 public:
  PerfCounter() {
    perf_event_attr attributes{};
    attributes.type = PERF_TYPE_HARDWARE;
    attributes.size = sizeof(attributes);
    attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
    attributes.exclude_kernel = attributes.exclude_hv = 1;
    fd_ = static_cast<int>(
        syscall(SYS_perf_event_open, &attributes, 0, -1, -1, 0));
    if (fd_ < 0) throw std::runtime_error(std::strerror(errno));
  }
  ~PerfCounter() { close(fd_); }
  PerfCounter(const PerfCounter&) = delete;
  PerfCounter& operator=(const PerfCounter&) = delete;

  std::uint64_t value() const {
    std::uint64_t count = 0;
    if (read(fd_, &count, sizeof(count)) != sizeof(count))
      throw std::runtime_error("cannot read the instruction counter");
    return count;
  }

 private:
  int fd_;
};

const Case& named(const std::vector<Case>& cases, std::string_view name) {
  for (const Case& c : cases)
    if (c.info.name == name) return c;
  throw std::runtime_error(fmt::format("there is no case {}", name));
}

void run(std::vector<std::string_view> arguments) {
  const bool perf = !arguments.empty() && arguments.front() == "--perf";
  if (perf) arguments.erase(arguments.begin());
  if (arguments.empty() && !perf)
    throw std::runtime_error("physinv-count [--perf] PROFILE CASE...");
  if (perf) PerfCounter();  // says whether there is one
  if (arguments.empty()) return;
  register_all(registry());
  const auto cases = registry().expand(arguments.front());
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const Case& c = named(cases, arguments[i]);
    if (!perf) {
      physinv_counted(c);
      continue;
    }
    const PerfCounter counter;
    physinv_counted(c);
    fmt::print("instructions {} {}\n", counter.value(), c.info.name);
  }
}

}  // namespace
}  // namespace physinv

int main(int argc, char** argv) {
  try {
    physinv::run({argv + 1, argv + argc});
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "physinv-count: %s\n", error.what());
    return 1;
  }
}
