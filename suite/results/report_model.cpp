#include "suite/results/report_model.h"

namespace physinv {

void apply(const Looks& looks, std::vector<Figure>& figures) {
  for (Figure& figure : figures)
    for (Panel& panel : figure.panels)
      for (Series& series : panel.series)
        if (const auto at = looks.find(series.method); at != looks.end())
          series.look = at->second;
}

}  // namespace physinv
