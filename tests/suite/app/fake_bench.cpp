// The program over the fake experiment; its main is the real one.
#include "suite/harness/registry.h"
#include "tests/suite/harness/fake_experiment.h"

namespace {
const auto kRegistered =
    physinv::register_experiment(physinv::fake::experiment());
}
