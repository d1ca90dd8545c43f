#include "suite/store/storable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "suite/store/fields.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

constexpr std::size_t kLongestName = 1000;

Index length_of(const Batch<double>& array) { return array.cols(); }
template <class List>
Index length_of(const List& list) {
  return static_cast<Index>(list.size());
}

/// The first axis of every array counts examples or points of the curve.
std::string wrong_counts(const StageRecord& r) {
  std::string wrong;
  each_array(r, [&](const ArrayPlace& at, const auto& array) {
    const bool points = at.axes.starts_with("points");
    const Index expected = points ? r.curve.points() : r.loss.size();
    const Index length = length_of(array);
    const bool some = at.name == "x" && length < expected;
    if (wrong.empty() && length != expected && !some)
      wrong = fmt::format(
          "{} has {} entries; expected {}", at.name, length, expected);
  });
  return wrong;
}

template <class List>
bool are_counts(const List& list) {
  return std::all_of(list.begin(), list.end(), [](double v) {
    return std::isfinite(v) && v >= 0;
  });
}

bool has_estimates(const StageRecord& r) {
  if (r.stop == Stop::diverged) return true;
  for (Index i = 0; i < r.x.cols(); ++i)
    if (std::isfinite(r.loss(i)) && !r.x.col(i).allFinite()) return false;
  return true;
}

/// The first array with an infinity or NaN where there must be a number.
std::string wrong_numbers(const StageRecord& r) {
  const bool converged = r.stop == Stop::converged;
  const std::pair<const char*, bool> arrays[] = {
      {"iterations", are_counts(r.example_iterations)},
      {"evaluations", are_counts(r.example_evaluations)},
      {"curve/iteration", are_counts(r.curve.iteration)},
      {"curve/seconds", are_counts(r.curve.seconds)},
      {"curve/evaluations", are_counts(r.curve.evaluations)},
      {"loss", !converged || r.loss.allFinite()},
      {"x", has_estimates(r)}};
  for (const auto& [name, good] : arrays)
    if (!good)
      return fmt::format(
          "{} contains an invalid number for a stage that ended as '{}'",
          name,
          to_string(r.stop));
  return "";
}

bool is_utf8(const std::string& text) {
  if (std::all_of(
          text.begin(), text.end(), [](unsigned char c) { return c < 0x80; }))
    return true;
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

bool is_array_name(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName && name != "." &&
         std::none_of(name.begin(),
                      name.end(),
                      [](unsigned char c) {
                        return c < 0x20 || c == 0x7f || c == '/';
                      }) &&
         is_utf8(name);
}

std::string wrong_names(const StageRecord& r) {
  for (const auto& [name, array] : r.arrays)
    if (!is_array_name(name))
      return fmt::format(
          "arrays has the invalid name {}",
          nlohmann::json(name.substr(0, 80))
              .dump(-1, ' ', true, nlohmann::json::error_handler_t::replace));
  return "";
}

std::string wrong_status(const StageRecord& r) {
  for (const Status s : r.status)
    if (s > kStatuses.back())
      return fmt::format("status contains {}, which is not a status",
                         static_cast<int>(s));
  return "";
}

std::uint64_t array_bytes(const StageRecord& r) {
  std::uint64_t numbers = 0;
  const auto add = [&](const auto&, const auto& array) {
    numbers += static_cast<std::uint64_t>(array.size());
  };
  each_array(r, add);
  for (const auto& [name, array] : r.arrays) add(name, array);
  return numbers * sizeof(double);
}

}  // namespace

std::string flaw_of(const StageRecord& r) {
  for (auto* rule : {wrong_counts, wrong_status, wrong_names})
    if (auto wrong = rule(r); !wrong.empty()) return wrong;
  return has_result(r) ? wrong_numbers(r) : "";
}

std::string flaw_of_new(const StageRecord& r, std::size_t stages) {
  const std::uint64_t room = kLargestData / (1 + stages);
  if (auto wrong = flaw_of(r); !wrong.empty()) return wrong;
  return array_bytes(r) <= room
             ? ""
             : fmt::format("arrays have {} bytes; the limit is {}",
                           array_bytes(r),
                           room);
}

std::string bounded_message(std::string message) {
  if (message.size() <= kLongestMessage) return message;
  const std::size_t left_out = message.size() - kLongestMessage;
  message.resize(kLongestMessage);
  return message + fmt::format(" ... ({} bytes left out)", left_out);
}

}  // namespace physinv
