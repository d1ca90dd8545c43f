#include <functional>
#include <vector>

#include "problems/poisson/poisson.h"
#include "suite/cases/sip/poisson/metrics.h"
#include "suite/cases/sip/poisson/poisson.h"
#include "suite/evidence/field_panel.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::poisson {
namespace {

const std::vector<MethodLine> kLines = {
    {"sip", "SIP", Hue::orange},
    {"adam", "Adam", Hue::purple},
    {"sgd", "SGD", Hue::blue},
    {"adahessian", "AdaHessian", Hue::teal},
    {"hf", "Hessian-free", Hue::grey},
    {"fno", "FNO, Adam", Hue::pink},
    {"sip-b8", "SIP, batch 8", Hue::orange},
    {"adam-b8", "Adam, batch 8", Hue::purple},
    {"sgd-b8", "SGD, batch 8", Hue::blue},
    {"adahessian-b8", "AdaHessian, batch 8", Hue::teal},
    {"hf-40-b8", "Hessian-free, batch 8", Hue::grey},
    {"hf-10-b8", "Hessian-free, 10 products", Hue::grey},
    {"fno-b8", "FNO, batch 8", Hue::pink},
    {"sip-long-b8", "SIP, batch 8, longer", Hue::orange},
    {"adam-long-b8", "Adam, batch 8, longer", Hue::purple},
    {"fno-long-b8", "FNO, batch 8, longer", Hue::pink}};

Section report(const Domain& domain, const Evidence& e) {
  Section section{.tables = {loss_table(e, kLines)},
                  .method_titles = titles_of(kLines)};
  LearningCurves curves(e, section);
  curves.metric(
      kLines, kError, "sum |x - x*|", "errors", "Errors of x", "Fig. 9");
  curves.losses(kLines, "losses", "Losses of y", "");
  curves.add(update_times(e, kLines, "Fig. 15"));
  const FieldLayout layout{domain.columns, domain.rows, 1, domain.columns};
  const auto physics =
      problems::poisson({.rows = domain.rows, .columns = domain.columns})
          .make<double>();
  Figure fields = answered_fields(
      e,
      kLines,
      {.where = "Fig. 9",
       .picture =
           [&](std::string title, const Vector<double>& field) {
             return field_panel(std::move(title), layout, field);
           },
       .observe = [&](const Answered& a) { return observed(*physics, a); }});
  if (!fields.panels.empty()) section.figures.push_back(std::move(fields));
  return section;
}

}  // namespace

void add_reports(Registry& r) {
  for (const Domain& p : {kPlane, kSmall, kPaper, kFno, kNarrow})
    r.add_report(p.experiment, std::bind_front(report, p));
}

}  // namespace physinv::poisson
