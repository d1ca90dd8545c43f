#include "problems/kernels.h"

#include "problems/poisson/poisson.h"

namespace physinv {
namespace {

const auto kKernels =
    Kernels(problems::poisson(), {.forward = {1, 8, 128}, .gradient = {8}});

}  // namespace
}  // namespace physinv
