#include "problems/kernels.h"

#include "problems/robotic_arm/robotic_arm.h"

namespace physinv {
namespace {

const Kernels kKernels(problems::robotic_arm(),
                       {.forward = {8, 128, 1024}, .gradient = {8, 128, 1024}});

}  // namespace
}  // namespace physinv
