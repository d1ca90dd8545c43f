/// What a stage's record must be so that it can be stored and read back: one
/// list, to which the harness holds a record before it is stored, and readers
/// after they have read it.
///
///   status, iterations, evaluations    one for each loss
///   x                                  of no more examples than losses
///   curve                              seconds, evaluations, losses and
///                                      estimates at each point
///   status                             of the enumeration
///   iterations, evaluations, and the   finite, not negative
///   curve's iteration, seconds and
///   evaluations
///   loss                               finite if the stage converged
///   x of an example of finite loss     finite unless the stage diverged
///   names of arrays                    1 to 1,000 bytes of UTF-8 without '/'
///                                      and control characters, not "."
///
/// Losses of a stage that ran its iterations or diverged, losses and unknowns
/// along curves, and the numbers of arrays may be anything. A stage that failed
/// or was skipped has no arrays.
#pragma once

#include <cstddef>
#include <string>

#include "suite/store/record.h"

namespace physinv {

/// Which array breaks the list, and how: "status has 3 entries where 4 are
/// expected". Empty for a record that can be stored.
std::string flaw_of(const StageRecord& record);

/// The same of a record yet to be written: its case's file, which holds so many
/// stages, has to be one that is read (kLargestData).
std::string flaw_of_new(const StageRecord& record, std::size_t stages);

/// A stage's message has at most so many bytes, so that journals stay readable.
inline constexpr std::size_t kLongestMessage = std::size_t{1} << 20;

/// The beginning of a longer one, and how much was left out.
std::string bounded_message(std::string message);

}  // namespace physinv
