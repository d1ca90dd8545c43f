/// Campaigns that are made up from the records of the smoke profile: every case
/// of all profiles, with its numbers drawn again around those that were run.
#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "suite/harness/case.h"

namespace physinv::test {

/// The same numbers from the same seed on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed);

  double uniform() { return 0x1p-53 * static_cast<double>(engine_() >> 11); }
  double uniform(double low, double high) {
    return low + (high - low) * uniform();
  }
  /// One of a few thousand.
  double normal() { return normals_[engine_() % normals_.size()]; }
  /// A factor of so many decades: their normals are exponentiated once.
  double decades(double width);
  bool chance(double p) { return uniform() < p; }
  std::size_t below(std::size_t n) { return engine_() % n; }

 private:
  std::mt19937_64 engine_;
  std::vector<double> normals_;
  std::map<double, std::vector<double>> decades_;
};

/// Where something was measured: no measurement.
bool is_axis(const std::string& name);

using Cases = std::vector<CaseRecord>;

/// Records of the smoke profile, by experiment and method: of the largest sets.
class Models {
 public:
  explicit Models(const Results& smoke);

  /// Of the method, else of one that begins with the same stages, or has them
  /// all, of the experiment or of its variants, or of what it varies; null.
  const CaseRecord* of(const CaseInfo& info) const;

 private:
  std::map<std::pair<std::string, std::string>, CaseRecord> models_;
};

/// A case as its profiles have it, of different lengths, the longest last.
using Variants = std::vector<Case>;

/// All profiles but the smallest, every case by its name, by experiment.
std::map<std::string, std::vector<Variants>> all_cases();

/// One campaign: of those that have a model, the longest in every second draw,
/// the others in turn. How far numbers are thrown from the model's is drawn for
/// each method.
Cases draw(const std::vector<const Variants*>& of,
           std::size_t number,
           const Models& models,
           Dice& dice);

}  // namespace physinv::test
