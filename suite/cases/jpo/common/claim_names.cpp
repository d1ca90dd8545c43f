#include "suite/cases/jpo/common/claim_names.h"

#include <string>
#include <vector>

#include "suite/evidence/means.h"

namespace physinv::jpo {
namespace {

template <class F>
void add_of_solved(ClaimNames& names, const char* name, F f) {
  names.add(name, [=](double loss) { return f(Solved(loss)); });
  names.add(name, [=](const Solved& solved) { return f(solved); });
}

void add_runs(ClaimNames& names) {
  names.set("bfgs", bfgs());
  names.set("gradient_descent", gd());
  names.set("jpo", kJpo);
  names.set("jpo_refined", kRefined);
  names.set("supervised", kSupervised);
  names.set("supervised_refined", kSupervisedRefined);
  names.set("adjoint", kAdjoint);
  names.set("adjoint_refined", kAdjointRefined);
}

void add_run_values(ClaimNames& names) {
  names.set("better", better());
  names.set("equal", equal());
  names.set("worse", worse());
  names.set("f", f());
  names.set("decrease_before", decrease_before());
  names.set("decrease_from_prior", decrease_before(true));
  names.set("worsened", worsened());
  names.set("mean_loss", mean_loss());
  names.set("worst_loss", worst_loss());
  names.add("over_bfgs", over_bfgs);
  names.set("seconds", seconds());
  add_of_solved(names, "solved", solved);
  add_of_solved(names, "gain", gain);
}

void add_problem_values(ClaimNames& names) {
  names.add("iterations_to", first_below);
  names.set("start_losses", start_losses());
  names.add("where", where);
  names.set("holds", std::function<bool(double)>(holds));
  add_of_solved(names, "if_solved", if_solved);
  add_of_solved(names, "is_solved", is_solved);
  add_of_solved(names, "bfgs_unsolved", bfgs_unsolved);
  names.add("largest_sets",
            [](const RunRow& row) { return largest_sets(row); });
  names.add("largest_sets", [](const RunValue& v) { return largest_sets(v); });
}

void add_quantities(ClaimNames& names) {
  names.add("lowest_mean", lowest_mean);
  names.add("highest_mean", highest_mean);
  names.add("percent_better", percent_better);
  names.add("solved_share", [](const Select& runs, double loss) {
    return solved_share(runs, loss);
  });
  names.add("solved_share", solved_share);
  names.add("from_problems", from_problems);
  names.add("problem_count", problem_count);
  names.add("growth_in_errors", growth_in_errors);
  names.add("table3", [](Index seeds) { return table3(seeds); });
  names.add("table4", table4);
  names.add("table5", table5);
  names.add("better_more_often", [](const Select& a, const Select& b) {
    return Labelled([=](const std::string& label) {
      return std::vector{better_more_often(label, a, b)};
    });
  });
}

}  // namespace

ClaimNames claim_names() {
  ClaimNames names = physinv::claim_names();
  add_runs(names);
  add_run_values(names);
  add_problem_values(names);
  add_quantities(names);
  return names;
}

}  // namespace physinv::jpo
