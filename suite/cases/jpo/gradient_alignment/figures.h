/// Figures and tables of gradient alignment (JPO paper, Fig. 2).
#pragma once

#include <vector>

#include "suite/cases/jpo/gradient_alignment/shares.h"
#include "suite/results/published.h"
#include "suite/results/report_model.h"

namespace physinv::alignment {

/// Panels a to d.
std::vector<Figure> figures(const Fig2& f);

/// Shares beside theory, fits of the response model, theories of the vote.
std::vector<Table> tables(const Results& results,
                          const Fig2& f,
                          const Published& published);

}  // namespace physinv::alignment
