#include "suite/harness/processor.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace physinv {
namespace {

std::string text_of(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Core {
  std::string_view designer, part, name;
};

/// Cores of servers and of boards that Debian runs on.
constexpr Core kCores[] = {{"0x41", "0xd03", "ARM Cortex-A53"},
                           {"0x41", "0xd08", "ARM Cortex-A72"},
                           {"0x41", "0xd0b", "ARM Cortex-A76"},
                           {"0x41", "0xd0c", "ARM Neoverse-N1"},
                           {"0x41", "0xd40", "ARM Neoverse-V1"},
                           {"0x41", "0xd49", "ARM Neoverse-N2"},
                           {"0x41", "0xd4f", "ARM Neoverse-V2"},
                           {"0xc0", "0xac3", "Ampere-1"},
                           {"0xc0", "0xac4", "Ampere-1a"}};

}  // namespace

std::string cpuinfo_value(std::string_view cpuinfo, std::string_view key) {
  while (!cpuinfo.empty()) {
    const std::string_view line = cpuinfo.substr(0, cpuinfo.find('\n'));
    cpuinfo.remove_prefix(std::min(line.size() + 1, cpuinfo.size()));
    const auto colon = line.find(':');
    if (colon == std::string_view::npos || !line.starts_with(key)) continue;
    const auto value = line.find_first_not_of(' ', colon + 1);
    return std::string(value == line.npos ? "" : line.substr(value));
  }
  return {};
}

std::string processor_name(std::string_view cpuinfo, std::string_view board) {
  const std::string model = cpuinfo_value(cpuinfo, "model name");
  if (!model.empty()) return model;
  const std::string designer = cpuinfo_value(cpuinfo, "CPU implementer");
  const std::string part = cpuinfo_value(cpuinfo, "CPU part");
  for (const Core& core : kCores)
    if (core.designer == designer && core.part == part)
      return std::string(core.name);
  if (!board.empty())
    return std::string(board.substr(0, board.find('\0')));  // as C ends it
  return designer.empty() || part.empty()
             ? ""
             : fmt::format("{} part {}", designer, part);
}

std::string processor_name() {
  return processor_name(text_of("/proc/cpuinfo"),
                        text_of("/sys/firmware/devicetree/base/model"));
}

std::string_view processor_kind(std::string_view instruction_set) {
  constexpr std::string_view kX86 = "x86-64";
  return instruction_set.starts_with(kX86) ? kX86 : instruction_set;
}

}  // namespace physinv
