#include "tests/fuzz/sealed.h"

#include <nlohmann/json.hpp>

#include "suite/store/plan.h"

namespace physinv::fuzz {
namespace {

using nlohmann::json;

bool unsealed(const json& plan) {
  if (!plan.is_object()) return false;
  const auto at = plan.find("checksum");
  return at != plan.end() && *at == kNoChecksum;
}

}  // namespace

std::string sealed_front(std::string_view bytes) {
  if (!bytes.starts_with(kNoChecksum)) return std::string(bytes);
  const std::string_view rest = bytes.substr(kNoChecksum.size());
  return checksum(rest) + std::string(rest);
}

std::string sealed_lines(std::string_view bytes) {
  std::string all;
  while (!bytes.empty()) {
    const auto end = std::min(bytes.find('\n'), bytes.size() - 1);
    const std::string_view line = bytes.substr(0, end);
    // The checksum is of what follows the space.
    all += line.starts_with(kNoChecksum) && line.size() > kNoChecksum.size()
               ? checksum(line.substr(kNoChecksum.size() + 1)) +
                     std::string(line.substr(kNoChecksum.size()))
               : std::string(line);
    all += bytes[end];
    bytes.remove_prefix(end + 1);
  }
  return all;
}

std::string sealed_plan(std::string_view bytes) {
  const json plan = json::parse(bytes, nullptr, false);
  return unsealed(plan) ? plan_text(plan) : std::string(bytes);
}

std::string sealed_end(std::string_view bytes) {
  const std::string end = std::string(kNoChecksum) + '\n';
  if (!bytes.ends_with(end)) return std::string(bytes);
  bytes.remove_suffix(end.size());
  constexpr std::string_view kSeal = "checksum ";
  return std::string(bytes) +
         checksum(bytes.substr(0, bytes.size() - kSeal.size())) + '\n';
}

}  // namespace physinv::fuzz
