#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "suite/harness/campaign.h"
#include "suite/harness/run_case.h"

namespace physinv {
namespace {

/// Chains with more stages than this are not spelled out.
constexpr std::size_t kMostStages = 6;

struct Group {
  std::string label;
  Index n = 0;
  std::set<std::string> cases;
  std::vector<std::string> stages;
  std::map<std::string, std::vector<double>> losses;  // by stage
  double seconds = 0;
};

void add(Group& group, const CaseRecord& c) {
  group.cases.insert(c.info.name);
  for (const StageRecord& s : c.stages) {
    if (!group.losses.contains(s.stage)) group.stages.push_back(s.stage);
    auto& all = group.losses[s.stage];
    all.insert(all.end(), s.loss.data(), s.loss.data() + s.loss.size());
    group.seconds += s.clocks.total().wall;
  }
}

std::string medians(const Group& group) {
  // Diagnoses: their estimates are the start.
  if (group.stages.size() > kMostStages)
    return fmt::format("{} stages", group.stages.size());
  std::string text;
  for (const auto& stage : group.stages) {
    const auto& all = group.losses.at(stage);
    const double median = median_finite(Eigen::Map<const Vector<double>>(
        all.data(), static_cast<Index>(all.size())));
    text += fmt::format("{}{} {:.2e}", text.empty() ? "" : ", ", stage, median);
  }
  return text;
}

/// A revision as people read it.
std::string brief(const std::string& revision) {
  const auto plus = revision.find('+');
  return revision.substr(0, std::min<std::size_t>(12, plus)) +
         (plus == std::string::npos ? "" : revision.substr(plus));
}

}  // namespace

std::string summary_table(const std::vector<CaseRecord>& cases) {
  std::vector<Group> groups;
  std::map<std::pair<std::string, Index>, std::size_t> index;
  std::size_t width = 6, loss_width = 17;
  for (const CaseRecord& c : cases) {
    const std::string label = c.info.experiment + "/" + c.info.method;
    const auto [at, is_new] =
        index.emplace(std::pair(label, c.info.n), groups.size());
    if (is_new) {
      groups.emplace_back();
      groups.back().label = label;
      groups.back().n = c.info.n;
    }
    add(groups[at->second], c);
    width = std::max(width, label.size());
  }
  for (const Group& g : groups)
    loss_width = std::max(loss_width, medians(g).size());
  std::string text = fmt::format("{:<{}}  {:>5}  {:>5}  {:<{}}  {:>9}\n",
                                 "method",
                                 width,
                                 "n",
                                 "cases",
                                 "median final loss",
                                 loss_width,
                                 "time");
  for (const Group& g : groups) {
    text += fmt::format("{:<{}}  {:>5}  {:>5}  {:<{}}  {:>9}\n",
                        g.label,
                        width,
                        g.n,
                        g.cases.size(),
                        medians(g),
                        loss_width,
                        duration_text(g.seconds));
  }
  return text;
}

std::string to_text(const Origins& origins) {
  std::string text;
  for (const auto& [origin, count] : origins) {
    text += fmt::format("{}{} of {} at {}",
                        text.empty() ? "" : ", ",
                        count,
                        origin.first,
                        brief(origin.second));
  }
  return text;
}

}  // namespace physinv
