/// results.json as it is in a directory of results.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "suite/store/record.h"

namespace physinv {

class Catalog;

/// The version of what has `context` and `benchmarks`; 1 if it has none.
int results_version(const nlohmann::ordered_json& results);

/// With a checksum in the context.
nlohmann::ordered_json sealed(nlohmann::ordered_json results);

/// results.json of a directory. Every entry has what exports.h reads, one of an
/// older version a name and times; StoreError if not.
nlohmann::ordered_json read_results(const std::filesystem::path& directory);
/// The same of a file's bytes; `path` is for messages.
nlohmann::ordered_json parse_results(std::string_view bytes,
                                     const std::filesystem::path& path);

/// All cases with their repetitions. results.json, if there is one, is compared
/// with what it is made from: plan, journal, case files and repetitions.
/// StoreError if it says of a stage what they do not. It may be older than they
/// are, as after a kill, and contain runs that others have replaced.
std::vector<CaseRecord> checked_cases(const Catalog& catalog);
/// The same of the entries of `results` alone; `own` is what is made now.
void check_entries(const Catalog& catalog,
                   const nlohmann::ordered_json& results,
                   const nlohmann::ordered_json& own);

}  // namespace physinv
