// For which precision and tolerance JPO is as much better than BFGS, and as
// often equal, as Tables 4 and 5 print. Losses in float are compared as such,
// which makes ties.
#include <optional>
#include <string>
#include <vector>

#include "suite/cases/jpo/billiards_precision/settings.h"
#include "suite/cases/jpo/common/shares.h"
#include "suite/evidence/condition.h"
#include "suite/harness/registry.h"

namespace physinv::billiards_precision {
namespace {

constexpr Index kSeeds = 4;  ///< the paper's

/// In the precision that the setting works in.
Vector<double> own_losses(const StageRecord& stage, bool single) {
  const auto own = stage.arrays.find("own_loss");
  if (own != stage.arrays.end()) return own->second.row(0).transpose();
  if (!single) return stage.loss;
  return stage.loss.cast<float>().cast<double>();
}

/// Mean percentage over all n of the problems where JPO, or its refinement, is
/// better than BFGS of the same setting, or equal.
Quantity percent(const Setting& s, bool refined, double Shares::*share) {
  const RunValue value = [=](const Run& run) -> std::optional<double> {
    const auto bfgs = run.beside({s.bfgs()});
    if (!bfgs) return {};
    return compare_losses(own_losses(*run.stage, s.single),
                          own_losses(*bfgs->stage, s.single),
                          Equality::strict).*
           share;
  };
  return times(100,
               also_asks(mean({s.jpo(), refined ? "refine" : "fit"}, value),
                         {{s.bfgs()}}));
}

struct Column {
  const char* title;
  bool refined;
  double Shares::*share;
  const char* printed;
};
constexpr Column kColumns[] = {
    {"better", false, &Shares::better, "table4/jpo/better"},
    {"equal", false, &Shares::equal, "table4/jpo/equal"},
    {"refined better", true, &Shares::better, "table5/jpo/better"},
    {"refined equal", true, &Shares::equal, "table5/jpo/equal"}};

std::string printed_name(const Column& c) {
  return std::string(kVaried) + ' ' + c.printed;
}

Condition as_printed(const Setting& s, const Column& c) {
  return physinv::as_printed(std::string(s.title) + ": " + c.title + ", %",
                             percent(s, c.refined, c.share),
                             printed_name(c),
                             kSeeds);
}

/// Every column of every setting; and of the cause, some setting's.
std::vector<Condition> all_settings() {
  std::vector<Condition> all;
  for (const Setting& s : kSettings)
    for (const Column& c : kColumns) all.push_back(as_printed(s, c));
  return all;
}
Condition some_setting(const Column& c) {
  Condition any = as_printed(kSettings[0], c);
  for (std::size_t k = 1; k < kSettings.size(); ++k)
    any = either(any, as_printed(kSettings[k], c));
  return any;
}

const std::vector<Claim> kClaims(
    {{.id = "S1",
      .from = "study",
      .says = "JPO is as often better than BFGS, and equal, as Tables 4 and 5 "
              "print, whatever precision and tolerance",
      .conditions = all_settings(),
      .note = "Precision and tolerance are BFGS's and the refinement's.",
      .cause = depends(
          "precision and tolerance of BFGS are not printed; the table has the "
          "settings for which each number comes out",
          {some_setting(kColumns[0]), some_setting(kColumns[2])})}});

Cell cell_of(const Quantity& q, const Evidence& e, const Column& c) {
  const Measured m = q(e);
  const auto printed = find_printed(e.published, e.experiment, printed_name(c));
  Cell cell{.ours = m.value, .spread = m.spread};
  if (!m.value) cell.text = "not run";
  if (printed) cell.paper = printed->value, cell.paper_spread = printed->spread;
  return cell;
}

Section report(const Results& results, const Published& published) {
  const Evidence evidence{results, published, kName};
  Table table{.id = "settings",
              .title = "JPO against BFGS by precision and tolerance",
              .source = "Tables 4 and 5",
              .unit = "%",
              .corner = "precision, gtol",
              .note =
                  "Means over n = 2, 8, 32, 128, then mean ± sample "
                  "standard deviation over seeds. Both methods of a row "
                  "have its setting; float compares float losses."};
  for (const Column& c : kColumns) table.columns.push_back(c.title);
  for (const Setting& s : kSettings) {
    TableRow row{.label = s.title};
    for (const Column& c : kColumns)
      row.cells.push_back(cell_of(percent(s, c.refined, c.share), evidence, c));
    table.rows.push_back(std::move(row));
  }
  return {.tables = {std::move(table)}};
}

}  // namespace

void add_claims(Registry& r) {
  r.add_claims(kName, kClaims);
  r.add_report(kName, report);
}

}  // namespace physinv::billiards_precision
