#include "suite/harness/context.h"

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include "suite/harness/build_info.h"
#include "suite/harness/outside.h"
#include "suite/harness/processor.h"
#include "suite/harness/revision.h"
#include "suite/harness/run_case.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// First line of a file, empty if it cannot be read.
std::string first_line(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// "32K" -> 32768
long bytes_of(const std::string& text) {
  char* unit = nullptr;
  const long value = std::strtol(text.c_str(), &unit, 10);
  return value * (*unit == 'K' ? 1024 : *unit == 'M' ? 1024 * 1024 : 1);
}

/// Processors in a list such as "0-3,8".
int listed(const std::string& text) {
  int count = 0;
  const char* p = text.c_str();
  while (*p != '\0') {
    char* end = nullptr;
    const long first = std::strtol(p, &end, 10);
    if (end == p) break;
    long last = first;
    if (*end == '-') last = std::strtol(end + 1, &end, 10);
    count += static_cast<int>(last - first + 1);
    p = *end == ',' ? end + 1 : end;
  }
  return count;
}

json caches() {
  json all = json::array();
  const fs::path root = "/sys/devices/system/cpu/cpu0/cache";
  for (int i = 0;; ++i) {
    const fs::path dir = root / fmt::format("index{}", i);
    const std::string level = first_line(dir / "level");
    if (level.empty()) break;
    all.push_back(
        {{"type", first_line(dir / "type")},
         {"level", std::atoi(level.c_str())},
         {"size", bytes_of(first_line(dir / "size"))},
         {"num_sharing", listed(first_line(dir / "shared_cpu_list"))}});
  }
  return all;
}

/// In MHz; 0 if Linux does not tell it, as on most aarch64.
int clock_rate() {
  std::ifstream file("/proc/cpuinfo");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return std::atoi(cpuinfo_value(text, "cpu MHz").c_str());
}

json load() {
  double averages[3] = {};
  json all = json::array();
  const int known = getloadavg(averages, 3);
  for (int i = 0; i < known; ++i) all.push_back(averages[i]);
  return all;
}

/// Other sources of what ran: the program, if it is not the suite's, and what
/// it loaded.
void add_outsides(json& context) {
  if (const Outside* own = outside_program()) context["program"] = own->name;
  for (const Outside& o : outsides())
    if (o.plugin)
      context["plugins"].push_back(
          {{"name", o.name}, {"git_revision", revision_of(o.name)}});
}

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

int available_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof(set), &set) != 0) return 1;
  return std::max(1, CPU_COUNT(&set));
}

json machine_context(const std::string& revision) {
  const BuildInfo& build = build_info();
  const std::string governor =
      first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  const bool dirty = revision.ends_with("+dirty");
  json context = {
      {"date", utc_now()},
      {"host_name", host_name()},
      {"num_cpus", available_cores()},
      {"mhz_per_cpu", clock_rate()},
      {"cpu_scaling_enabled", !governor.empty() && governor != "performance"},
      {"scaling_governor", governor},
      {"caches", caches()},
      {"load_avg", load()},
      {"library_build_type",
       build.build_type == "Release" || build.build_type == "RelWithDebInfo"
           ? "release"
           : "debug"},
      {"cpu_model", processor_name()},
      {"instruction_set", build.instruction_set},
      {"compiler",
       fmt::format("{} {}", build.compiler, build.compiler_version)},
      {"compiler_flags", build.flags},
      {"build_type", build.build_type},
      {"fingerprint", build.fingerprint},
      {"version", build.version},
      {"libraries",
       {{"eigen", build.eigen},
        {"sleef", build.sleef},
        {"hdf5", build.hdf5},
        {"nlohmann_json", build.json},
        {"fmt", build.fmt},
        {"cli11", build.cli11}}},
      {"git_revision",
       dirty ? revision.substr(0, revision.size() - 6) : revision},
      {"git_dirty", dirty},
  };
  add_outsides(context);
  return context;
}

std::string version_text() {
  const BuildInfo& b = build_info();
  const Outside* own = outside_program();
  return (own == nullptr ? "" : fmt::format("{}, built on\n", own->name)) +
         fmt::format(
             "physinv-bench {}\n"
             "compiler         {} {} ({})\n"
             "flags            {}\n"
             "instruction set  {}\n"
             "revision         {}\n"
             "numerics         {}\n"
             "libraries        Eigen {}, SLEEF {}, HDF5 {}, nlohmann-json "
             "{}, "
             "fmt {}, CLI11 {}",
             b.version,
             b.compiler,
             b.compiler_version,
             b.build_type,
             b.flags,
             b.instruction_set,
             git_revision(),
             b.fingerprint,
             b.eigen,
             b.sleef,
             b.hdf5,
             b.json,
             b.fmt,
             b.cli11);
}

}  // namespace physinv
