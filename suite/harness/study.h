/// Studies: experiments of their own that vary one choice which a paper leaves
/// open, or two, with a method for each setting.
///
///   register_study("studies/billiards-precision", "jpo/billiards");
///
/// All settings see what the experiment that is varied sees: the random streams
/// of data, network starts and batches depend on its name, and a stage of equal
/// options has its content key, so that what it ran is reused.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "suite/core/rng.h"

namespace physinv {

/// Printed once for each study, before its cases run; returns true.
bool register_study(const std::string& study, const std::string& varied);

/// The experiment on whose name the streams of this one hang: what it varies,
/// else itself.
const std::string& streams_of(const std::string& experiment);

/// Of all streams of a case of this experiment.
Rng root_of(const std::string& experiment, std::uint64_t seed);

/// What each study varies.
const std::map<std::string, std::string>& studies();

}  // namespace physinv
