/// The picture of an experiment's card on the index of a report.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/palette.h"
#include "reports/report.h"
#include "suite/results/report_model.h"

namespace physinv {

/// A figure of the one panel that shows most: learning curves of several
/// methods (a logarithmic axis over updates or iterations; of several panels
/// of a figure the last, which has the largest n), else other curves of
/// several methods on two logarithmic axes, else the first panel that has
/// something to draw. Nothing if no panel has.
std::optional<Figure> key_figure(const Section& section);

/// Of the first picture with a first guess (a panel "start: ...") or else a
/// truth, this panel and what the method found that ranks best in the table of
/// ranks, of those drawn. Nothing if there is none.
std::optional<Figure> before_and_after(const Section& section);

/// The card's picture as SVG, and what it shows in words: the key figure;
/// without one, of the figures that were drawn before, the curves first.
/// Nothing if there are none.
std::optional<std::string> card_svg(const Section& section,
                                    const Palette& palette,
                                    const std::vector<Picture>& drawn);
std::optional<std::string> card_text(const Section& section,
                                     const std::vector<Picture>& drawn);

}  // namespace physinv
