#include "baselines/regression.h"

#include "optimizers/jpo.h"

namespace physinv {

Options describe(const RegressionOptions& options) {
  return describe(options.step);
}

}  // namespace physinv
