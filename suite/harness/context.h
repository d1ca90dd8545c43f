/// Where and with what a campaign ran, in the shape of Google Benchmark's
/// `context` plus our own keys.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace physinv {

/// Of the environment. One that is empty counts as one that is not set.
std::string variable(const char* name);

/// Processors this process may use.
int available_cores();

/// Machine and build: date, host, processor, caches, load, compiler, flags,
/// versions, revision (revision.h).
nlohmann::json machine_context(const std::string& revision);

/// The build alone, some lines of text for --version.
std::string version_text();

}  // namespace physinv
