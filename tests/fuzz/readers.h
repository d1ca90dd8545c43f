/// The readers that fuzzers feed, each over bytes that stand for what it reads.
///
/// Where a reader checks a checksum, one of zeros is made right first, so that
/// what follows it is reached, too.
///
/// They return, whatever the bytes are: an exception, a crash, a hang or too
/// much memory is a finding.
#pragma once

#include <string_view>

namespace physinv::fuzz {

void baseline(std::string_view bytes);
void cache(std::string_view bytes);
void case_list(std::string_view bytes);
void checkpoint(std::string_view bytes);
void claims(std::string_view bytes);
void command_line(std::string_view bytes);
void config(std::string_view bytes);
void digest(std::string_view bytes);
void hdf5(std::string_view bytes);
void journal(std::string_view bytes);
void plan(std::string_view bytes);
void published(std::string_view bytes);
void repetitions(std::string_view bytes);
void results(std::string_view bytes);
void store(std::string_view bytes);
void submission(std::string_view bytes);

}  // namespace physinv::fuzz
