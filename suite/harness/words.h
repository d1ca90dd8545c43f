/// Filters as people type them. A word, such as `billiards`, names parts of
/// case names; anything else is a regular expression.
///
///   billiards              jpo/billiards/..., not matrix/billiards/...
///   numerics               numerics/..., as no paper's case has such a part
///   matrix/billiards       a slash: a regular expression, as it stands
///   -adam                  takes out adam, leaves adam-b16
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "suite/harness/case.h"

namespace physinv {

/// Letters, digits, '_', '-' and '=' behind a letter or digit.
bool is_plain_word(std::string_view text);

/// Is it one of a paper's experiments, jpo/... of the paper jpo?
bool is_of_paper(const Experiment& experiment);

/// The regular expressions (NameFilter) that stand for these filters among
/// these cases. A word becomes the first of these that matches a case: a whole
/// part of a name of a paper's experiment, a whole part of any name, anywhere
/// in a name of a paper's experiment, anywhere. With `all`, papers do not go
/// first. A word that takes out (`-word`) does so in all experiments, whole
/// parts if there are any. What chooses the same either way stays as it was
/// typed, as does a word that matches nothing.
std::vector<std::string> expressions_of(const std::vector<std::string>& filters,
                                        const std::vector<Case>& cases,
                                        bool all = false);

}  // namespace physinv
