// The toy's scaled output: any size of the unknowns and of the factor.
#include "problems/scaled_output/scaled_output.h"
#include "suite/cases/numerics/common/atlas.h"
#include "suite/cases/numerics/scaled_output/closed_form.h"

namespace physinv::numerics::scaled_output {
namespace {

const SweepAxis kSize{"size", decades(-150, 150, 10), true};
const SweepAxis kGamma{"gamma", decades(-12, 4, 1), true};

Vector<double> unknowns(double size, double) {
  return size * Eigen::Vector2d(0.8, -0.6);
}

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(
      r,
      {.name = "numerics/toy",
       .title = "Numerics of the toy",
       .citation = {.paper = "hig", .where = "Sec. 2.1"},
       .sweeps = {{.id = "sizes",
                   .title = "Size of the unknowns and factor of the second",
                   .x = kSize,
                   .y = kGamma,
                   .point = unknowns,
                   .problems = along(kGamma,
                                     [](double gamma) {
                                       return problems::scaled_output(
                                           {.gamma = gamma});
                                     })}},
       .parameters = {batch_parameter(
           problems::scaled_output(), 4096, {}, scaled_output_closed_form())}});
}

}  // namespace physinv::numerics::scaled_output
