/// An update by a power of the stacked Jacobian, by the cheapest path that
/// shows itself accurate enough:
///
///   shortcut   Gauss-Newton, nothing cut: Cholesky (definite_solve.h)
///   gram       one tridiagonalisation of J J^T (spectral_power.h)
///   two_level  some values through J^T U2 (two_level.h)
///   explicit   J itself, QR and SVD (explicit_power.h)
///
/// A path whose error estimate exceeds the tolerance is left for the next
/// one, without its way back from the eigenbasis, and the fall is counted. All
/// settings of one call share what is factored; each gets the bits that it
/// would get alone.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "optimizers/half_inverse/definite_solve.h"
#include "optimizers/half_inverse/explicit_power.h"
#include "optimizers/half_inverse/options.h"
#include "optimizers/half_inverse/spectral_power.h"
#include "optimizers/half_inverse/two_level.h"
#include "suite/core/options.h"

namespace physinv::hig {

enum class Path { shortcut, gram, two_level, explicit_jacobian };

struct HalfInverseReport : PowerReport {
  Path path = Path::gram;
  bool proven = false;  ///< error <= tolerance
  Index abandoned = 0;  ///< decompositions made for it and given up
  bool spared = false;  ///< proven, so that no further path was tried
};

class HalfInverse {
 public:
  using Options = HalfInverseOptions;
  explicit HalfInverse(const Options& options = {}, Threads* threads = nullptr)
      : options_(options), spectral_(threads), two_level_(spectral_, threads) {}
  HalfInverse(const HalfInverse&) = delete;

  /// gram = J J^T (m x m, lower triangle), g (m); `pullback` is J^T. Column i
  /// of `updates` (p x settings) becomes the update of powers[i]; an update
  /// that did not end ok or zero is NaN.
  std::span<const HalfInverseReport> operator()(BatchIn<double> gram,
                                                VectorIn<double> g,
                                                const Pullback& pullback,
                                                std::span<const Power> powers,
                                                BatchOut<double> updates);

  /// Updates by their final path, and attempts that were given up.
  struct Counts {
    std::array<std::int64_t, 4> taken{}, abandoned{};
    std::int64_t unproven = 0;
  };
  const Counts& counts() const { return counts_; }
  /// Of the paths taken as a rule.
  std::size_t bytes() const { return spectral_.bytes() + definite_.bytes(); }

 private:
  bool settled(std::size_t i, Path path, bool last);
  void try_shortcut(BatchIn<double> gram,
                    VectorIn<double> g,
                    const Pullback& pullback,
                    std::span<const Power> powers,
                    BatchOut<double> updates);
  template <class Apply>
  bool attempt(Path path,
               bool last,
               const Pullback& pullback,
               std::span<const Power> powers,
               BatchOut<double> updates,
               Apply&& apply);

  Options options_;
  SpectralPower spectral_;
  TwoLevelPower two_level_;
  ExplicitPower explicit_;
  DefiniteSolve definite_;
  Counts counts_;
  std::vector<HalfInverseReport> reports_;
  std::vector<bool> done_;
  Batch<double> v_, transposed_;
};

}  // namespace physinv::hig
