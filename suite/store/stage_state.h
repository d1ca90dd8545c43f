/// The state of a running stage, in a file of a campaign's directory:
///
///   checkpoints/<content key>   <8 hexadecimal digits: CRC-32C of the rest>
///                               <compact JSON>\n<bytes>
///
/// Written by the process that runs the stage, deleted once its record is
/// there.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "suite/core/batch.h"
#include "suite/store/thread_log.h"

namespace physinv {

struct StageState {
  std::string case_name, stage;
  Index iteration = 0;
  std::string bytes;       ///< as the stage's Archive has them
  ThreadLog threads = {};  ///< that it ran with until there
};

/// On disk when it returns, in place of what was there.
void write_state(const std::filesystem::path& store,
                 const std::string& key,
                 const StageState& state);

/// Nothing if there is none; StoreError if it is damaged.
std::optional<StageState> read_state(const std::filesystem::path& store,
                                     const std::string& key);
/// The same of a file's bytes; `path` is for messages.
StageState parse_state(std::string_view bytes,
                       const std::filesystem::path& path);

/// Nothing is done if there is none.
void remove_state(const std::filesystem::path& store, const std::string& key);

}  // namespace physinv
