/// Study: joint optimization against each library's solver on the problems of
/// an experiment of the JPO paper, as Tables 4 and 5 and Fig. 11 have it
/// against one BFGS.
#pragma once

#include <string>

#include "suite/evidence/runs.h"
#include "suite/results/report_model.h"

namespace libraries {

/// A row for each solver, of its runs compared with those of `jpo`: better,
/// equal and f_N = better + equal / 2 of the network, and of its refinement;
/// the paper's numbers of `varied` ("jpo/billiards") are next to those of
/// `bfgs`, which is the paper's. And f_N over n, a line for each solver.
physinv::Section whose_bfgs(const std::string& varied,
                            const physinv::Evidence& evidence);

/// f of the problems of Sec. 4, a panel each: a point for each solver, and the
/// paper's as a line.
physinv::Figure at_a_glance(const physinv::Evidence& evidence);

}  // namespace libraries
