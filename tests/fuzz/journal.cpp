#include "suite/store/journal.h"

#include "tests/fuzz/readers.h"
#include "tests/fuzz/sealed.h"

namespace physinv::fuzz {

void journal(std::string_view bytes) {
  const auto path = put("journal.jsonl", sealed_lines(bytes));
  documented([&] {
    const JournalText text = read_journal(path);
    std::set<std::string> names;
    for (std::size_t i = 0; i < text.entries.size(); i += 2)
      names.insert(text.entries[i].info.name);
    forget_cases(path, names);
    read_journal(path);
  });
}

}  // namespace physinv::fuzz
