#include "problems/kernels.h"

#include "problems/quantum_dipole/quantum_dipole.h"

namespace physinv {
namespace {

const Kernels kKernels(problems::quantum_dipole(),
                       {.forward = {1, 16, 1024},
                        .gradient = {1, 16, 256},
                        .jacobian = {1, 16}});

}  // namespace
}  // namespace physinv
