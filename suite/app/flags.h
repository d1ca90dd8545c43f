/// The command line of one verb. CLI11 takes long to compile: only flags.cpp
/// knows it.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "suite/app/verbs.h"

namespace physinv {

/// A flag; if the name has no dashes, an argument that must be there unless it
/// is optional.
struct Flag {
  std::string name, help;
  /// An int is from 1 to 1024, a double positive; a list takes one value each
  /// time its flag is repeated, or all remaining arguments.
  std::variant<bool*, int*, double*, std::string*, std::vector<std::string>*>
      to;
  std::string type = {};  ///< of the value, for the help; empty: by `to`
  bool optional = false;
};

/// UsageError for an empty argument or a flag without the value that its '='
/// promises: a variable of a script that is not set must not choose another
/// action. What follows `--` is for another program.
void refuse_empty(const Arguments& arguments);

/// Parses; prints the help and returns false if that was asked for. Throws
/// UsageError, with the nearest flag for an unknown one.
bool parse(const std::string& verb,
           const std::string& about,
           const std::vector<Flag>& flags,
           const Arguments& arguments);

}  // namespace physinv
