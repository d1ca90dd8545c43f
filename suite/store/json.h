/// Records as JSON, and as bytes for a pipe.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "suite/store/record.h"

namespace physinv {

/// Version of journal, case files and results.json together. Readers refuse
/// what is newer.
inline constexpr int kSchemaVersion = 1;

/// What a file holds. Throws std::exception for what is not JSON, or nested
/// deeper than anything the suite writes.
template <class Json = nlohmann::json>
Json parse_json(std::string_view text);

/// CRC-32C of a document, compact, its own "checksum" left out.
template <class Json>
std::string checksum_of(Json document);
/// Its "checksum", if it has one, is that: what was written without has none.
template <class Json>
bool is_intact(const Json& document);

/// A whole number; std::runtime_error for anything else.
std::int64_t whole(const nlohmann::json& json);

/// Wall and CPU time, both finite and not negative.
nlohmann::json to_json(Seconds seconds);
Seconds seconds_from_json(const nlohmann::json& json);

/// Counters by their names. One that was not counted is left out; read, one
/// that is not there was not counted.
template <class Json>
void add_counts(Json& object, const Counts& counts);
Counts counts_from_json(const nlohmann::json& object);

/// All scalars of a stage; its arrays stay behind. Doubles round-trip.
/// `_from_json` throw std::exception for what `to_json` does not write.
nlohmann::json to_json(const StageRecord& record);
StageRecord stage_from_json(const nlohmann::json& json);

nlohmann::json to_json(const CaseInfo& info);
CaseInfo case_from_json(const nlohmann::json& json);

/// A whole record, arrays included, bit by bit (MessagePack). `from_wire`
/// throws std::exception if the bytes are not from `to_wire`.
std::vector<std::uint8_t> to_wire(const StageRecord& record);
StageRecord from_wire(std::span<const std::uint8_t> bytes);

}  // namespace physinv
