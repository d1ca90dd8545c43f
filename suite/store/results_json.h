/// results.json: Google Benchmark's shape, one entry per stage, our own keys
/// under "physinv". Described by reports/schema/results-2.schema.json.
///
/// A stage that failed, was skipped or diverged has `error_occurred` and
/// `error_message` and no time, losses or counters, so that they are not taken
/// for a gain.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "suite/store/record.h"

namespace physinv {

/// Version 1 had times in milliseconds, and of 0 where a stage failed.
inline constexpr int kResultsVersion = 2;

/// Entries follow `order`, the names of the campaign's cases, and the chain of
/// each case, whenever they finished. Numbers that are not finite are null.
/// `real_time` and `cpu_time` are nanoseconds of solving, the median where it
/// was repeated. A context that lacks a key of Google Benchmark's gets it with
/// an empty value.
nlohmann::ordered_json results_json(const std::vector<CaseRecord>& cases,
                                    const std::vector<std::string>& order,
                                    const nlohmann::json& context);

/// An entry without any number.
nlohmann::ordered_json error_entry(const std::string& name,
                                   const std::string& message);

/// Of the times of an entry: earlier programs tell milliseconds.
double seconds_per_unit(const nlohmann::ordered_json& entry);

/// As it is in the file.
std::string results_text(const nlohmann::ordered_json& results);

}  // namespace physinv
