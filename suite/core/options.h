/// What decides a result, in words. A struct of options lists its fields once,
/// and key, JSON and words are made of that list:
///
///   struct HeatOptions {
///     Index resolution = 64;
///     double end_time = 8;
///
///     auto fields() const {
///       return std::tuple{field("resolution", resolution),
///                         field("end_time", end_time)};
///     }
///   };
///   describe(HeatOptions{})  // {{"resolution", "64"}, {"end_time", "8"}}
///
/// A list that leaves out a member does not compile.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "suite/core/members.h"

namespace physinv {

/// Named options in declared order, as text that round-trips. They enter the
/// record and the content key.
using Options = std::vector<std::pair<std::string, std::string>>;

enum class Precision : std::uint8_t { f32, f64 };

constexpr std::string_view to_string(Precision p) {
  return p == Precision::f32 ? "f32" : "f64";
}

/// The contents of a list: words, and how many members they describe.
template <std::size_t N>
struct Listed {
  static constexpr std::size_t kMembers = N;
  Options words;
  bool at_default = true;  ///< written even at its default
};

template <class O>
concept Listing = requires(const O& o) {
  o.fields();
};

template <Listing O>
Options describe(const O& o);

/// `a`, then `b`.
Options chained(Options a, const Options& b);
/// "a=1 b=2"; of a word without a name, its text.
std::string in_line(const Options& options);
std::string joined(const std::vector<std::string>& texts,
                   std::string_view separator = ",");
/// The shortest text that is read as the same number.
std::string text_of(double number);

/// A number, a name, an enumerator by its `to_string`; of a range or of a
/// struct that lists its fields, all of them with commas.
template <class T>
std::string text_of(const T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    return value ? "true" : "false";
  } else if constexpr (std::is_enum_v<T>) {
    return std::string(to_string(value));
  } else if constexpr (std::is_integral_v<T>) {
    return std::to_string(value);
  } else if constexpr (std::is_convertible_v<T, std::string_view>) {
    return std::string(value);
  } else {
    std::vector<std::string> all;
    if constexpr (Listing<T>) {
      for (auto& [name, text] : describe(value)) all.push_back(text);
    } else {
      for (const auto& entry : value) all.push_back(text_of(entry));
    }
    return joined(all);
  }
}

/// "64-32", "64x64"
template <class T>
std::string text_of(const T& values, std::string_view separator) {
  std::vector<std::string> all;
  for (const auto& value : values) all.push_back(text_of(value));
  return joined(all, separator);
}

/// One word under its name; of what lists its own fields, those. Of a variant
/// what it holds, of an empty optional nothing.
template <class T>
Options describe(std::string_view name, const T& value) {
  return {{std::string(name), text_of(value)}};
}
template <Listing O>
Options describe(std::string_view, const O& o) {
  return describe(o);
}
template <class T>
Options describe(std::string_view name, const std::optional<T>& value) {
  return value ? describe(name, *value) : Options{};
}
template <class... T>
Options describe(std::string_view name, const std::variant<T...>& value) {
  return std::visit([&](const auto& v) { return describe(name, v); }, value);
}

/// A member; several under one name, with commas.
template <class T>
Listed<1> field(std::string_view name, const T& member) {
  return {.words = describe(name, member)};
}
template <class... T>
requires(sizeof...(T) > 1) Listed<sizeof...(T)> field(std::string_view name,
                                                      const T&... each) {
  return {.words = {{std::string(name), joined({text_of(each)...})}}};
}

/// Members as this text; without members, a constant.
template <class... T>
Listed<sizeof...(T)> word(std::string_view name,
                          std::string_view text,
                          const T&...) {
  return {.words = {{std::string(name), std::string(text)}}};
}

/// Not written at its default.
template <std::size_t N>
Listed<N> if_changed(Listed<N> listed) {
  listed.at_default = false;
  return listed;
}

/// Written only where it decides something.
template <std::size_t N>
Listed<N> only_if(bool decides, Listed<N> listed) {
  if (!decides) listed.words.clear();
  return listed;
}

/// Members that are elsewhere in the key, as a stage's name and iterations, or
/// that others name, as functions.
template <class... T>
Listed<sizeof...(T)> implied(const T&...) {
  return {};
}

/// How many members are in a list.
template <class List>
inline constexpr std::size_t kListed = 0;
template <class... L>
inline constexpr std::size_t kListed<std::tuple<L...>> = (std::size_t{0} + ... +
                                                          L::kMembers);

/// The members of `o`, all of which are listed.
template <Listing O>
auto listed_members(O& o) {
  return members<kListed<decltype(o.fields())>>(o);
}

template <Listing O>
Options describe(const O& o) {
  listed_members(o);
  using List = decltype(o.fields());
  [[maybe_unused]] static const List kDefault = O{}.fields();
  const List list = o.fields();
  Options all;
  const auto add = [&](const auto& listed, const auto& by_default) {
    if (listed.at_default || listed.words != by_default.words)
      all = chained(std::move(all), listed.words);
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (add(std::get<I>(list), std::get<I>(kDefault)), ...);
  }
  (std::make_index_sequence<std::tuple_size_v<List>>());
  return all;
}

}  // namespace physinv
