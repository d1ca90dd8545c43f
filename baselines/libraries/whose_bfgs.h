/// Study: joint optimization against each library's solver on the problems of
/// an experiment of the JPO paper, as Tables 4 and 5 and Fig. 11 have it
/// against one BFGS.
#pragma once

#include <string>

#include "suite/evidence/runs.h"
#include "suite/results/report_model.h"

namespace libraries {

/// When two losses count as equal: bit by bit, as in Tables 4 and 5; where they
/// differ by `relative` of the solver's at most; where both are below `solved`,
/// as tolerances alone decide which is lower.
struct Equal {
  double relative = 0;
  double solved = 0;
};

/// Shares of a run's problems that end below the other's loss, and at it. A
/// loss that is not finite is neither; a finite one is below one that is not.
struct Shares {
  double better = 0, equal = 0;
  double f() const { return better + equal / 2; }
};
Shares shares(const physinv::Vector<double>& losses,
              const physinv::Vector<double>& others,
              Equal equal = {});

/// A row for each solver, of its runs beside those of `jpo`: better, equal and
/// f_N = better + equal / 2 of the network, and of its refinement; the paper's
/// numbers of `varied` ("jpo/billiards") stand beside those of `bfgs`, which is
/// the paper's. And f_N over n, a line for each solver.
physinv::Section whose_bfgs(const std::string& varied,
                            const physinv::Evidence& evidence);

}  // namespace libraries
