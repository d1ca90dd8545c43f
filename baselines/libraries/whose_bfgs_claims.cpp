#include "whose_bfgs_claims.h"

#include <functional>
#include <utility>

#include "against.h"
#include "suite/evidence/means.h"
#include "suite/evidence/of_experiment.h"

namespace libraries {

using physinv::above;
using physinv::against;
using physinv::as_printed;
using physinv::as_stated;
using physinv::Claim;
using physinv::Condition;
using physinv::each;
using physinv::either;
using physinv::Index;
using physinv::least;
using physinv::mean_of_all;
using physinv::Quantity;

const std::vector<std::string>& section4() {
  static const std::vector<std::string> kProblems = {
      "wave-packet", "billiards", "kuramoto-sivashinsky", "navier-stokes"};
  return kProblems;
}

std::string study_of(const std::string& problem) {
  return "studies/whose-bfgs-" + problem;
}

namespace {

constexpr const char* kFlow = "navier-stokes";

/// A library's BFGS, or what it has next to it; that of R is run from Python.
struct Bfgs {
  std::string method, label;
};
const std::vector<Bfgs>& of_libraries() {
  static const std::vector<Bfgs> kAll = {{"bfgs", "SciPy"},
                                         {"gsl-bfgs2", "GSL"},
                                         {"nlopt-lbfgs", "NLopt"},
                                         {"ceres-bfgs", "Ceres"},
                                         {"dlib-bfgs", "dlib"},
                                         {"r-bfgs", "R"}};
  return kAll;
}

/// Sizes of the paper's sets.
struct Sizes {
  Index smallest, largest;
};
Sizes sizes_of(const std::string& problem) {
  if (problem == "billiards") return {2, 128};
  if (problem == kFlow) return {4, 128};
  return {2, 256};
}

Quantity percent_better(const std::string& problem, const Bfgs& bfgs) {
  return of_experiment(
      study_of(problem),
      percent(mean(refined(), against({bfgs.method}, better))));
}

/// Those whose sets are cheap: networks for Navier-Stokes take hours.
std::vector<std::string> cheap() {
  std::vector<std::string> all = section4();
  std::erase(all, kFlow);
  return all;
}

Quantity mean_percent_better(const Bfgs& bfgs) {
  return mean_of_all(each(cheap(), [&](const std::string& problem) {
    return percent_better(problem, bfgs);
  }));
}

/// Of JPO's runs `jpo`, against a library on a problem.
using Number = Quantity (*)(const physinv::Select& jpo,
                            const std::string& problem,
                            const Bfgs& bfgs);

Quantity f_of_all(const physinv::Select& jpo,
                  const std::string& problem,
                  const Bfgs& bfgs) {
  return of_experiment(study_of(problem), mean(jpo, against({bfgs.method}, f)));
}

Quantity f_at_the_largest(const physinv::Select& jpo,
                          const std::string& problem,
                          const Bfgs& bfgs) {
  const Index n = sizes_of(problem).largest;
  return of_experiment(study_of(problem),
                       mean(jpo.of_sizes(n, n), against({bfgs.method}, f)));
}

Quantity growth_of_f(const physinv::Select& jpo,
                     const std::string& problem,
                     const Bfgs& bfgs) {
  const auto [smallest, largest] = sizes_of(problem);
  return of_experiment(study_of(problem),
                       growth_in_errors(jpo.of_sizes(largest, largest),
                                        jpo.of_sizes(smallest, smallest),
                                        against({bfgs.method}, f)));
}

Quantity least_of(Number number,
                  const physinv::Select& jpo,
                  const std::vector<std::string>& problems,
                  const Bfgs& bfgs) {
  return least(each(problems, [&](const std::string& problem) {
    return number(jpo, problem, bfgs);
  }));
}

/// Alone or refined, as the paper leaves open which.
Condition least_above(Number number,
                      const std::vector<std::string>& problems,
                      const std::string& label,
                      const Bfgs& bfgs,
                      double bound) {
  return either(above(label, least_of(number, fit(), problems, bfgs), bound),
                above(label + ", refined",
                      least_of(number, refined(), problems, bfgs),
                      bound));
}

using Make = std::function<Condition(const std::string& label, const Bfgs&)>;

/// Of each library: of the cheap problems, and of Navier-Stokes.
std::vector<Condition> of_each(const Make& of_cheap, const Make& of_flow) {
  std::vector<Condition> all;
  for (const Bfgs& bfgs : of_libraries())
    all.push_back(of_cheap(bfgs.label, bfgs));
  for (const Bfgs& bfgs : of_libraries())
    all.push_back(of_flow(bfgs.label + ", Navier-Stokes", bfgs));
  return all;
}

std::vector<Condition> least_above(Number number, double bound) {
  const auto of = [=](const std::vector<std::string>& problems) {
    return [=](const std::string& label, const Bfgs& bfgs) {
      return least_above(number, problems, label, bfgs, bound);
    };
  };
  return of_each(of(cheap()), of({kFlow}));
}

std::vector<Condition> more_than_half_better() {
  return of_each(
      [](const std::string& label, const Bfgs& bfgs) {
        return above(label, mean_percent_better(bfgs), 50);
      },
      [](const std::string& label, const Bfgs& bfgs) {
        return above(label, percent_better(kFlow, bfgs), 50);
      });
}

std::vector<Condition> better_as_printed() {
  constexpr double kMeanOfTable5 = 70.0;  // of 86.0, 61.7 and 62.3
  constexpr Index kSeeds = 4;
  return of_each(
      [](const std::string& label, const Bfgs& bfgs) {
        return as_stated(
            label, mean_percent_better(bfgs), kMeanOfTable5, kSeeds);
      },
      [](const std::string& label, const Bfgs& bfgs) {
        return as_printed(label,
                          percent_better(kFlow, bfgs),
                          "jpo/navier-stokes table5/jpo/better",
                          kSeeds);
      });
}

std::vector<Condition> ahead_everywhere() {
  const auto of = [](const std::vector<std::string>& problems) {
    return [=](const std::string& label, const Bfgs& bfgs) {
      return above(label, least_of(f_of_all, refined(), problems, bfgs), 0.5);
    };
  };
  return of_each(of(cheap()), of({kFlow}));
}

}  // namespace

/// Of the paper: P1 of `jpo` by its direction and by its number, P3, P2, and
/// Table 5 by its direction.
std::vector<Claim> whose_bfgs_claims() {
  const auto claim = [](const char* id,
                        const char* says,
                        std::vector<Condition> conditions,
                        const char* note,
                        physinv::Cause cause) {
    return Claim{.id = id,
                 .where = "",
                 .from = "paper",
                 .says = says,
                 .conditions = std::move(conditions),
                 .note = note,
                 .cause = std::move(cause)};
  };
  return {
      claim("S1",
            "Refined JPO beats the BFGS of every library in more than 50 % of "
            "the problems, in the mean of wave packet, billiards and the "
            "Kuramoto-Sivashinsky equation, and on Navier-Stokes",
            more_than_half_better(),
            "",
            physinv::not_run("the networks of Navier-Stokes take hours")),
      claim("S2",
            "With the BFGS of every library this mean is as printed, and the "
            "percentage of Navier-Stokes",
            better_as_printed(),
            "The mean of Table 5 over the three is 70.0.",
            physinv::depends("on the library")),
      claim("S3",
            "In all settings JPO surpasses the BFGS of every library, given "
            "enough examples",
            least_above(f_at_the_largest, 0.5),
            "Of each library the least f at the largest n, of wave packet, "
            "billiards and the Kuramoto-Sivashinsky equation.",
            physinv::not_run("the networks of Navier-Stokes take hours")),
      claim("S4",
            "The fraction of better problems clearly increases with the data "
            "set, with the BFGS of every library",
            least_above(growth_of_f, 2),
            "Of each library the least difference of f between the largest "
            "and the smallest n, in standard errors, of wave packet, billiards "
            "and the Kuramoto-Sivashinsky equation.",
            physinv::fails("it fails with SciPy's BFGS as well, so it does not "
                           "depend on the library")),
      claim("S5",
            "On each of the four experiments refined JPO is ahead of the BFGS "
            "of every library, in the mean over n",
            ahead_everywhere(),
            "Of each library the least f of wave packet, billiards and the "
            "Kuramoto-Sivashinsky equation, as means over n.",
            physinv::depends(
                "on the library: on billiards, where losses of zero can be "
                "reached, solvers that stop later are ahead"))};
}

}  // namespace libraries
