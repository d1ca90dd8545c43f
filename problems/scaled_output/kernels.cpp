#include "problems/kernels.h"

#include "problems/scaled_output/scaled_output.h"

namespace physinv {
namespace {

const Kernels kKernels(problems::scaled_output(), {.gradient = {256}});

}  // namespace
}  // namespace physinv
