// One page of the whole matrix: which method ends lowest, which is there first,
// and why a cell is empty.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "suite/cases/matrix/cells/cells.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training.h"
#include "suite/harness/registry.h"

namespace physinv::matrix {
namespace {

constexpr double kShare = 0.1;  // of the loss at the start

/// A cell of the matrix, medians over seeds; `why` it is empty.
struct Entry {
  std::optional<double> last, seconds;
  std::string why;
};

/// One problem's row.
struct Line {
  const MatrixProblem& problem;
  std::vector<Entry> cells = {};
  double best = kInfinite, start = 0;
};

std::optional<double> middle(const Evidence& at,
                             const MatrixMethod& m,
                             const RunValue& value) {
  const auto values = values_of(sample(at, {m.id}, value));
  if (values.empty()) return {};
  return median(values);
}

Line line_of(const Evidence& all, const MatrixProblem& p) {
  Line line{.problem = p};
  const Evidence at = all.of(p.experiment());
  for (const MatrixMethod& m : methods()) {
    Entry e{.why = refusal(p, m)};
    if (e.why.empty()) {
      e.last = middle(at, m, last_loss());
      if (!e.last) e.why = kNotRun;
      if (e.last) line.best = std::min(line.best, *e.last);
      if (const auto v = middle(at, m, first_loss())) line.start = *v;
    }
    line.cells.push_back(std::move(e));
  }
  for (std::size_t i = 0; i < line.cells.size(); ++i)
    line.cells[i].seconds =
        middle(at, methods()[i], time_to(own_seconds(), kShare * line.start));
  return line;
}

Table table(const std::vector<Line>& lines,
            std::string id,
            std::string title,
            std::string note,
            Cell (*cell)(const Line&, const Entry&)) {
  Table t{.id = std::move(id),
          .title = std::move(title),
          .corner = "problem",
          .columns = {},
          .note = std::move(note),
          .across = Across{.key = "method"}};
  for (const MatrixMethod& m : methods()) t.columns.push_back(m.title);
  for (const Line& line : lines) {
    TableRow row{.label = line.problem.title};
    for (const Entry& e : line.cells)
      row.cells.push_back(e.last ? cell(line, e) : Cell{.text = e.why});
    t.rows.push_back(std::move(row));
  }
  return t;
}

Cell in_digits(std::optional<double> v, const char* otherwise) {
  return v && std::isfinite(*v) ? written(v) : Cell{.text = otherwise};
}

Figure heat_map(const std::vector<Line>& lines) {
  Field2D field{.log_scale = true, .label = "loss / best"};
  for (std::size_t i = 0; i < methods().size(); ++i) {
    field.x.push_back(static_cast<double>(i));
    field.x_names.push_back(methods()[i].title);
  }
  // From top to bottom as in the tables.
  for (std::size_t j = lines.size(); j-- > 0;) {
    const Line& line = lines[j];
    field.y.push_back(static_cast<double>(field.y.size()));
    field.y_names.push_back(line.problem.title);
    for (const Entry& e : line.cells)
      field.values.push_back(e.last && line.best > 0
                                 ? *e.last / line.best
                                 : std::numeric_limits<double>::quiet_NaN());
  }
  return {.id = "matrix",
          .title = "Final loss over the best of its row",
          .panels = {{.field = std::move(field)}},
          .columns = 1,
          .note = "Medians over seeds. Blank: the tables say why."};
}

Section report(const Evidence& evidence) {
  std::vector<Line> lines;
  for (const MatrixProblem& p : problems()) {
    Line line = line_of(evidence, p);
    if (std::isfinite(line.best)) lines.push_back(std::move(line));
  }
  if (lines.empty()) return {};
  return {
      .tables =
          {table(lines,
                 "losses",
                 "Loss at the end",
                 "Median over seeds of the mean loss over the case's problems. "
                 "Every method chose among five rates by a quarter of its "
                 "updates each, on data of the search's own.",
                 [](const Line&, const Entry& e) {
                   return in_digits(e.last, kDiverged);
                 }),
           table(lines,
                 "times",
                 "Seconds to a tenth of the first loss",
                 "Median over seeds; the search not counted.",
                 [](const Line&, const Entry& e) {
                   return in_digits(e.seconds, "never");
                 })},
      .figures = {heat_map(lines)}};
}

}  // namespace

void add_reports(Registry& r) {
  r.add(Overview{.paper = "matrix",
                 .title = "Every method on every problem",
                 .profiles = {"smoke", "quick", "standard", "paper"},
                 .claims = {},
                 .report = report});
}

}  // namespace physinv::matrix
