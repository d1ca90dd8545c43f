/// What the JPO paper shows of the Kuramoto-Sivashinsky equation and of no
/// other experiment.
#pragma once

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/cases/jpo/common/metrics.h"
#include "suite/results/published.h"
#include "suite/results/report_model.h"

namespace physinv::ks {

/// Fig. 5a: one trajectory.
Figure trajectory(const KuramotoSivashinskyOptions& options);
/// Fig. 5b: the loss over beta at the true alpha.
Figure landscape(const KuramotoSivashinskyOptions& options);
/// Numbers of Sec. 4 and App. D.3 that stand in no table.
Table in_words(const JpoMetrics& metrics, const Published& published);

}  // namespace physinv::ks
