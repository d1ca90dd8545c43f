// The program over the fake experiment; its main is the real one.
#include "suite/harness/registry.h"
#include "tests/suite/harness/fake_experiment.h"

void physinv::register_all(Registry& r) { r.add(fake::experiment()); }
