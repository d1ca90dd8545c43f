// HIG paper, App. C: which tau is too small hangs on precision and projection,
// which are not printed.
#include "suite/cases/hig/quantum_dipole/tau_figures.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "suite/cases/hig/quantum_dipole/grids.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/training.h"

namespace physinv::dipole {
namespace {

constexpr double kUpdates = 256;

/// With b = 16 and a rate of 0.5; empty if the grid has none.
std::string in_double(int digits) {
  for (const HigPoint& p : dense_hig())
    if (p.batch == 16 && p.rate == 0.5 && p.digits == digits) return p.id;
  return "";
}
std::string in_float_of(int digits, bool project) {
  for (const FloatPoint& p : in_float())
    if (p.digits == digits && p.project == project) return p.id;
  return "";
}

Cell lowest_loss_of(const std::string& method, const Evidence& e) {
  if (method.empty()) return {.text = kNothing};
  const Measured m = lowest({method}, loss_after(kUpdates))(e);
  if (!m.value) return {.text = kNotRun};
  return {.ours = m.value};
}

}  // namespace

Table tau_table(const Results& results) {
  const Published none;
  const Evidence evidence{results, none, kDense};
  Table table{
      .id = "tau",
      .title = "HIG by truncation, precision and projection",
      .where = "App. C, Fig. 9",
      .corner = "tau",
      .columns = {"float, projected", "float, as it is", "double, projected"},
      .note =
          "Test loss after 256 updates with b = 16 and a rate of "
          "0.5, lowest of all seeds. The paper prints neither "
          "precision nor projection, and that the network does "
          "not learn with tau far below 1e-5 (P10: above 0.1)."};
  for (int digits = 2; digits <= 7; ++digits)
    table.rows.push_back(
        {.label = fmt::format("1e-{}", digits),
         .cells = {lowest_loss_of(in_float_of(digits, true), evidence),
                   lowest_loss_of(in_float_of(digits, false), evidence),
                   lowest_loss_of(in_double(digits), evidence)}});
  return table;
}

}  // namespace physinv::dipole
