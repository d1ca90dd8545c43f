/// A case's own numbers in addition to its losses, at every point of the curve.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "suite/core/method.h"

namespace physinv {

/// The network and its estimates at a point of the curve.
struct Snapshot {
  Index iteration;
  VectorIn<double> parameters;  ///< empty where there is no network
  BatchIn<double> x, y;
  const Oracle& oracle;
};

struct Metrics {
  std::string name;  ///< enters the content key; empty: none
  std::vector<std::string> rows;
  std::function<void(const Snapshot&, VectorOut<double>)> evaluate;
  /// The file that says what they are: one without claims and figures, as an
  /// edit of it makes the stages that record them stale.
  const char* source = __builtin_FILE();

  void add_to(Sources& sources) const {
    if (!name.empty()) sources.roots.emplace_back(source);
  }
  auto fields() const {
    return std::tuple{field("metrics", name), implied(rows, evaluate, source)};
  }
};

/// Evaluates them as a stage runs.
class MetricsRecorder {
 public:
  MetricsRecorder(const Metrics& metrics, const StageRun& run);

  bool empty() const { return values_.rows() == 0; }
  /// The present estimates x (n columns), and y(x).
  void operator()(VectorIn<double> parameters,
                  BatchIn<double> x,
                  BatchIn<double> y);
  void serialize(Archive& archive) { archive(values_); }
  /// Rows x points of the curve.
  const Batch<double>& values() const { return values_; }

 private:
  const Metrics& metrics_;
  const StageRun& run_;
  Batch<double> values_;
};

/// Numbers taken one by one, as an array of a record: 1 x as many.
Batch<double> as_row(const std::vector<double>& values);

/// Arrays of records hold finite numbers only: what is not becomes the largest
/// double.
void keep_finite(Arrays& arrays);

}  // namespace physinv
