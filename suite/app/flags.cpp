#include "suite/app/flags.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>

#include "suite/harness/select.h"

namespace physinv {
namespace {

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

std::string unknown_flag(const CLI::App& app, const std::string& word) {
  if (!word.starts_with('-'))
    return fmt::format("unexpected argument '{}'; see --help", word);
  const std::string flag = word.substr(0, word.find('='));
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options()) {
    for (const auto& name : option->get_lnames()) known.push_back("--" + name);
  }
  const std::string near = nearest_word(known, flag);
  return near.empty()
             ? fmt::format("unknown flag {}; see --help", flag)
             : fmt::format("unknown flag {}; did you mean {}?", flag, near);
}

/// The whole text as a number in decimal.
template <class T>
std::optional<T> decimal(const std::string& text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && at == end ? std::optional(value)
                                           : std::nullopt;
}

std::string check_positive(const std::string& text) {
  const double value = decimal<double>(text).value_or(0);
  return value > 0 && std::isfinite(value)
             ? ""
             : text + " is not positive and finite";
}

std::string check_count(const std::string& text) {
  constexpr int kMost = 1024;
  const int value = decimal<int>(text).value_or(0);
  // CLI11 reads 010 as 8.
  return value >= 1 && value <= kMost && text[0] != '0'
             ? ""
             : fmt::format("{} is no whole number from 1 to {}", text, kMost);
}

/// Is it `name`, or one of several such as "--resume,!--fresh"?
bool is_switch(const Flag& flag, std::string_view name) {
  if (!std::holds_alternative<bool*>(flag.to)) return false;
  const auto at = flag.name.find(name);
  const auto end = at + name.size();
  return at != std::string::npos && (at == 0 || flag.name[at - 1] == '!') &&
         (end == flag.name.size() || flag.name[end] == ',');
}

/// CLI11 takes any number, and what is not positive for no.
void check_switches(const std::vector<Flag>& flags,
                    const Arguments& arguments) {
  static const std::set<std::string_view> kValues = {
      "true", "false", "1", "0", "yes", "no", "on", "off"};
  for (const std::string_view argument : arguments) {
    const auto at = argument.find('=');
    if (at == 0 || at == std::string_view::npos) continue;
    const auto name = argument.substr(0, at);
    if (kValues.contains(argument.substr(at + 1)) ||
        std::none_of(flags.begin(), flags.end(), [&](const Flag& flag) {
          return is_switch(flag, name);
        }))
      continue;
    throw UsageError(
        fmt::format("{} is neither yes nor no; {}=true or {}=false is",
                    argument,
                    name,
                    name));
  }
}

void add(CLI::App& app, const Flag& flag) {
  CLI::Option* option = std::visit(
      [&](auto* to) {
        if constexpr (std::is_same_v<decltype(to), bool*>) {
          return app.add_flag(flag.name, *to, flag.help);
        } else {
          return app.add_option(flag.name, *to, flag.help);
        }
      },
      flag.to);
  if (!flag.type.empty()) option->type_name(flag.type);
  if (std::holds_alternative<int*>(flag.to)) option->check(check_count);
  if (std::holds_alternative<double*>(flag.to)) option->check(check_positive);
  if (flag.name.starts_with('-')) {
    option->allow_extra_args(false);
  } else {
    option->required();
  }
}

}  // namespace

void refuse_empty(const Arguments& arguments) {
  for (const auto& argument : arguments) {
    if (argument == "--") return;
    if (argument.empty())
      throw UsageError(
          "an argument is empty; leave it out or give it a value (is a "
          "variable "
          "not set?)");
    if (argument.starts_with("--") && argument.find('=') + 1 == argument.size())
      throw UsageError(fmt::format(
          "{} is empty; leave it out or give it a value (is a variable not "
          "set?)",
          argument));
  }
}

bool parse(const std::string& verb,
           const std::string& about,
           const std::vector<Flag>& flags,
           const Arguments& arguments) {
  CLI::App app(about, fmt::format("{} {}", program().name, verb));
  for (const Flag& flag : flags) add(app, flag);
  app.get_formatter()->column_width(26);
  if (arguments == Arguments{"--list-flags"}) {  // for completion
    for (const CLI::Option* option : app.get_options())
      for (const auto& name : option->get_lnames()) fmt::print("--{}\n", name);
    return false;
  }
  check_switches(flags, arguments);
  try {
    app.parse(Arguments(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app.help());
    return false;
  } catch (const CLI::ExtrasError&) {
    throw UsageError(unknown_flag(app, app.remaining().front()));
  } catch (const CLI::ParseError& error) {
    throw UsageError(first_line(error.what()) + "; see --help");
  }
  return true;
}

}  // namespace physinv
