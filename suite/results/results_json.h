/// results.json: Google Benchmark's shape, one entry per stage, our own keys
/// under "physinv". Described by reports/schema/results-1.schema.json.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "suite/results/record.h"

namespace physinv {

/// Entries follow `order`, the names of the campaign's cases, and the chain of
/// each case, whenever they finished. Numbers that are not finite are null.
/// `real_time` and `cpu_time` are milliseconds of solving. A context that
/// lacks a key of Google Benchmark's gets it with an empty value.
nlohmann::ordered_json results_json(const std::vector<CaseRecord>& cases,
                                    const std::vector<std::string>& order,
                                    const nlohmann::json& context);

/// As it stands in the file.
std::string results_text(const nlohmann::ordered_json& results);

/// With a checksum in the context.
nlohmann::ordered_json sealed(nlohmann::ordered_json results);

/// results.json of a directory. Every entry has what exports.h reads;
/// StoreError if not.
nlohmann::ordered_json read_results(const std::filesystem::path& directory);
/// The same of a file's bytes; `path` is for messages.
nlohmann::ordered_json parse_results(std::string_view bytes,
                                     const std::filesystem::path& path);

}  // namespace physinv
