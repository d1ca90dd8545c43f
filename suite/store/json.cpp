#include "suite/store/json.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <type_traits>

#include "suite/store/checksum.h"
#include "suite/store/field_json.h"

namespace physinv {
namespace {

using nlohmann::json;

/// Brackets that are open at once. Copies and texts of JSON are made by
/// functions that call themselves.
bool is_shallow(std::string_view text) {
  constexpr int kDeepest = 64;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    if (quoted && c == '\\') ++i;  // whatever follows is not the end
    if (quoted) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kDeepest) return false;
  }
  return true;
}

double time_from(const json& j) {
  if (!j.is_number() || !std::isfinite(j.get<double>()) || j.get<double>() < 0)
    throw std::runtime_error("a time is not a number of seconds");
  return j;
}

/// Rows, columns and bytes; a list is one column.
template <class Array>
json binary(const Array& a) {
  json::binary_t::container_type bytes(static_cast<std::size_t>(a.size()) *
                                       sizeof(*a.data()));
  if (!bytes.empty()) std::memcpy(bytes.data(), a.data(), bytes.size());
  auto all = json::array({a.size(), 1, json::binary(std::move(bytes))});
  if constexpr (requires { a.rows(); }) all[0] = a.rows(), all[1] = a.cols();
  return all;
}

template <class Array>
void read_binary(const json& j, Array& to) {
  const Index rows = whole(j.at(0)), cols = whole(j.at(1));
  const auto& bytes = j.at(2).get_binary();
  const std::size_t size = bytes.size() / sizeof(*to.data());
  if (rows < 0 || cols < 0 || size * sizeof(*to.data()) != bytes.size() ||
      size != static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols))
    throw std::runtime_error("an array has the wrong size");
  if constexpr (std::is_same_v<Array, Batch<double>>)
    to.resize(rows, cols);
  else
    to.resize(static_cast<decltype(to.size())>(size));
  if (!bytes.empty()) std::memcpy(to.data(), bytes.data(), bytes.size());
}

}  // namespace

template <class Json>
Json parse_json(std::string_view text) {
  if (!is_shallow(text)) throw std::runtime_error("it is nested too deeply");
  return Json::parse(text);
}
template json parse_json(std::string_view);
template nlohmann::ordered_json parse_json(std::string_view);

template <class Json>
std::string checksum_of(Json document) {
  document.erase("checksum");
  return fmt::format(
      "{:08x}",
      crc32c(document.dump(-1, ' ', false, Json::error_handler_t::replace)));
}
template std::string checksum_of(json);
template std::string checksum_of(nlohmann::ordered_json);

template <class Json>
bool is_intact(const Json& document) {
  return !document.is_object() || !document.contains("checksum") ||
         document.at("checksum") == checksum_of(document);
}
template bool is_intact(const json&);
template bool is_intact(const nlohmann::ordered_json&);

std::int64_t whole(const json& j) {
  const bool fits =
      j.is_number_integer() &&
      (!j.is_number_unsigned() ||
       j.get<std::uint64_t>() <= std::numeric_limits<std::int64_t>::max());
  if (!fits) throw std::runtime_error("a number is not whole");
  return j;
}

json to_json(Seconds s) { return json::array({s.wall, s.cpu}); }

void read_json(const json& j, Index& number) { number = whole(j); }

void read_json(const json& j, std::uint64_t& count) {
  if (!j.is_number_unsigned() && whole(j) < 0)
    throw std::runtime_error("a count is negative");
  count = j;
}

void read_json(const json& j, int& workers) {
  const auto number = whole(j);
  if (number < 0 || number > 1'000'000)
    throw std::runtime_error("threads or jobs are not 0 to 1000000");
  workers = static_cast<int>(number);
}

Seconds seconds_from_json(const json& j) {
  return {time_from(j.at(0)), time_from(j.at(1))};
}
void read_json(const json& j, Seconds& seconds) {
  seconds = seconds_from_json(j);
}

template <class Json>
void add_counts(Json& object, const Counts& counts) {
  for (std::size_t i = 0; i < kCounters; ++i)
    if (const auto c = static_cast<Counter>(i); counts.knows(c))
      object[std::string(kCounterNames[i])] = counts[c];
}
template void add_counts(json&, const Counts&);
template void add_counts(nlohmann::ordered_json&, const Counts&);

json to_json(const Counts& counts) {
  json object = json::object();
  add_counts(object, counts);
  return object;
}

Counts counts_from_json(const json& j) {
  Counts counts;
  for (std::size_t i = 0; i < kCounters; ++i) {
    const auto c = static_cast<Counter>(i);
    if (const auto at = j.find(kCounterNames[i]); at != j.end())
      read_json(*at, counts[c]);
    else
      counts.forget(c);
  }
  return counts;
}
void read_json(const json& j, Counts& counts) { counts = counts_from_json(j); }

json to_json(const StageRecord& record) { return to_object(record); }
StageRecord stage_from_json(const json& j) {
  return from_object<StageRecord>(j);
}

json to_json(const CaseInfo& info) { return to_object(info); }
CaseInfo case_from_json(const json& j) { return from_object<CaseInfo>(j); }

std::vector<std::uint8_t> to_wire(const StageRecord& record) {
  json arrays = json::object(), findings = json::object();
  each_array(record, [&](const ArrayPlace& at, const auto& array) {
    arrays[at.name_text()] = binary(array);
  });
  for (const auto& [name, array] : record.arrays)
    findings[name] = binary(array);
  return json::to_msgpack({{"stage", to_json(record)},
                           {"arrays", std::move(arrays)},
                           {"findings", std::move(findings)}});
}

StageRecord from_wire(std::span<const std::uint8_t> bytes) {
  const json j = json::from_msgpack(bytes.begin(), bytes.end());
  auto record = stage_from_json(j.at("stage"));
  each_array(record, [&](const ArrayPlace& at, auto& array) {
    read_binary(j.at("arrays").at(at.name_text()), array);
  });
  for (const auto& [name, array] : j.at("findings").items())
    read_binary(array, record.arrays[ArrayKey::own(name)]);
  return record;
}

}  // namespace physinv
