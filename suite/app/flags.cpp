#include "suite/app/flags.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cmath>
#include <cstdlib>
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

std::string check_positive(const std::string& text) {
  const double value = std::atof(text.c_str());
  return value > 0 && std::isfinite(value)
             ? ""
             : text + " is not positive and finite";
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
  if (std::holds_alternative<int*>(flag.to)) option->check(CLI::Range(1, 1024));
  if (std::holds_alternative<double*>(flag.to)) option->check(check_positive);
  if (flag.name.starts_with('-')) {
    option->allow_extra_args(false);
  } else {
    option->required();
  }
}

}  // namespace

bool parse(const std::string& program,
           const std::string& about,
           const std::vector<Flag>& flags,
           const Arguments& arguments) {
  CLI::App app(about, program);
  for (const Flag& flag : flags) add(app, flag);
  app.get_formatter()->column_width(26);
  if (arguments == Arguments{"--list-flags"}) {  // for completion
    for (const CLI::Option* option : app.get_options())
      for (const auto& name : option->get_lnames()) fmt::print("--{}\n", name);
    return false;
  }
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
