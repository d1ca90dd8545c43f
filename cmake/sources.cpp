// What numbers come from, by the tokens of sources.
//
//   physinv-sources FILE...
//     a line of C++ for each (SourceFile of suite/harness/build_info.h): its
//     path, the hash of its tokens and the headers that it includes
//   physinv-sources --build-info SOURCE_DIR INFO
//     INFO/build_info.cpp, of INFO/values.txt and the suite's sources;
//     build_info.d, which names them and their folders, so that a new one is
//     seen; physinv-build.cmake, for what is built on the installed suite. A
//     file whose content stays is not written.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <re2/re2.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "cmake/tokens.h"
#include "suite/core/hash.h"

namespace {

namespace fs = std::filesystem;
namespace source = physinv::source;
using re2::RE2;
using Names = std::vector<std::string>;

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in.is_open() || in.bad())
    throw std::runtime_error(path.string() + " cannot be read");
  return text;
}

void write(const fs::path& path, const std::string& text) {
  if (fs::exists(path) && text_of(path) == text) return;
  if (!(std::ofstream(path, std::ios::binary) << text).flush())
    throw std::runtime_error(path.string() + " cannot be written");
}

std::string lines_of(const fs::path& root, const Names& files) {
  std::string lines;
  for (const std::string& file : files) {
    const auto tokens = source::tokens_of(text_of(root / file));
    lines += fmt::format("    {{\"{}\", \"{}\",\n     \"{}\"}},\n",
                         file,
                         physinv::hex128(source::substance(tokens)),
                         source::includes(tokens));
  }
  return lines;
}

/// What is below some folders, sorted: all whose paths have the end, but what
/// a pattern finds and baselines/libraries, a project of its own.
Names below(const fs::path& root,
            const char* folders,
            const char* end,
            const char* but) {
  Names all;
  std::istringstream words(folders);
  const RE2 wanted(end), others(but);
  for (std::string folder; words >> folder;) {
    if (!fs::exists(root / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const auto path = entry.path().lexically_relative(root).string();
      if (RE2::PartialMatch(path, wanted) && !RE2::PartialMatch(path, others) &&
          !path.starts_with("baselines/libraries/"))
        all.push_back(path);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// 16 digits.
std::string digest(const std::string& text, const std::string& lines) {
  return physinv::hex128(text + '\n' + lines).substr(0, 16);
}

std::string replaced(std::string text, const char* what, const char* by) {
  RE2::GlobalReplace(&text, what, by);
  return text;
}

/// Sources with the folders above them.
std::string depfile(const fs::path& root, const fs::path& of, Names files) {
  std::set<std::string> all;
  for (fs::path file : files)
    for (; !file.empty(); file = file.parent_path())
      all.insert(replaced((root / file).string(), " ", R"(\\ )"));
  return fmt::format("{}: \\\n  {}\n", of.string(), fmt::join(all, " \\\n  "));
}

/// Of lines `name=value`, the last of each name.
std::map<std::string, std::string> values_in(const fs::path& path) {
  std::map<std::string, std::string> values;
  std::istringstream in(text_of(path));
  for (std::string line; std::getline(in, line);)
    values[line.substr(0, line.find('='))] = line.substr(line.find('=') + 1);
  return values;
}

void write_build_info(const fs::path& root, const fs::path& info) {
  const auto none = R"(/(kernels|kernels_libraries|real_fft|array_table)\.)";
  const Names numerics =
      below(root,
            "suite/core suite/linalg suite/nn problems optimizers baselines "
            "suite/diagnostics",
            R"(\.(h|cpp)$)",
            none);
  const Names metrics = below(root, "suite/cases", R"(\.(h|cpp)$)", none);
  const Names everywhere =
      below(root, "suite/harness", "/run_stage.(h|cpp)$", "^$");
  const Names interfaces =
      below(root,
            "suite problems optimizers baselines",
            R"(\.h$)",
            R"(^suite/(app|cases)/|/(kernels|real_fft)\.)");

  const std::string lines = lines_of(root, numerics);
  auto values = values_in(info / "values.txt");
  const auto libraries =
      values["libc"] + ' ' + values["eigen"] + ' ' + values["sleef"];
  values.erase("libc");  // no member
  const auto compiler = values["compiler"] + ' ' + values["compiler_version"];
  values["foundation"] =
      digest(values["bit_flags"] + ' ' + libraries, lines_of(root, everywhere));
  values["fingerprint"] = digest(values["foundation"], lines);
  values["interfaces"] =
      digest(compiler + ' ' + values["flags"], lines_of(root, interfaces));
  std::string members;
  for (const auto& [name, value] : values)
    members += fmt::format(
        "  i.{} = \"{}\";\n", name, replaced(value, R"(["\\])", R"(\\\0)"));

  write(info / "build_info.cpp",
        fmt::format("#include \"suite/harness/build_info.h\"\n\n"
                    "namespace physinv {{\n\n"
                    "static constexpr SourceFile kSources[] = {{\n{}{}}};\n\n"
                    "static constexpr BuildInfo kInfo = [] {{\n"
                    "  BuildInfo i{{.sources = kSources}};\n{}"
                    "  return i;\n}}();\n\n"
                    "const BuildInfo& build_info() {{ return kInfo; }}\n\n"
                    "}}  // namespace physinv\n",
                    lines,
                    lines_of(root, metrics),
                    members));
  write(info / "physinv-build.cmake",
        fmt::format("set(physinv_build \"{}\")\n"
                    "set(physinv_compiler \"{}\")\n"
                    "set(physinv_number_sources \"{}\")\n",
                    values["interfaces"],
                    compiler,
                    fmt::join(numerics, ";")));
  Names watched = numerics;
  for (const Names& more : {metrics, everywhere, interfaces})
    watched.insert(watched.end(), more.begin(), more.end());
  write(info / "build_info.d", depfile(root, info / "build_info.cpp", watched));
}

}  // namespace

int main(int argc, char** argv) try {
  const Names arguments(argv + 1, argv + argc);
  if (arguments.size() == 3 && arguments[0] == "--build-info")
    write_build_info(arguments[1], arguments[2]);
  else
    fmt::print("{}", lines_of("", arguments));
  return std::fflush(stdout) == 0 ? 0 : 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "physinv-sources: {}\n", error.what());
  return 1;
}
