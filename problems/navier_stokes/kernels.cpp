/// A forward pass takes about 20 million operations per sample, the gradient
/// about 2.4 times as many; the counter is seconds per sample.
#include "problems/kernels.h"

#include "problems/navier_stokes/navier_stokes.h"

namespace physinv {
namespace {

const Kernels kKernels(problems::navier_stokes(),
                       {.forward = {1, 8, 16},
                        .gradient = {1, 8},
                        .jacobian = {8}});

}  // namespace
}  // namespace physinv
