/// Claims as a Markdown document, claims.md in the folder of an experiment:
///
///   # sip/exponential
///   What precedes the first claim is for readers.
///
///   ```claims
///   end(m) = median(m, last_loss())
///   ```
///
///   ## P2 (App. C.2) from quick
///   Adam converges very slowly
///
///   - share of the error left: `lowest("adam", share_left(mean)) > 0.1`
///   - end, Adam over SGD: `end("adam") / end("sgd") in 0.5 .. 2`
///     or the other way round: `end("sgd") / end("adam") > 2`
///   - `table4("jpo", 4)`
///
///   Note: How it is read.
///
///   Weaker: The same direction, with both numbers.
///
///   - share left: `lowest("adam", share_left(mean)) > 0.05`
///
/// "# sip/fluid, sip/fluid-timed" begins claims that each of these experiments
/// has. The heading of a claim has its id, its place in the paper (without one,
/// the claim is a range of the suite), the lowest profile that decides it, and
/// "no gate" where it gates nothing. A line of a list is a condition; without a
/// relation its number is reported. A line continues where the next ones are
/// indented. The label finds numbers that were kept; a text that is to be shown
/// instead comes before it: "- text (kept as label): `...`".
///
/// Relations: > >= < <=, `in a .. b`, `= a`, `= a +- b`, `near a`, `about a`,
/// `as printed("name", seeds)`, `as stated(a, seeds)`, each perhaps followed by
/// `of stages`; condition.h says what they are. Causes: Fails, Stronger,
/// Weaker, Depends, Contradiction, Not run, Reported (claim.h); numbers in
/// their text are in braces (cause_numbers.h).
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "suite/evidence/claim.h"
#include "suite/evidence/claim_names.h"

namespace physinv {

/// "claims.md:12:7: there is no 'medin'; did you mean median?"
struct ClaimDocumentError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ClaimsOfExperiment {
  std::string experiment;
  std::vector<Claim> claims;
};

/// In the order of the document; of one experiment alone, if one is named.
/// `file` is for messages. Throws ClaimDocumentError.
std::vector<ClaimsOfExperiment> read_claims(std::string_view text,
                                            const std::string& file,
                                            ClaimNames names,
                                            std::string_view experiment = "");

}  // namespace physinv
