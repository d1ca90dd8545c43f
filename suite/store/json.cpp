#include "suite/store/json.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "suite/store/checksum.h"

namespace physinv {
namespace {

using nlohmann::json;

template <class E>
E parse(std::string_view text, std::initializer_list<E> all) {
  for (const E e : all)
    if (to_string(e) == text) return e;
  throw std::runtime_error("unknown word '" + std::string(text) + "'");
}

/// Brackets that are open at once. Copies and texts of JSON are made by
/// functions that call themselves.
bool is_shallow(std::string_view text) {
  constexpr int kDeepest = 64;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    if (quoted && c == '\\') ++i;  // whatever follows is no end
    if (quoted) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kDeepest) return false;
  }
  return true;
}

std::uint64_t count(const json& j) {
  if (!j.is_number_unsigned() && whole(j) < 0)
    throw std::runtime_error("a count is negative");
  return j;
}

double time_from(const json& j) {
  if (!j.is_number() || !std::isfinite(j.get<double>()) || j.get<double>() < 0)
    throw std::runtime_error("a time is no number of seconds");
  return j;
}

json to_json(const RunContext& run) {
  return {{"profile", run.profile},
          {"host", run.host},
          {"processor", run.processor},
          {"instruction_set", run.instruction_set},
          {"threads", run.threads},
          {"jobs", run.jobs}};
}

int workers(const json& j) {
  const auto number = whole(j);
  if (number < 0 || number > 1'000'000)
    throw std::runtime_error("threads or jobs are not 0 to 1000000");
  return static_cast<int>(number);
}

RunContext run_from_json(const json& j) {
  return {.profile = j.at("profile"),
          .host = j.at("host"),
          .processor = j.at("processor"),
          .instruction_set = j.at("instruction_set"),
          .threads = workers(j.at("threads")),
          .jobs = workers(j.at("jobs"))};
}

json binary(const double* data, Index rows, Index cols) {
  json::binary_t::container_type bytes(static_cast<std::size_t>(rows * cols) *
                                       sizeof(double));
  if (!bytes.empty()) std::memcpy(bytes.data(), data, bytes.size());
  return json::array({rows, cols, json::binary(std::move(bytes))});
}

template <class M>
json binary(const M& m) {
  return binary(m.data(), m.rows(), m.cols());
}

json binary(const std::vector<double>& v) {
  return binary(v.data(), static_cast<Index>(v.size()), 1);
}

Batch<double> batch(const json& j) {
  Batch<double> b(j.at(0).get<Index>(), j.at(1).get<Index>());
  const auto& bytes = j.at(2).get_binary();
  if (bytes.size() != static_cast<std::size_t>(b.size()) * sizeof(double))
    throw std::runtime_error("an array has the wrong size");
  if (!bytes.empty()) std::memcpy(b.data(), bytes.data(), bytes.size());
  return b;
}

std::vector<double> list(const json& j) {
  const Batch<double> b = batch(j);
  return {b.data(), b.data() + b.size()};
}

json status_binary(const std::vector<Status>& status) {
  json::binary_t::container_type bytes;
  for (const Status s : status) bytes.push_back(static_cast<std::uint8_t>(s));
  return json::binary(std::move(bytes));
}

json arrays_to_json(const StageRecord& r) {
  json arrays = json::object();
  for (const auto& [name, b] : r.arrays) arrays[name] = binary(b);
  return {{"x", binary(r.x)},
          {"loss", binary(r.loss)},
          {"status", status_binary(r.status)},
          {"iterations", binary(r.example_iterations)},
          {"evaluations", binary(r.example_evaluations)},
          {"curve",
           {{"iteration", binary(r.curve.iteration)},
            {"seconds", binary(r.curve.seconds)},
            {"evaluations", binary(r.curve.evaluations)},
            {"loss", binary(r.curve.loss)},
            {"x", binary(r.curve.x)}}},
          {"arrays", std::move(arrays)}};
}

void arrays_from_json(const json& j, StageRecord& r) {
  r.x = batch(j.at("x"));
  r.loss = batch(j.at("loss"));
  for (const auto s : j.at("status").get_binary())
    r.status.push_back(static_cast<Status>(s));
  r.example_iterations = batch(j.at("iterations"));
  r.example_evaluations = batch(j.at("evaluations"));
  const json& curve = j.at("curve");
  r.curve.iteration = list(curve.at("iteration"));
  r.curve.seconds = list(curve.at("seconds"));
  r.curve.evaluations = list(curve.at("evaluations"));
  r.curve.loss = batch(curve.at("loss"));
  r.curve.x = batch(curve.at("x"));
  for (const auto& [name, b] : j.at("arrays").items())
    r.arrays[ArrayKey::own(name)] = batch(b);
}

}  // namespace

template <class Json>
Json parse_json(std::string_view text) {
  if (!is_shallow(text)) throw std::runtime_error("it is nested too deep");
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

Seconds seconds_from_json(const json& j) {
  return {time_from(j.at(0)), time_from(j.at(1))};
}

template <class Json>
void add_counts(Json& object, const Counts& counts) {
  for (std::size_t i = 0; i < kCounters; ++i)
    if (const auto c = static_cast<Counter>(i); counts.knows(c))
      object[std::string(kCounterNames[i])] = counts[c];
}
template void add_counts(json&, const Counts&);
template void add_counts(nlohmann::ordered_json&, const Counts&);

Counts counts_from_json(const json& j) {
  Counts counts;
  for (std::size_t i = 0; i < kCounters; ++i) {
    const auto c = static_cast<Counter>(i);
    if (const auto at = j.find(kCounterNames[i]); at != j.end())
      counts[c] = count(*at);
    else
      counts.forget(c);
  }
  return counts;
}

json to_json(const StageRecord& r) {
  json options = json::array(), counts = json::object();
  add_counts(counts, r.counts);
  for (const auto& [name, value] : r.options)
    options.push_back(json::array({name, value}));
  return {{"case", r.case_name},
          {"stage", r.stage},
          {"key", r.key},
          {"position", r.position},
          {"options", std::move(options)},
          {"stop", to_string(r.stop)},
          {"message", r.message},
          {"iterations", r.iterations},
          {"clocks",
           {{"setup", to_json(r.clocks.setup)},
            {"warmup", to_json(r.clocks.warmup)},
            {"data", to_json(r.clocks.data)},
            {"solve", to_json(r.clocks.solve)},
            {"measure", to_json(r.clocks.measure)}}},
          {"counts", std::move(counts)},
          {"buffer_bytes", r.buffer_bytes},
          {"rss_bytes", r.rss_bytes},
          {"crowded", r.crowded},
          {"finished", r.finished},
          {"revision", r.revision},
          {"trajectory", r.trajectory},
          {"run", to_json(r.run)}};
}

StageRecord stage_from_json(const json& j) {
  StageRecord r;
  r.case_name = j.at("case");
  r.stage = j.at("stage");
  r.key = j.at("key");
  r.position = whole(j.at("position"));
  for (const auto& o : j.at("options"))
    r.options.emplace_back(o.at(0), o.at(1));
  r.stop = parse(j.at("stop").get<std::string>(),
                 {Stop::converged,
                  Stop::iterations,
                  Stop::diverged,
                  Stop::failed,
                  Stop::skipped});
  r.message = j.at("message");
  r.iterations = whole(j.at("iterations"));
  const json& clocks = j.at("clocks");
  r.clocks = {
      .setup = seconds_from_json(clocks.at("setup")),
      .warmup = seconds_from_json(clocks.at("warmup")),
      // Journals of before it was told apart do not have it.
      .data = seconds_from_json(clocks.value("data", json::array({0.0, 0.0}))),
      .solve = seconds_from_json(clocks.at("solve")),
      .measure = seconds_from_json(clocks.at("measure"))};
  r.counts = counts_from_json(j.at("counts"));
  r.buffer_bytes = count(j.at("buffer_bytes"));
  r.rss_bytes = count(j.at("rss_bytes"));
  r.crowded = j.at("crowded");
  r.finished = j.at("finished");
  r.revision = j.at("revision");
  r.trajectory = j.at("trajectory");
  if (j.contains("run")) r.run = run_from_json(j.at("run"));
  return r;
}

json to_json(const CaseInfo& c) {
  return {{"name", c.name},
          {"experiment", c.experiment},
          {"method", c.method},
          {"profile", c.profile},
          {"n", c.n},
          {"seed", c.seed},
          {"precision", to_string(c.precision)},
          {"stages", c.stages},
          {"keys", c.keys}};
}

CaseInfo case_from_json(const json& j) {
  return {.name = j.at("name"),
          .experiment = j.at("experiment"),
          .method = j.at("method"),
          .profile = j.at("profile"),
          .n = whole(j.at("n")),
          .seed = count(j.at("seed")),
          .precision = parse(j.at("precision").get<std::string>(),
                             {Precision::f32, Precision::f64}),
          .stages = j.at("stages"),
          .keys = j.at("keys")};
}

std::vector<std::uint8_t> to_wire(const StageRecord& record) {
  return json::to_msgpack(
      {{"stage", to_json(record)}, {"arrays", arrays_to_json(record)}});
}

StageRecord from_wire(std::span<const std::uint8_t> bytes) {
  const json j = json::from_msgpack(bytes.begin(), bytes.end());
  StageRecord record = stage_from_json(j.at("stage"));
  arrays_from_json(j.at("arrays"), record);
  return record;
}

}  // namespace physinv
