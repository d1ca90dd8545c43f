#include "suite/planning/durations.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "suite/core/clock.h"
#include "suite/core/decimal.h"
#include "suite/core/math.h"
#include "suite/store/errors.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// Rows tell of no more and no less work than this factor.
constexpr double kReach = 4;
/// What a machine that others share adds to its fastest and slowest run.
constexpr double kOthers = 1.5;
/// Of a row of other operations.
constexpr double kElsewhere = 2;
constexpr std::size_t kTexts = 3, kNumbers = 6;

struct Line {
  std::array<std::string, kTexts> texts;
  std::array<double, kNumbers> numbers;
};

std::optional<Line> line_of(const std::string& text) {
  std::istringstream in(text);
  Line line;
  for (std::string& word : line.texts)
    if (!std::getline(in, word, ',') || word.empty()) return {};
  std::string word;
  for (double& number : line.numbers) {
    if (!std::getline(in, word, ',')) return {};
    number = decimal<double>(word).value_or(-1);
    if (!(number >= 0) || !std::isfinite(number)) return {};
  }
  if (std::getline(in, word)) return {};
  return line;
}

}  // namespace

Durations Durations::read(const fs::path& file) {
  Durations all;
  if (!is_file(file)) return all;
  std::istringstream lines(read_file(file));
  std::string text;
  std::getline(lines, text);  // names of columns
  for (int number = 2; std::getline(lines, text); ++number) {
    const auto line = line_of(text);
    if (!line)
      throw StoreError(fmt::format(
          "{}, line {}, is not a duration of a stage", file.string(), number));
    const auto& [n, operations, seconds, least, most, bytes] = line->numbers;
    all.rows_[{line->texts[0], line->texts[1], line->texts[2]}].push_back(
        {static_cast<Index>(n), operations, {seconds, least, most}, bytes});
  }
  return all;
}

std::optional<TimeRange> Durations::time(const std::string& experiment,
                                         const std::string& method,
                                         const std::string& stage,
                                         double operations) const {
  constexpr double kSame = 1.01;  // rows have three digits
  const auto at = rows_.find({experiment, method, stage});
  if (at == rows_.end()) return {};
  const Row* nearest = nullptr;
  double least = math::log(kReach);
  for (const Row& row : at->second) {
    if (!(row.operations > 0 && operations > 0)) continue;
    const double far = std::abs(math::log(operations / row.operations));
    if (far < least) least = far, nearest = &row;
  }
  if (nearest == nullptr) return {};
  const double by = operations / nearest->operations;
  const TimeRange& t = nearest->time;
  const double wide = least > math::log(kSame) ? kElsewhere : kOthers;
  return TimeRange{by * t.seconds, by * t.least / wide, by * t.most * wide};
}

std::optional<double> Durations::bytes(const std::string& experiment,
                                       const std::string& method,
                                       const std::string& stage,
                                       Index n) const {
  const auto at = rows_.find({experiment, method, stage});
  if (at == rows_.end()) return {};
  std::optional<double> most;
  for (const Row& row : at->second)
    if (row.n == n) most = std::max(most.value_or(0), row.bytes);
  return most;
}

double machine_factor() {
  constexpr Index kSize = 160;
  constexpr int kTimes = 60;
  constexpr double kReference = 1.35e-4;  // seconds
  using Matrix = Batch<float>;
  const Matrix a = Matrix::Constant(kSize, kSize, 0.5F);
  const Matrix b = Matrix::Constant(kSize, kSize, 0.25F);
  Matrix c(kSize, kSize);
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kTimes; ++k) {
    const double begin = now().cpu;
    c.noalias() = a * b;
    volatile float keep = c(0, 0);
    static_cast<void>(keep);
    least = std::min(least, now().cpu - begin);
  }
  // To a step of sqrt(2), so that repeated calls agree.
  return math::exp2(std::round(2 * math::log2(least / kReference)) / 2);
}

}  // namespace physinv
