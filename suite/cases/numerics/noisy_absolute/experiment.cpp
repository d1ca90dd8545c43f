// Distance under noise, from next to its solution to far away (at 1e8 the noise
// has no digits left), with noise from none to overwhelming.

#include "problems/noisy_absolute/noisy_absolute.h"
#include "suite/cases/numerics/common/atlas.h"
#include "suite/cases/numerics/noisy_absolute/closed_form.h"

namespace physinv::numerics::noisy_absolute {
namespace {

const SweepAxis kPlace{"place", decades(-12, 6), true};
const SweepAxis kLevel{"noise level", decades(-12, 12, 2), true};

ProblemRecipe noisy(double level) {
  return problems::noisy_absolute({.level = level});
}

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(r,
            {.name = "numerics/gradient-alignment",
             .title = "Numerics of the noisy distance",
             .citation = {.paper = "jpo", .where = "Sec. 2"},
             .sweeps = {{.id = "places",
                         .title = "Place and level of the noise",
                         .x = kPlace,
                         .y = kLevel,
                         .point = [](double place,
                                     double) { return uneven(1, place); },
                         .problems = along(kLevel, noisy),
                         .examples = 2}},
             .parameters = {batch_parameter(
                 noisy(1), 1024, {}, noisy_absolute_closed_form())}});
}

}  // namespace physinv::numerics::noisy_absolute
