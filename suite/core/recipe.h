/// Recipes: how to make a problem in either precision, with the options that
/// define it; of networks, network.h. Registering stores recipes and runs
/// nothing.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "suite/core/options.h"
#include "suite/core/problem.h"
#include "suite/core/quantities.h"

namespace physinv {

/// Makes one problem of one configuration, in float and in double.
struct ProblemRecipe {
  std::string name;
  Options options;
  Needs provided = Needs::forward;
  std::function<std::unique_ptr<Problem<float>>()> make_float;
  std::function<std::unique_ptr<Problem<double>>()> make_double;
  std::string source;  ///< its header, relative to the project's root
  Quantities quantities = {};

  template <class T>
  std::unique_ptr<Problem<T>> make() const {
    if constexpr (std::is_same_v<T, float>) {
      return make_float();
    } else {
      return make_double();
    }
  }
};

/// problems::heat(options, quantities): reads abilities from the
/// base-class list. The name is that of the problem's folder.
template <template <class> class P, class Options>
ProblemRecipe problem(const std::string& name,
                      const Options& options,
                      Quantities quantities) {
  return {
      .name = name,
      .options = describe(options),
      .provided = provides<P<double>, double>(),
      .make_float = [options] { return std::make_unique<P<float>>(options); },
      .make_double = [options] { return std::make_unique<P<double>>(options); },
      .source = "problems/" + name + '/' + name + ".h",
      .quantities = std::move(quantities)};
}
template <template <class> class P>
ProblemRecipe problem(const std::string& name,
                      const typename P<double>::Options& options = {}) {
  return problem<P>(name, options, {});
}

}  // namespace physinv
