// The solver entries of hig-poisson.

#include <stdexcept>
#include <string>

#include "problems/grid_poisson/grid_poisson.h"
#include "suite/core/any_problem.h"
#include "suite/linalg/decompositions.h"
#include "tests/problems/physics_checks.h"
#include "tests/support/hig_reference.h"

namespace physinv::test {
namespace {

const std::string kId = "hig-poisson";

/// The one grid that this problem has.
Batch<double> cells_of(const Json& list) {
  const Batch<double> cells = flat(list);
  if (cells.rows() != kPoissonCells)
    throw std::runtime_error(list.path() + " has " +
                             std::to_string(cells.rows()) +
                             " cells, expected 8 x 8");
  return cells;
}

template <class T>
void check_stencil(const Json& entry, const TwoNorm& same) {
  const Batch<T> f = cells_of(entry.at("input").at("f")).cast<T>(), given(0, 1);
  const Vector<double> laplace = flat(entry.at("expected").at("laplace"));
  const AnyProblem<T> grid(problems::grid_poisson());
  Physics at(grid);
  EXPECT_TRUE(same(at.forward(f, given), laplace));
  at.linearize(f, given);
  EXPECT_TRUE(same(at.pullback(f), laplace));
  const Batch<T> j = at.jacobian(f, given);
  EXPECT_TRUE(same(at.matrix(j, 0) * f, laplace));
}

void check_laplacian(const Json& entry) {
  check_stencil<double>(entry, HigTolerance(entry).array());
  check_stencil<float>(entry, {1e-6, 1e-6});
  const AnyProblem<double> grid(problems::grid_poisson());
  Physics at(grid);
  const Batch<double> j =
      at.jacobian(Batch<double>::Zero(kPoissonCells, 1), Batch<double>(0, 1));
  EXPECT_TRUE(HigTolerance(entry).array()(
      linalg::symmetric_eigen(at.matrix(j, 0)).values,
      flat(entry.at("expected").at("eigenvalues_sorted"))));
}

void check_sample(const Json& entry) {
  const auto same = HigTolerance(entry).array();
  Vector<double> noise(2 * kPoissonCells);
  noise << cells_of(entry.at("input").at("noise_re")),
      cells_of(entry.at("input").at("noise_im"));
  const Batch<double> phi = poisson_potential(noise);
  EXPECT_TRUE(same(phi, flat(entry.at("expected").at("phi"))));
  const AnyProblem<double> grid(problems::grid_poisson());
  Physics at(grid);
  EXPECT_TRUE(same(at.forward(phi, Batch<double>(0, 1)),
                   flat(entry.at("expected").at("rho"))));
}

// The updates: tests/optimizers/hig_poisson_reference_test.cpp.
TEST(GridPoissonReference, SolverEntries) {
  check_entries(kId,
                {{"laplacian", check_laplacian}, {"sample_*", check_sample}},
                {"batch*", "adam_*", "hig_*"});
}

}  // namespace
}  // namespace physinv::test
