#include "problems/kernels.h"

#include "problems/grid_poisson/grid_poisson.h"

namespace physinv {
namespace {

const auto kKernels =
    Kernels(problems::grid_poisson(),
            {.forward = {1, 64, 1024}, .gradient = {1, 64}, .jacobian = {16}})
        .add("invert", {64}, [](auto& f) {
          f.problem.invert(f.y, f.given, f.x, f.x_bar, f.work);
        });

}  // namespace
}  // namespace physinv
