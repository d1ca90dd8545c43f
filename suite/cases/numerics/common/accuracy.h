/// Work against precision: what every parameter of a problem does to its error
/// and to its time, in double and in float, forward pass, gradient and, where
/// there is one, inverse (suite/diagnostics/work_precision.h). A problem enters
/// by saying what can be turned.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "suite/cases/numerics/common/sweep_axis.h"
#include "suite/diagnostics/work_precision.h"
#include "suite/evidence/claim.h"
#include "suite/harness/case.h"

namespace physinv {

struct NumericalParameter {
  std::string id;     ///< of its stages, table and figure: "steps"
  std::string title;  ///< "Time steps"
  SweepAxis axis;     ///< values from coarse to fine
  /// One per value of the axis, or one for all of them.
  std::vector<ProblemRecipe> problems;
  /// What is right: the finest setting, or a closed form.
  ProblemRecipe reference = {};
  ClosedForm exact = {};
  /// The error's power of the axis' value in theory, 0 for none, and the first
  /// value (from 0) from which on it is expected.
  double order = 0;
  std::size_t regime = 1;
  Index samples = 0;    ///< 0: the row's n
  bool blocks = false;  ///< the value is how many samples a call gets
  Index repetitions = 10;
};

/// Samples per call from 1 to all of them: what batches are worth.
NumericalParameter batch_parameter(ProblemRecipe problem,
                                   Index samples,
                                   ProblemRecipe reference,
                                   ClosedForm exact = {});

/// Makes an experiment's parameters known to the reports; returns those kept.
/// For static initialisation.
const std::vector<NumericalParameter>& declare_parameters(
    const std::string& experiment, std::vector<NumericalParameter> parameters);
/// By experiment.
const std::map<std::string, std::vector<NumericalParameter>>& all_parameters();

inline constexpr const char* kAccuracy = "work-precision";

/// A stage for the forward passes of each value, one for the gradients, one for
/// the inverses if all settings have one.
Method accuracy_method(const std::vector<NumericalParameter>& parameters);
/// In double and in float.
std::vector<Row> accuracy_rows(Index n);

/// One setting of a parameter as measured: median error of the samples, seconds
/// per sample of the fastest repetition.
struct Measurement {
  std::string parameter, setting;  ///< "time step 0.25, float"
  std::size_t place = 0;           ///< on the parameter's axis
  Precision precision = Precision::f64;
  WorkOf of = WorkOf::forward;
  double error = -1;  ///< -1: half of the samples or more are not finite
  std::optional<double> order = {};  ///< from the value before
  double seconds = 0;
};

std::vector<Measurement> measurements(const Evidence& e);

/// The fastest of all (or of one parameter) with at most this error; null if
/// there is none.
const Measurement* fastest_within(const std::vector<Measurement>& all,
                                  WorkOf of,
                                  double error,
                                  const std::string& parameter = {});

/// The fastest of the same parameter that is at least as accurate and takes
/// less than nine tenths of the time; null for a setting that nothing beats.
const Measurement* dominated_by(const std::vector<Measurement>& all,
                                const Measurement& one);

/// A table of all settings and a figure of each parameter, if parameters were
/// declared.
void add_accuracy(Section& section, const Evidence& e);

/// Where theory knows an order: that observed in double, within 15 %.
std::vector<Claim> order_claims(
    const std::vector<NumericalParameter>& parameters);

}  // namespace physinv
