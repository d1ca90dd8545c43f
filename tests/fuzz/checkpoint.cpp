#include "suite/core/hash.h"
#include "suite/harness/registry.h"
#include "suite/harness/run_case.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/sealed.h"
#include "tests/suite/harness/fake_experiment.h"

namespace physinv::fuzz {
namespace {

Case small_case() {
  Registry registry;
  registry.add(fake::experiment());
  Case c = registry
               .expand("smoke",
                       {.methods = {{"descend"}}, .n = {{2}}, .iterations = 3})
               .front();
  c.info.keys = {std::string(32, 'a')};
  return c;
}

}  // namespace

void checkpoint(std::string_view bytes) {
  static const Case small = small_case();
  static Threads threads(1);
  put("checkpoints/" + small.info.keys[0], sealed_front(bytes));
  // Whatever is there, the stage reaches its end, if need be from its start.
  run_case(small,
           {},
           {.checkpoints = {.store = folder(), .seconds = 1e9}},
           &threads,
           {.started = {}, .progress = {}, .finished = [](const auto& stage) {
              if (!has_result(stage)) throw std::logic_error(stage.message);
            }});
}

}  // namespace physinv::fuzz
