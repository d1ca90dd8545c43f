/// What was built on the installed suite: programs and plug-ins with sources of
/// their own. physinv_add_program and physinv_add_plugin write such an
/// `Outside`, which registers itself, from the files at every build.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "suite/harness/build_info.h"

namespace physinv {

struct Outside {
  std::string_view name;     ///< of the program or plug-in
  std::string_view project;  ///< what the paths of its sources begin with
  std::string_view root;     ///< where the project's sources were built
  std::string_view data;     ///< of the installed suite: published numbers
  std::string_view build;    ///< of the suite that it was built with
  bool plugin = false;
  std::span<const SourceFile> sources;
  /// Of the compiled ones those that include nothing but sources of numbers:
  /// each must be what some stage's numbers come from.
  std::span<const std::string_view> computing;
};

/// For static initialisation; returns true.
bool register_outside(const Outside& outside);

/// In the order of their registration.
const std::vector<Outside>& outsides();

/// The program that runs, null for the suite's own.
const Outside* outside_program();

/// What is wrong with the sources of all of them, one line each: one file in
/// two states.
std::vector<std::string> outside_problems();

}  // namespace physinv
