// Writes what tests/reports/golden holds: the report of the smoke profile, and
// the claims of a campaign that is made up from its records, where every claim
// is judged on every case of the longest profiles. Claims are judged as by the
// last profile. No time or place of the run enters: the same records give the
// same bytes.
//
//   golden_report STORE-OF-SMOKE DIR
#include <fmt/format.h>

#include <exception>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "reports/report.h"
#include "suite/app/sections.h"
#include "suite/core/hash.h"
#include "suite/harness/judge.h"
#include "suite/harness/registry.h"
#include "suite/results/results.h"
#include "tests/support/made_up.h"

namespace physinv {
namespace {

constexpr double kSecondsPerUpdate = 1e-3;
/// None that an experiment declares: as good as its last.
constexpr const char* kProfile = "golden";

/// As if each update had taken as long as any other, alone on the machine.
void forget_the_run(StageRecord& s) {
  const double seconds = kSecondsPerUpdate * static_cast<double>(s.iterations);
  s.clocks = {.setup = {0.01, 0.01},
              .warmup = {},
              .data = {},
              .solve = {seconds, seconds},
              .measure = {0.02, 0.02}};
  for (std::size_t k = 0; k < s.curve.seconds.size(); ++k)
    s.curve.seconds[k] = kSecondsPerUpdate * s.curve.iteration[k];
  s.repeated.clear();
  s.buffer_bytes = 1 << 20, s.rss_bytes = 1 << 26;
  s.crowded = false;
  s.finished = "2024-01-01T00:00:00Z";
  s.revision.clear();
  s.run = {.profile = kProfile,
           .host = "host",
           .processor = "processor",
           .instruction_set = "x86-64",
           .threads = 1,
           .jobs = 1};
}

Results without_its_run(const Results& smoke) {
  test::Cases cases = smoke.cases();
  for (CaseRecord& c : cases) {
    c.info.profile = kProfile;
    for (StageRecord& s : c.stages) forget_the_run(s);
  }
  return Results(std::move(cases));
}

/// The experiments that claims ask for.
std::set<std::string> asked(const std::vector<Claim>& claims,
                            const std::string& own) {
  std::set<std::string> names{own};
  for (const Claim& claim : claims)
    for (const Condition& c : all_conditions(claim))
      for (const Quantity& q : c.quantities)
        for (const Select& s : q.runs())
          names.insert(s.experiment.empty() ? own : s.experiment);
  return names;
}

class MadeUp {
 public:
  MadeUp(const Results& smoke, const Published& numbers)
      : models_(smoke), numbers_(numbers) {}

  /// Claims alone, a section as it is in a report.
  Section section(const std::string& name,
                  const std::vector<Claim>& claims,
                  const std::vector<std::string>& profiles) const {
    const Results results = results_for(claims, name);
    Section out{.experiment = name, .title = name};
    for (const Claim& claim : claims) {
      try {
        for (auto& one : judge({claim}, {results, numbers_, name}, profiles))
          out.claims.push_back(std::move(one));
      } catch (const std::exception& error) {
        // Made-up numbers need not fit together.
        out.claims.push_back({.id = claim.id, .evidence = error.what()});
      }
    }
    return out;
  }

 private:
  Results results_for(const std::vector<Claim>& claims,
                      const std::string& name) const {
    std::vector<const test::Variants*> own;
    for (const std::string& experiment : asked(claims, name))
      if (const auto at = cases_.find(experiment); at != cases_.end())
        for (const test::Variants& c : at->second) own.push_back(&c);
    test::Dice dice(hash_text(name));
    test::Cases cases = test::draw(own, 0, models_, dice);
    for (CaseRecord& c : cases) c.info.profile = kProfile;
    return Results(std::move(cases));
  }

  const std::map<std::string, std::vector<test::Variants>> cases_ =
      test::all_cases();
  const test::Models models_;
  const Published& numbers_;
};

std::vector<Section> made_up_claims(const Results& smoke,
                                    const Published& numbers) {
  const MadeUp campaign(smoke, numbers);
  std::vector<Section> sections;
  for (const Overview& o : registry().overviews())
    sections.push_back(campaign.section(o.paper, o.claims, o.profiles));
  for (const auto& e : registry().experiments())
    if (!e->claims.empty())
      sections.push_back(
          campaign.section(e->name, e->claims, profile_names(*e)));
  return sections;
}

}  // namespace
}  // namespace physinv

int main(int argc, char** argv) {
  using namespace physinv;
  if (argc != 3) {
    fmt::print("usage: golden_report STORE-OF-SMOKE DIR\n");
    return 2;
  }
  register_all(registry());
  const std::filesystem::path out = argv[2];
  const Results smoke = without_its_run(load_results(argv[1]));
  const Published numbers = printed_numbers();
  write_report(out / "smoke",
               sections_of(smoke, numbers),
               {{"profile", kProfile}},
               {.one_file = false, .groups = groups_of(numbers)});
  write_report(
      out / "made-up", made_up_claims(smoke, numbers), {{"profile", kProfile}});
}
