/// What the names in claims.md mean: numbers, runs, values of a run, functions.
///
///   ClaimNames names = claim_names();  // median, loss_after, least, ...
///   names.set("close", 1e-2);                                  // a value
///   names.add("later", [](double t) { return loss_after(t); });  // a function
///
/// Functions take and return C++ types. A call takes the first function of its
/// name whose parameters its arguments are, or become: a number becomes an
/// integer or a quantity, text becomes the runs of that method or the array of
/// that name, a list becomes a vector.
#pragma once

#include <any>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

#include "suite/core/arrays.h"
#include "suite/evidence/condition.h"

namespace physinv {

using ClaimValue = std::any;
using ClaimList = std::vector<ClaimValue>;
/// A function that makes the conditions of a line from its label.
using Labelled = std::function<std::vector<Condition>(const std::string&)>;

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

/// Of array_table.h. Throws std::logic_error.
ArrayKey array_named(const std::string& name);

/// Empty if the value is not a T and does not become one.
template <class T>
std::optional<T> claim_value_as(const ClaimValue& value) {
  if constexpr (std::same_as<T, ClaimValue>) return value;
  if (const T* same = std::any_cast<T>(&value)) return *same;
  const auto* number = std::any_cast<double>(&value);
  const auto* text = std::any_cast<std::string>(&value);
  if constexpr (std::integral<T>)
    if (number != nullptr && std::trunc(*number) == *number &&
        std::abs(*number) < 1e15)
      return static_cast<T>(*number);
  if constexpr (std::same_as<T, Quantity>)
    if (number != nullptr) return Quantity(*number);
  if constexpr (std::same_as<T, Select>)
    if (text != nullptr) return Select{*text};
  if constexpr (std::same_as<T, ArrayKey>)
    if (text != nullptr) return array_named(*text);
  if constexpr (IsVector<T>::value)
    if (const auto* list = std::any_cast<ClaimList>(&value)) {
      T all;
      for (const ClaimValue& one : *list) {
        auto item = claim_value_as<typename T::value_type>(one);
        if (!item) return {};
        all.push_back(std::move(*item));
      }
      return all;
    }
  return {};
}

class ClaimNames {
 public:
  struct Call {
    const ClaimList& arguments;
    const ClaimNames& names;
    int depth;        ///< of calls within functions that a document defines
    int& calls_left;  ///< so that no document takes forever
  };
  struct Function {
    std::vector<std::type_index> parameters;
    /// Empty if an argument does not become what its parameter is.
    std::function<std::optional<ClaimValue>(const Call&)> call;
  };

  /// Another function of this name, with other parameters.
  template <class F>
  void add(const std::string& name, F function) {
    add_function(name, std::function{std::move(function)});
  }
  void add(const std::string& name, Function function) {
    functions_[name].push_back(std::move(function));
  }

  /// A value: numbers are double; what takes a run is a value of a run, or of
  /// each of its examples.
  template <class T>
  void set(const std::string& name, T meaning) {
    if constexpr (std::is_arithmetic_v<T>)
      values_[name] = static_cast<double>(meaning);
    else if constexpr (std::convertible_to<T, std::string>)
      values_[name] = std::string(std::move(meaning));
    else if constexpr (std::convertible_to<T, RunRow>)
      values_[name] = RunRow(std::move(meaning));
    else if constexpr (std::convertible_to<T, RunValue>)
      values_[name] = RunValue(std::move(meaning));
    else
      values_[name] = std::move(meaning);
  }

  /// Null if there is none.
  const ClaimValue* value(const std::string& name) const;
  const std::vector<Function>* functions(const std::string& name) const;
  std::vector<std::string> all() const;

 private:
  template <class R, class... P>
  void add_function(const std::string& name, std::function<R(P...)> f) {
    static_assert((!std::same_as<std::decay_t<P>, Run> && ...),
                  "of a run: a value, for set()");
    const auto with =
        [f = std::move(f)](const Call& call) -> std::optional<ClaimValue> {
      return [&]<std::size_t... I>(std::index_sequence<I...>)
          ->std::optional<ClaimValue> {
        std::tuple<std::optional<std::decay_t<P>>...> as{
            claim_value_as<std::decay_t<P>>(call.arguments[I])...};
        if (!(std::get<I>(as) && ...)) return {};
        return ClaimValue(f(std::move(*std::get<I>(as))...));
      }
      (std::index_sequence_for<P...>{});
    };
    add(name, Function{{typeid(std::decay_t<P>)...}, with});
  }

  std::map<std::string, ClaimValue> values_;
  std::map<std::string, std::vector<Function>> functions_;
};

/// Those that every experiment's claims may use; docs/claims.md lists them.
ClaimNames claim_names();

/// "a number", "runs", "a value of a run"; whatever else "a value".
std::string kind_of(std::type_index type);

}  // namespace physinv
