#include "optimizers/training/late_loss.h"

#include "suite/core/check.h"

namespace physinv {

LateError late_loss(const ProblemRecipe& recipe, double share) {
  return {.name = "loss",
          .share = share,
          .of = [recipe](BatchIn<double> x, BatchIn<double> y) {
            const auto problem = recipe.make<double>();
            SUITE_CHECK(problem->shape().given == 0,
                        "a late error needs a problem without side input");
            const Batch<double> given(0, x.cols());
            Batch<double> answer(y.rows(), y.cols());
            Vector<double> loss(x.cols());
            Workspace work;
            problem->forward({x, given}, answer, work);
            problem->loss(answer, y, loss);
            return loss.mean();
          }};
}

}  // namespace physinv
