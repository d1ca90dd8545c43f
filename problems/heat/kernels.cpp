#include "problems/kernels.h"

#include "problems/heat/heat.h"

namespace physinv {
namespace {

const auto kKernels =
    Kernels(problems::heat(), {.forward = {1, 128}, .gradient = {128}})
        .add("invert", {1, 128}, [](auto& f) {
          f.problem.invert(
              f.target, f.given, f.x_bar.setZero(), f.x_bar, f.work);
        });

}  // namespace
}  // namespace physinv
