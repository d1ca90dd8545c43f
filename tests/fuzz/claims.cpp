#include "suite/evidence/claim_document.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void claims(std::string_view bytes) {
  try {
    read_claims(bytes, "claims.md", claim_names());
  } catch (const ClaimDocumentError&) {  // the header says so
  }
}

}  // namespace physinv::fuzz
