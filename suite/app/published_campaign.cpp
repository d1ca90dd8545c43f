#include "suite/app/published_campaign.h"

#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "suite/results/loss_summary.h"
#include "suite/store/file.h"
#include "suite/store/folder.h"
#include "suite/store/json.h"
#include "suite/store/results_file.h"
#include "suite/store/results_json.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

template <class Word>
Word word_of(const std::string& text, std::initializer_list<Word> all) {
  for (const Word word : all)
    if (text == to_string(word)) return word;
  throw StoreError("a stage of results.json.gz ends as '" + text + "'");
}

double number(const Json& object, const char* key) {
  const auto at = object.find(key);
  return at != object.end() && at->is_number()
             ? at->get<double>()
             : std::numeric_limits<double>::infinity();
}

/// One stage's times, of its repetitions where there are some.
void add_times(StageRecord& stage, const Json& entry) {
  const double unit = seconds_per_unit(entry);
  const Json& own = entry.at("physinv");
  if (own.contains("times") && own["times"].is_object()) {
    const Json &wall = own["times"]["wall"], &cpu = own["times"]["cpu"];
    for (std::size_t k = 0; k < std::min(wall.size(), cpu.size()); ++k) {
      const Seconds seconds{unit * wall[k].get<double>(),
                            unit * cpu[k].get<double>()};
      if (k == 0)
        stage.clocks.solve = seconds;
      else
        stage.repeated.push_back(seconds);
    }
    return;
  }
  stage.clocks.solve = {unit * number(entry, "real_time"),
                        unit * number(entry, "cpu_time")};
}

void add_statuses(StageRecord& stage, const Json& own) {
  for (const Status s : kStatuses)
    stage.status.insert(
        stage.status.end(),
        own.at("statuses").value(std::string(to_string(s)), std::size_t{0}),
        s);
}

/// Losses are distinguished by all three numbers that are stored of them.
void add_losses(StageRecord& stage, const Json& entry) {
  if (!has_time(stage)) return;
  stage.loss = Vector<double>::Constant(1, number(entry, "loss_median"));
  keep({.mean = number(entry, "loss_mean"),
        .median = number(entry, "loss_median"),
        .largest = number(entry, "loss_max")},
       stage);
}

StageRecord stage_of(const Json& entry) {
  const Json& own = entry.at("physinv");
  StageRecord stage{.stage = own.at("stage"), .key = own.at("key")};
  stage.position = own.value("position", Index{0});
  stage.stop = word_of(own.at("stop").get<std::string>(),
                       {Stop::converged,
                        Stop::iterations,
                        Stop::diverged,
                        Stop::failed,
                        Stop::skipped});
  stage.message = own.value("message", "");
  stage.iterations = entry.value("iterations", Index{0});
  stage.crowded = own.value("crowded", false);
  stage.revision = own.value("revision", "");
  stage.finished = own.value("finished", "");
  stage.run.threads = entry.value("threads", 0);
  const Json run = own.value("timed_on", Json());
  if (run.is_object())
    stage.run.thread_changes = run.value("thread_changes", "");
  add_times(stage, entry);
  stage.counts = counts_from_json(own.value("counts", Json()));
  add_statuses(stage, own);
  add_losses(stage, entry);
  return stage;
}

}  // namespace

bool is_published(const fs::path& directory) {
  return is_there(directory / "digest.json") &&
         is_there(directory / "results.json.gz") &&
         !is_there(directory / "journal.jsonl");
}

std::map<std::string, std::vector<Picture>> kept_pictures(
    const fs::path& directory, const Json& digest) {
  std::map<std::string, std::vector<Picture>> pictures;
  for (const Json& section : digest.at("sections")) {
    auto& own = pictures[section.at("experiment").get<std::string>()];
    for (const Json& figure : section.value("figures", Json::array()))
      own.push_back({.title = figure.at("title"),
                     .svg = read_file(directory / "figures" /
                                      figure.at("file").get<std::string>()),
                     .note = figure.value("note", "")});
  }
  return pictures;
}

Results summarized_results(const Json& results) {
  std::vector<CaseRecord> cases;
  std::map<std::string, std::size_t> known;
  for (const Json& entry : results.at("benchmarks")) {
    const Json& own = entry.at("physinv");
    StageRecord stage = stage_of(entry);
    const std::string run = entry.at("name");
    const std::string name = run.substr(0, run.rfind('/'));
    const auto [at, is_new] = known.emplace(name, cases.size());
    if (is_new) {
      CaseRecord c{.info = {.name = name}, .data = {}, .stages = {}};
      c.info.experiment = own.at("experiment");
      c.info.method = own.at("method");
      c.info.profile = own.value("profile", "");
      c.info.n = own.at("n");
      c.info.seed = own.at("seed");
      c.data.hash = own.value("data_hash", "");
      cases.push_back(std::move(c));
    }
    CaseRecord& c = cases[at->second];
    c.info.stages.push_back(stage.stage);
    stage.case_name = name;
    c.stages.push_back(std::move(stage));
  }
  return Results(std::move(cases));
}

void publish_campaign(const fs::path& target,
                      const Loaded& loaded,
                      const std::vector<Section>& sections,
                      Json provenance) {
  const auto forget_place = [](auto& context) {
    if (context.contains("options") && context["options"].is_object())
      context["options"].erase("out");
  };
  auto results = results_of(loaded);
  forget_place(results["context"]);
  forget_place(provenance);
  make_directory(target);
  const Folder folder(target);
  auto digest = digest_json(sections, provenance);
  // Neither is altered alone.
  digest["results"] = checksum_of(results);
  digest["checksum"] = checksum_of(digest);
  results["context"]["physinv"]["digest"] = digest["checksum"];
  if (const auto figures = kept_figures(sections); !figures.empty()) {
    const Folder below = folder.make("figures");
    for (const auto& [name, svg] : figures) below.write(name, svg);
  }
  folder.write("results.json.gz", gzipped(sealed(std::move(results)).dump(1)));
  folder.write("digest.json", digest.dump(1) + '\n');
}

Results published_results(const fs::path& directory) {
  const fs::path path = directory / "results.json.gz";
  try {
    Json results =
        parse_results(gunzipped(read_file(path), kLargestData), path);
    return summarized_results(results);
  } catch (const StoreError&) {
    throw;
  } catch (const std::exception& error) {
    throw StoreError(path.string() + " is damaged: " + error.what());
  }
}

}  // namespace physinv
