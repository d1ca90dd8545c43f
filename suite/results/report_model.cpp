#include "suite/results/report_model.h"

namespace physinv {

void apply(const PlotStyles& styles, std::vector<Figure>& figures) {
  for (Figure& figure : figures)
    for (Panel& panel : figure.panels)
      for (Series& series : panel.series)
        if (const auto at = styles.find(series.method); at != styles.end())
          series.style = at->second;
}

}  // namespace physinv
