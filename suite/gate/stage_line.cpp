#include "suite/gate/stage_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <vector>

#include "suite/core/decimal.h"
#include "suite/core/double_double.h"
#include "suite/core/hash.h"
#include "suite/core/median.h"
#include "suite/core/rng.h"
#include "suite/gate/digits.h"
#include "suite/store/checksum.h"
#include "suite/store/fields.h"

namespace physinv {
namespace {

constexpr int kMost32 = 5, kMost64 = 12;
constexpr std::string_view kNone = "none";
/// Of a stage that draws data of its own, so that no disturbance reaches it.
constexpr int kUnmeasured = 3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Losses losses_of(const Vector<double>& all) {
  std::vector<double> finite;
  for (const double loss : all)
    if (std::isfinite(loss)) finite.push_back(loss);
  const Index nonfinite = all.size() - static_cast<Index>(finite.size());
  if (finite.empty()) return {kNaN, kNaN, kNaN, nonfinite};
  const auto [least, most] = std::minmax_element(finite.begin(), finite.end());
  return {*least, median_high(finite), *most, nonfinite};
}

/// Of all that another run must reproduce but the work, which is counted apart.
std::string hash_of(const StageRecord& r) {
  ArrayHash hash;
  hash.add(r.x).add(r.loss).add(r.curve.loss).add(r.curve.x);
  for (const Status s : r.status) hash.add(static_cast<std::uint64_t>(s));
  for (const auto& [name, array] : r.arrays)
    hash.add(std::string_view(name)).add(array);
  return hex64(hash.value());
}

std::uint64_t difference(std::uint64_t a, std::uint64_t b) {
  return a > b ? a - b : b - a;
}

template <class T>
T parse_number(std::string_view text) {
  if (const auto value = decimal<T>(text)) return *value;
  throw std::runtime_error(fmt::format("'{}' is not a number", text));
}

/// Cuts `text` at the first `mark`; what follows it stays in `text`.
std::string_view cut(std::string_view& text, std::string_view mark) {
  const auto end = text.find(mark);
  const std::string_view head = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size()
                                                   : end + mark.size());
  return head;
}

StatusCounts parse_statuses(std::string_view text) {
  StatusCounts counts{};
  while (!text.empty()) {
    std::string_view part = cut(text, ",");
    const Status s = value_of<Status>(cut(part, ":"));
    counts[static_cast<std::size_t>(s)] = parse_number<Index>(part);
  }
  return counts;
}

Losses parse_losses(std::string_view text) {
  Losses l;
  l.best = parse_number<double>(cut(text, ","));
  l.median = parse_number<double>(cut(text, ","));
  l.worst = parse_number<double>(text);
  return l;
}

int parse_digits(std::string_view text) {
  if (text == kNone) return kNoDigits;
  const int value = parse_number<int>(text);
  if (value < 0 || value > kMost64)
    throw std::runtime_error(fmt::format(
        "digits={} is neither from 0 to {} nor {}", text, kMost64, kNone));
  return value;
}

void read_work(StageLine& line, std::string_view key, std::string_view value) {
  const auto at = std::find(kWork.begin(), kWork.end(), key);
  if (at == kWork.end())
    throw std::runtime_error(fmt::format("unknown key '{}'", key));
  const auto i = static_cast<std::size_t>(at - kWork.begin());
  line.work[i] = parse_number<std::uint64_t>(cut(value, "~"));
  if (!value.empty()) line.jitter[i] = parse_number<std::uint64_t>(value);
}

void read_field(StageLine& line, std::string_view key, std::string_view value) {
  if (key == "trajectory") {
    line.trajectory = value;
  } else if (key == "results") {
    line.results = value;
  } else if (key == "stop") {
    line.stop = value_of<Stop>(value);
  } else if (key == "status") {
    line.statuses = parse_statuses(value);
  } else if (key == "loss") {
    const Index nonfinite = line.losses.nonfinite;
    line.losses = parse_losses(value);
    line.losses.nonfinite = nonfinite;
  } else if (key == "nonfinite") {
    line.losses.nonfinite = parse_number<Index>(value);
  } else if (key == "x") {
    line.x = parse_number<double>(value);
  } else if (key == "digits") {
    line.digits = parse_digits(value);
  } else if (key == "ms") {
    line.fastest = parse_number<double>(cut(value, ".."));
    line.slowest = parse_number<double>(value);
  } else {
    read_work(line, key, value);
  }
}

/// Weights of variance 1: the sum of a difference is about as large as its
/// norm. As exact as a double can say it, whatever cancels.
double projection_of(const Batch<double>& x) {
  Stream weights = Rng::root("gate/projection", 0).stream();
  const double range = std::sqrt(3.0);
  DoubleDouble sum;
  for (const double v : x.reshaped()) {
    const double weight = weights.uniform(-range, range);
    if (std::isfinite(v)) sum += DoubleDouble::product(weight, v);
  }
  return double(sum);
}

double norm_of(const Batch<double>& x) {
  double sum = 0;
  for (const double v : x.reshaped())
    if (std::isfinite(v)) sum += v * v;
  return std::sqrt(sum);
}

/// What every line has.
constexpr std::array<std::string_view, 7> kStageFields = {
    "trajectory", "results", "stop", "status", "loss", "digits", "ms"};

}  // namespace

int shown_digits(const StageLine& line) {
  return std::clamp(line.digits + 1, 1, kMost64 + 1);
}

StageLine line_of(const StageRecord& r) {
  StageLine line{.name = r.case_name + "/" + r.stage,
                 .trajectory = r.trajectory,
                 .results = hash_of(r),
                 .stop = r.stop,
                 .message = r.message,
                 .statuses = count(r.status),
                 .losses = losses_of(r.loss)};
  if (!has_result(r)) return line;  // what it spent gained nothing
  line.x = projection_of(r.x), line.x_norm = norm_of(r.x);
  line.work = {static_cast<std::uint64_t>(r.iterations),
               r.counts[Counter::forward],
               r.counts[Counter::vjp],
               r.counts[Counter::jacobian],
               r.counts[Counter::inverse],
               r.counts[Counter::network_forward],
               r.counts[Counter::network_backward]};
  line.fastest = line.slowest = 1e3 * r.clocks.solve.wall;
  return line;
}

void enter_disturbed(StageLine& line,
                     const StageLine& other,
                     Precision precision) {
  const int most = precision == Precision::f32 ? kMost32 : kMost64;
  const auto pairs = {std::pair(line.losses.best, other.losses.best),
                      std::pair(line.losses.median, other.losses.median),
                      std::pair(line.losses.worst, other.losses.worst)};
  double apart_by = 0;
  for (const auto& [a, b] : pairs)
    apart_by = std::max(apart_by, std::abs(log_distance(a, b)));
  line.digits =
      same_bits(line, other) ? kUnmeasured : stable_digits(apart_by, most);
  for (std::size_t i = 0; i < kWork.size(); ++i)
    line.jitter[i] = difference(line.work[i], other.work[i]);
  line.fastest = std::min(line.fastest, other.fastest);
  line.slowest = std::max(line.slowest, other.slowest);
}

bool same_bits(const StageLine& a, const StageLine& b) {
  return a.trajectory == b.trajectory && a.results == b.results;
}

std::string case_of(std::string_view stage_name) {
  return std::string(stage_name.substr(0, stage_name.rfind('/')));
}

std::string to_text(const StageLine& l) {
  const int shown = shown_digits(l);
  std::string text = fmt::format(
      "{} trajectory={} results={} stop={} status={} "
      "loss={:.{}e},{:.{}e},{:.{}e}",
      l.name,
      l.trajectory,
      l.results,
      to_string(l.stop),
      status_text(l.statuses, ",", ':'),
      l.losses.best,
      shown,
      l.losses.median,
      shown,
      l.losses.worst,
      shown);
  if (l.x) text += fmt::format(" x={}", *l.x);
  text += l.digits == kNoDigits ? fmt::format(" digits={}", kNone)
                                : fmt::format(" digits={}", l.digits);
  if (l.losses.nonfinite > 0)
    text += fmt::format(" nonfinite={}", l.losses.nonfinite);
  for (std::size_t i = 0; i < kWork.size(); ++i) {
    if (l.work[i] == 0 && l.jitter[i] == 0) continue;
    text += fmt::format(" {}={}", kWork[i], l.work[i]);
    if (l.jitter[i] > 0) text += fmt::format("~{}", l.jitter[i]);
  }
  return text + fmt::format(" ms={:.3g}..{:.3g}", l.fastest, l.slowest);
}

StageLine stage_line(std::string_view text) {
  StageLine line{.name = std::string(cut(text, " "))};
  std::set<std::string_view> seen;
  while (!text.empty()) {
    std::string_view value = cut(text, " ");
    const std::string_view key = cut(value, "=");
    if (!seen.insert(key).second)
      throw std::runtime_error(fmt::format("{}: {} twice", line.name, key));
    read_field(line, key, value);
  }
  for (const auto field : kStageFields)
    if (!seen.contains(field))
      throw std::runtime_error(fmt::format("{} has no {}", line.name, field));
  return line;
}

}  // namespace physinv
