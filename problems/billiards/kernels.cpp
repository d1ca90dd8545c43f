#include "problems/kernels.h"

#include "problems/billiards/billiards.h"

namespace physinv {
namespace {

const Kernels kKernels(problems::billiards(),
                       {.forward = {8, 128, 1024}, .gradient = {8, 128, 1024}});

}  // namespace
}  // namespace physinv
