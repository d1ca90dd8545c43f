/// Methods: chains of named stages. A stage is the unit of record, resume and
/// reuse; what it produces is all that a later stage may see of it.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "suite/core/arrays.h"
#include "suite/core/checkpoint.h"
#include "suite/core/network.h"
#include "suite/core/options.h"
#include "suite/core/problem.h"
#include "suite/core/stop.h"

namespace physinv {

class Oracle;
class Probe;

/// A part of a network's input, row blocks stacked in the order listed.
enum class Field : std::uint8_t { unknowns, given, observations };

/// A network in its place: what it reads, what it is.
struct NetworkRole {
  std::vector<Field> inputs;
  NetworkRecipe recipe;
};

/// Networks of the setting that a stage may use; the others are empty to it.
enum class Networks : std::uint8_t {
  none = 0,
  predictor = 1,
  surrogate = 2,
  both = 3
};

constexpr bool contains(Networks all, Networks part) {
  return (static_cast<int>(all) & static_cast<int>(part)) != 0;
}

/// Sources that a stage's numbers come from, in addition to its problem and
/// networks: editing one of them, or what they include, makes the stage stale.
struct Sources {
  /// Relative to the project's root, or as the compiler names them.
  std::vector<std::string> roots;
  UnusedIncludes unused;
};

/// What the output o of a network means as an estimate of the unknowns:
///
///   linear                x = start + scale o
///   box                   x = start + scale tanh(o)
///   mean_of_observations  x = scale (o - mean o) + mean y
///
/// with means over the numbers of one sample.
enum class OutputForm : std::uint8_t { linear, box, mean_of_observations };

/// How networks learn from labelled samples.
struct Labelling {
  /// More than one: batches of as many as there are problems, in a new order
  /// every pass; normalisation ends with the statistics of the set.
  Index per_problem = 1;
  /// The first so many unknowns are learnt, and shown to surrogates, as tanh x.
  Index bounded = 0;
};

/// Everything an experiment fixes for its methods.
struct Setting {
  NetworkRole predictor;  ///< estimates x, from its output by `output_form`
  NetworkRole surrogate;  ///< estimates y
  double output_scale = 1.0;
  OutputForm output_form = OutputForm::linear;
  double gtol = 1e-5;  ///< of BFGS and gradient descent
  Labelling labels = {};
  /// Examples whose estimates and curves are recorded, 0 for all. Every
  /// example's final loss is.
  Index recorded = 0;
};

/// What a stage leaves for the next one and for the record.
struct Outcome {
  Batch<double> x;             ///< estimate per example
  std::vector<Status> status;  ///< how each example ended
  Vector<double> iterations;   ///< per example
  Vector<double> evaluations;  ///< per example, as the algorithm is written
  Stop stop = Stop::iterations;
  std::string message;
  /// Whatever else the stage found, by name; `parameters` of a network is
  /// what a later stage of the chain picks up.
  Arrays arrays;
  std::size_t bytes = 0;  ///< peak bytes of the stage's own buffers
};

/// What a stage may see while it runs.
struct StageRun {
  Oracle& oracle;
  Probe& probe;
  const Setting& setting;
  const Outcome* previous;  ///< of the stage before, null for the first
  Rng network_init;         ///< stream of initial weights, same for all methods
  Rng batches;              ///< stream of batch order, same for all methods
  Rng method;               ///< stream of this method alone
  Index iterations;
  Precision precision;
  Threads* threads;
  Checkpoint* checkpoint = nullptr;  ///< for stages that save their state
};

/// Size of a case, for estimates of work.
struct CaseSize {
  Index n, iterations;
  Shape shape;
  double problem_operations, predictor_operations, surrogate_operations;
};

class Stage {
 public:
  /// `source`: the file of the constructor that calls this one. Classes between
  /// Stage and a stage pass on their derived class's.
  explicit Stage(const char* source = __builtin_FILE()) : source_(source) {}
  virtual ~Stage() = default;
  virtual std::string name() const = 0;
  virtual Needs needs() const = 0;
  /// Options that decide the result, for the record and the content key.
  virtual Options options() const = 0;
  /// Iterations when the row names none, or for a stage whose number the row
  /// does not set.
  virtual Index default_iterations() const = 0;
  virtual bool takes_row_iterations() const { return true; }
  /// True if float and double differ.
  virtual bool has_precision() const { return false; }
  virtual Networks networks() const { return Networks::both; }
  /// The file of the class, and what else its options bring in.
  virtual Sources sources() const { return {.roots = {source_}, .unused = {}}; }
  /// Estimated floating-point operations, for the ETA.
  virtual double operations(const CaseSize& size) const = 0;
  virtual Outcome run(StageRun& run) const = 0;

 private:
  std::string source_;
};

struct Method {
  std::string id;  ///< in [a-z0-9_-]
  std::vector<std::shared_ptr<const Stage>> chain;

  Needs needs() const {
    Needs all = Needs::forward;
    for (const auto& stage : chain) all = all | stage->needs();
    return all;
  }
};

}  // namespace physinv
