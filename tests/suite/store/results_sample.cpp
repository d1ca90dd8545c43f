// results_sample DIRECTORY: leaves two small campaigns, a and b, there.
#include <nlohmann/json.hpp>

#include "suite/store/store.h"
#include "tests/suite/store/store_testing.h"

int main(int argc, char** argv) {
  using namespace physinv;
  if (argc != 2) return 2;
  const nlohmann::json context = {
      {"date", "2024-01-02T03:04:05Z"},
      {"caches",
       {{{"type", "Data"}, {"level", 1}, {"size", 32768}, {"num_sharing", 2}}}},
      {"load_avg", {0.5, 1.0}},
      {"compiler", "GNU 12"}};
  std::uint64_t run = 0;
  for (const char* name : {"a", "b"}) {
    const auto directory = std::filesystem::path(argv[1]) / name;
    std::filesystem::remove_all(directory);
    Store store(directory);
    std::vector<CaseInfo> cases;
    for (const char* method : {"bfgs", "jpo"})
      for (const Index n : {1, 8}) cases.push_back(sample_case(method, n, 0));
    store.set_plan(cases, context);
    for (const auto& info : cases) {
      for (Index k = 0; k < 2; ++k) {
        auto stage = sample_stage(info, k, ++run);
        // Of each end a stage, well in the other campaign.
        if (run == 4) stage.stop = Stop::diverged;
        if (run == 13) stage.stop = Stop::failed;
        if (run == 14) stage.stop = Stop::skipped;
        store.append(info, sample_data(info), stage);
      }
    }
    store.finish();
  }
}
