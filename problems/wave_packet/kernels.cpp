#include "problems/kernels.h"

#include "problems/wave_packet/wave_packet.h"

namespace physinv {
namespace {

const auto kKernels =
    Kernels(problems::wave_packet(),
            {.forward = {8, 32, 256}, .gradient = {8, 32, 256}})
        .add("loss", {32}, [loss = Vector<double>()](auto& f) mutable {
          loss.resize(f.y.cols());
          f.problem.loss(f.y, f.target, loss);
        });

}  // namespace
}  // namespace physinv
