// Reads the #include lines of every source: an arrow between layers that is
// not in the table below fails, and so does a library used out of its place.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace {

namespace fs = std::filesystem;

struct Layer {
  std::set<std::string> layers;     // in addition to itself
  std::set<std::string> libraries;  // in addition to the standard one and fmt
};

const std::map<std::string, Layer> kLayers{
    {"suite/core", {{}, {"eigen", "fftw", "hdf5", "random123", "sleef"}}},
    {"suite/linalg", {{"suite/core"}, {"eigen"}}},
    {"suite/nn", {{"suite/core"}, {"eigen"}}},
    {"problems", {{"suite/core", "suite/linalg"}, {"eigen"}}},
    {"optimizers", {{"suite/core", "suite/linalg", "suite/nn"}, {"eigen"}}},
    {"baselines", {{"suite/core", "suite/nn", "optimizers"}, {"eigen"}}},
    {"baselines/libraries",
     {{"suite/core",
       "optimizers",
       "suite/harness",
       "suite/evidence",
       "suite/results"},
      {"eigen", "ceres", "dlib", "gsl", "nlopt"}}},
    {"suite/diagnostics",
     {{"suite/core", "suite/nn", "problems", "optimizers"}, {"eigen"}}},
    {"suite/store", {{"suite/core"}, {"json", "hdf5", "zlib"}}},
    {"suite/results", {{"suite/core", "suite/store"}, {"json"}}},
    {"suite/evidence", {{"suite/core", "suite/store", "suite/results"}, {}}},
    {"suite/compare",
     {{"suite/core", "suite/store", "suite/results", "suite/evidence"},
      {"json"}}},
    {"suite/harness",
     {{"suite/core",
       "suite/nn",
       "suite/store",
       "suite/results",
       "suite/evidence"},
      {"json", "re2"}}},
    {"suite/gate",
     {{"suite/core", "suite/store", "suite/results", "suite/harness"},
      {"json"}}},
    {"suite/planning",
     {{"suite/core",
       "suite/store",
       "suite/results",
       "suite/evidence",
       "suite/harness"},
      {"json"}}},
    {"suite/cases",
     {{"suite/core",
       "suite/nn",
       "problems",
       "optimizers",
       "baselines",
       "suite/diagnostics",
       "suite/store",
       "suite/results",
       "suite/evidence",
       "suite/harness"},
      {"eigen", "json"}}},
    {"reports", {{"suite/core", "suite/store", "suite/results"}, {"json"}}},
    {"python",
     {{"suite/core",
       "optimizers",
       "suite/store",
       "suite/results",
       "suite/harness",
       "suite/cases",
       "suite/app"},
      {"eigen", "pybind11"}}},
    {"suite/app",
     {{"suite/core",
       "suite/nn",
       "problems",
       "optimizers",
       "baselines",
       "suite/store",
       "suite/results",
       "suite/evidence",
       "suite/harness",
       "suite/gate",
       "suite/cases",
       "suite/compare",
       "suite/planning",
       "reports"},
      {"cli11", "benchmark", "json", "toml++"}}},
};

// "suite/nn/unet.h" -> "suite/nn", "problems/heat/heat.h" -> "problems".
// baselines/libraries is a project of its own, which builds a plug-in.
std::string layer_of(const std::string& path) {
  const std::string plugin = "baselines/libraries";
  if (path.starts_with(plugin + '/')) return plugin;
  const auto depth =
      path.starts_with("suite/") ? path.find('/', 6) : path.find('/');
  return path.substr(0, depth);
}

// "problems/heat/heat.h" -> "problems/heat"; no problem knows another.
std::string problem_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().generic_string();
  return layer_of(path) == "problems" ? folder : "";
}

// "suite/cases/hig/toy/claims.cpp" -> "hig"; no paper knows another.
std::string paper_of(const std::string& path) {
  const std::string cases = "suite/cases/";
  if (!path.starts_with(cases)) return "";
  return path.substr(cases.size(), path.find('/', cases.size()) - cases.size());
}

// Name of a third-party library, empty for the standard library and system.
std::string library_of(const std::string& header) {
  static const std::map<std::string, std::string> kPrefixes{
      {"Eigen/", "eigen"},
      {"unsupported/Eigen/", "eigen"},
      {"fftw3", "fftw"},
      {"sleef.h", "sleef"},
      {"ceres/", "ceres"},
      {"glog/", "ceres"},  // logs its words
      {"dlib/", "dlib"},
      {"gsl/", "gsl"},
      {"nlopt.h", "nlopt"},
      {"hdf5", "hdf5"},
      {"H5", "hdf5"},
      {"Random123/", "random123"},
      {"fmt/", ""},  // the messages of SUITE_CHECK, so everybody's
      {"nlohmann/", "json"},
      {"CLI/", "cli11"},
      {"toml++/", "toml++"},
      {"re2/", "re2"},
      {"zlib.h", "zlib"},
      {"benchmark/", "benchmark"},
      {"pybind11/", "pybind11"},
      {"gnu/", ""},  // the system's, as the pattern below
      {"linux/", ""},
  };
  for (const auto& [prefix, library] : kPrefixes) {
    if (header.starts_with(prefix)) return library;
  }
  static const std::regex kSystem("[a-z_0-9]+|(sys/)?[a-z_0-9]+\\.h");
  return std::regex_match(header, kSystem) ? "" : header;
}

// Why `file` may not include `header` ("" if it may). `quoted` as in the line.
std::string objection(const std::string& file,
                      const std::string& header,
                      bool quoted) {
  const std::string from = layer_of(file);
  const auto layer = kLayers.find(from);
  if (layer == kLayers.end()) return "the folder is not a layer";
  const bool kernels = fs::path(file).stem().string().starts_with("kernels");
  if (kernels && from != "suite/app") {  // a target of its own
    return layer_of(header) == "suite/app" ? "kernels know no program" : "";
  }
  if (!quoted) {
    const std::string library = library_of(header);
    if (library.empty() || layer->second.libraries.contains(library)) return "";
    return from + " does not use " + library;
  }
  if (from == "baselines/libraries" && header.find('/') == header.npos)
    return "";  // of its own folder
  const std::string to = layer_of(header);
  if (!kLayers.contains(to)) return "not relative to the project's root";
  if (to != from && !layer->second.layers.contains(to)) {
    return from + " does not include " + to;
  }
  const std::string problem = problem_of(header);
  if (from == "problems" && to == from && problem != problem_of(file) &&
      problem != "problems/fluid") {  // what problems of flow share
    return "a problem does not include another";
  }
  if (from == "suite/cases" && to == from &&
      paper_of(header) != paper_of(file) && paper_of(header) != "common") {
    return "a paper does not include another";
  }
  return "";
}

TEST(Layering, EveryIncludeFollowsTheLayers) {
  static const std::regex kInclude(
      "^\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
  const fs::path root = PHYSINV_SOURCE_DIR;
  int files = 0;
  for (const char* top :
       {"suite", "problems", "optimizers", "baselines", "reports", "python"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const auto extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      ++files;
      const std::string file =
          fs::relative(entry.path(), root).generic_string();
      std::ifstream in(entry.path());
      std::string line;
      for (int number = 1; std::getline(in, line); ++number) {
        std::smatch match;
        if (!std::regex_match(line, match, kInclude)) continue;
        EXPECT_EQ(objection(file, match[2], match[1] == "\""), "")
            << file << ":" << number << ": " << line;
      }
    }
  }
  EXPECT_GT(files, 0);
}

struct Include {
  const char *file, *header;  // <name of a library's
};

bool objected(const Include& line) {
  const bool quoted = *line.header != '<';
  return !objection(line.file, line.header + !quoted, quoted).empty();
}

TEST(Layering, ArrowsThatMustNotBe) {
  const Include refused[] = {
      {"suite/core/rng.cpp", "suite/nn/linear.h"},
      {"optimizers/jpo.h", "problems/heat/heat.h"},
      {"problems/heat/heat.h", "problems/sine/sine.h"},
      {"problems/fluid/plane.h", "problems/sine/sine.h"},
      {"problems/heat/heat.h", "suite/nn/linear.h"},
      {"reports/tables.cpp", "suite/harness/runner.h"},
      {"suite/cases/hig/toy/claims.cpp", "suite/cases/jpo/common/shares.h"},
      {"suite/harness/runner.cpp", "optimizers/jpo.h"},
      {"optimizers/jpo.cpp", "jpo.h"},
      {"elsewhere/a.cpp", "suite/core/rng.h"},
      {"optimizers/jpo.cpp", "<nlohmann/json.hpp"},
      {"problems/heat/heat.cpp", "<benchmark/benchmark.h"},
      {"suite/nn/kernels.cpp", "suite/app/verbs.h"},
      {"suite/core/rng.cpp", "<boost/random.hpp"},
      {"optimizers/bfgs.cpp", "<gsl/gsl_multimin.h"},
      {"baselines/supervised.cpp", "<gsl/gsl_multimin.h"},
      {"baselines/a.cpp", "baselines/libraries/fiber.h"},
      {"baselines/libraries/a.cpp", "problems/heat/heat.h"},
  };
  for (const Include& line : refused)
    EXPECT_TRUE(objected(line)) << line.file << ' ' << line.header;
}

TEST(Layering, ArrowsThatMayBe) {
  const Include allowed[] = {
      {"baselines/a.h", "optimizers/training.h"},
      {"problems/heat/a.cpp", "problems/heat/b.h"},
      {"suite/cases/hig/toy/claims.cpp", "suite/cases/hig/common/methods.h"},
      {"problems/a/a.h", "problems/fluid/plane.h"},
      {"problems/a/kernels.cpp", "<benchmark/benchmark.h"},
      {"suite/core/fft.cpp", "<fftw3.h"},
      {"reports/svg.cpp", "<sys/stat.h"},
      {"suite/core/rng.cpp", "<numbers"},
  };
  for (const Include& line : allowed)
    EXPECT_FALSE(objected(line)) << line.file << ' ' << line.header;
}

}  // namespace
