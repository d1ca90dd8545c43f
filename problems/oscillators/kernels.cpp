#include "problems/kernels.h"

#include "problems/oscillators/oscillators.h"

namespace physinv {
namespace {

const Kernels kKernels(problems::oscillators(),
                       {.forward = {1, 128, 4096},
                        .gradient = {1, 128, 512},
                        .jacobian = {1, 128}});

}  // namespace
}  // namespace physinv
