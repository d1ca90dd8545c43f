/// Where things of a page can be linked to, and what belongs together there.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

/// Ids of everything that can be linked to, in the order of a section.
struct Anchors {
  std::string section;
  std::vector<std::string> claims, tables, figures;
  std::string statements = {};  ///< all claims
};

/// Unique among the sections of one page.
std::vector<Anchors> anchors_of(const std::vector<Section>& sections);

/// What a text about a paper names: "Figs. 2 and 5, Table 4" has "fig 2",
/// "fig 5" and "table 4"; letters of panels are left out.
std::vector<std::string> places_of(std::string_view text);

/// Do both name a place that is the same?
bool share_place(std::string_view a, std::string_view b);

/// Pictures first, then figures in the order of the paper, "Fig. 4a" before
/// "Fig. 4b" before "Fig. 11"; those that it does not have last, as they are.
std::vector<std::size_t> order_of(const std::vector<Figure>& figures);

}  // namespace physinv
