#include "suite/app/flags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <type_traits>
#include <utility>

#include "suite/app/campaign_file.h"
#include "suite/core/decimal.h"
#include "suite/results/nearest.h"

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
             : fmt::format(
                   "{} is not a whole number from 1 to {}", text, kMost);
}

/// Is it `name`, or one of several such as "--resume,!--fresh"?
bool is_named(const Flag& flag, std::string_view name) {
  const auto at = flag.name.find(name);
  const auto end = at + name.size();
  const auto begins = [&] {
    return at == 0 || flag.name[at - 1] == '!' || flag.name[at - 1] == ',';
  };
  return at != std::string::npos && begins() &&
         (end == flag.name.size() || flag.name[end] == ',');
}

bool is_switch(const Flag& flag, std::string_view name) {
  return std::holds_alternative<bool*>(flag.to) && is_named(flag, name);
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
        fmt::format("{} is not a boolean; expected {}=true or {}=false",
                    argument,
                    name,
                    name));
  }
}

/// What is wrong with values that CLI11 would refuse without their line.
std::string objection(const Flag& flag,
                      const std::vector<std::string>& values) {
  if (std::holds_alternative<std::vector<std::string>*>(flag.to)) return "";
  if (values.size() > 1)
    return fmt::format("takes one value, not {}", values.size());
  if (std::holds_alternative<int*>(flag.to)) return check_count(values[0]);
  if (std::holds_alternative<double*>(flag.to))
    return check_positive(values[0]);
  return "";
}

/// The file of --config as CLI11 asks for it. Its values are checked like the
/// flags of a command line; errors name the line.
class CampaignFile final : public CLI::ConfigBase {
 public:
  CampaignFile(std::string path, const std::vector<Flag>& flags)
      : path_(std::move(path)), flags_(flags) {}

  std::vector<CLI::ConfigItem> from_config(std::istream&) const override {
    std::vector<CLI::ConfigItem> found;
    for (FileFlag& one : read_campaign_file(path_)) {
      const Flag& flag = known(one);
      if (flag.type == "LIST")  // 0,1 on a command line
        one.values = {fmt::format("{}", fmt::join(one.values, ","))};
      check(flag, one);
      CLI::ConfigItem item;
      item.name = one.name;
      item.inputs = one.values;
      found.push_back(std::move(item));
    }
    return found;
  }

 private:
  static std::string dashed(const std::string& name) {
    return (name.size() == 1 ? "-" : "--") + name;
  }

  const Flag& known(const FileFlag& one) const {
    std::vector<std::string> names;
    for (const Flag& flag : flags_) {
      if (!flag.name.starts_with('-') || flag.name == "--config") continue;
      if (is_named(flag, dashed(one.name))) return flag;
      names.push_back(flag.name.substr(flag.name.find("--") + 2));
    }
    const std::string near = nearest_word(names, one.name);
    throw UsageError(fmt::format(
        "{}: unknown key '{}'; {}",
        one.where,
        one.name,
        near.empty() ? "keys are flags without their dashes, see --help"
                     : fmt::format("did you mean {}?", near)));
  }

  void check(const Flag& flag, const FileFlag& one) const {
    const std::string wrong = objection(flag, one.values);
    if (!wrong.empty())
      throw UsageError(fmt::format("{}: {}: {}", one.where, one.name, wrong));
    Arguments as_typed;
    for (const auto& value : one.values)
      as_typed.push_back(fmt::format("{}={}", dashed(one.name), value));
    try {
      check_switches(flags_, as_typed);
    } catch (const UsageError& error) {
      throw UsageError(fmt::format("{}: {}", one.where, error.what()));
    }
  }

  std::string path_;
  const std::vector<Flag>& flags_;
};

/// The file that --config names, "" if none. It has to be one, and of a size
/// that is read.
std::string config_file(const Arguments& arguments) {
  constexpr std::string_view kFlag = "--config";
  std::string path;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& a = arguments[i];
    if (a == "--") break;
    const bool apart = a == kFlag && i + 1 < arguments.size();
    if (!apart && !a.starts_with(std::string(kFlag) + "=")) continue;
    path = apart ? arguments[i + 1] : a.substr(kFlag.size() + 1);
    std::error_code none;
    if (!std::filesystem::is_regular_file(path, none) ||
        std::filesystem::file_size(path, none) > kLongestFile)
      throw UsageError(
          fmt::format("--config={} is not a file of at most {} bytes; expected "
                      "TOML or JSON with flags without their dashes",
                      path,
                      kLongestFile));
  }
  return path;
}

void add(CLI::App& app, const Flag& flag) {
  if (flag.name == "--config") {
    app.set_config(flag.name, "", flag.help)->type_name("FILE");
    app.allow_config_extras(CLI::config_extras_mode::error);
    return;
  }
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
    option->required(!flag.optional);
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
  app.config_formatter(
      std::make_shared<CampaignFile>(config_file(arguments), flags));
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
  for (const Flag& flag : flags)
    if (flag.name == "--config" && app.get_config_ptr()->count() > 0)
      *std::get<std::string*>(flag.to) =
          app.get_config_ptr()->as<std::string>();
  return true;
}

}  // namespace physinv
