/// Records as JSON, and as bytes for a pipe.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "suite/results/record.h"

namespace physinv {

/// Version of journal, case files and results.json together. Readers refuse
/// what is newer.
inline constexpr int kSchemaVersion = 1;

/// All scalars of a stage; its arrays stay behind. Doubles round-trip.
nlohmann::json to_json(const StageRecord& record);
StageRecord stage_from_json(const nlohmann::json& json);

nlohmann::json to_json(const CaseInfo& info);
CaseInfo case_from_json(const nlohmann::json& json);

/// A whole record, arrays included, bit by bit (MessagePack). `from_wire`
/// throws std::exception if the bytes are not from `to_wire`.
std::vector<std::uint8_t> to_wire(const StageRecord& record);
StageRecord from_wire(std::span<const std::uint8_t> bytes);

}  // namespace physinv
