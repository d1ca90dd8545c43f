/// What a worker process needs for a case, counted without running it.
#pragma once

#include <map>
#include <utility>

#include "suite/harness/case.h"
#include "suite/planning/durations.h"

namespace physinv {

class Memory {
 public:
  /// `published`: of buffers that stages counted themselves.
  explicit Memory(const Durations& published) : published_(published) {}

  /// Peak bytes: of the program; of data, estimates and curves; of a stage's
  /// buffers as published, else of the tapes of its networks for a batch, their
  /// weights and, for rules that ask for them, Jacobians; and of the networks'
  /// tapes for all n samples, which are evaluated at once.
  double of(const Case& c);

 private:
  struct Network {
    double weights = 0;    ///< bytes
    double trained = 0;    ///< of tape and scratch, a sample of a batch
    double evaluated = 0;  ///< of a sample where nothing is learnt
  };
  /// By passes of few samples and of twice as many.
  const Network& network(const Case& c, bool predictor);
  double stage(const Case& c, std::size_t k);

  const Durations& published_;
  std::map<std::pair<const Experiment*, bool>, Network> networks_;
};

}  // namespace physinv
