// A file of --config, TOML or JSON by its first character, as `run` takes it:
// what it chooses is chosen, and nothing is done with it.
#include "suite/app/campaign_file.h"
#include "suite/app/flags.h"
#include "suite/app/options.h"
#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void config(std::string_view bytes) {
  const std::string path = put("campaign", bytes).string();
  Selection selection;
  std::string file, budget;
  int jobs = 1;
  double within = 1;
  bool resume = true, trace = false;
  const std::vector<Flag> own = {{"--config", "", &file},
                                 {"-j,--jobs", "", &jobs},
                                 {"--within", "", &within},
                                 {"--time-budget", "", &budget, "TIME"},
                                 {"--trace", "", &trace},
                                 {"--resume,!--fresh", "", &resume}};
  documented([&] {
    for (const FileFlag& flag : read_campaign_file(path))
      if (flag.values.empty() || flag.where.empty())
        throw std::logic_error("a flag without a value or a line");
    parse("run", "", selection.flags(own), {"--config=" + path});
    if (!budget.empty()) parse_duration("--time-budget", budget);
    selection.list.clear();  // names a file of this machine
    selection.cases();
  });
}

}  // namespace physinv::fuzz
