/// What a user may have meant: the known names nearest to a word by Levenshtein
/// distance. A word counts by its first 64 characters.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace physinv {

/// Characters to insert, remove or replace until `text` is `word`, or more than
/// `most` if it is. Takes time in proportion to `text`: Myers (1999), in the
/// form of Hyyro (2003), with a column of the table in the bits of a word.
std::size_t edit_distance(std::string_view text,
                          std::string_view word,
                          std::size_t most = 1'000'000);

/// Up to `count` beginnings of names whose last part reads most like
/// `pattern`, best first.
std::vector<std::string> nearest_names(const std::vector<std::string>& names,
                                       std::string_view pattern,
                                       std::size_t count = 3);

/// Up to `count` of `known`, the one that reads most like `word` first.
std::vector<std::string> nearest_words(const std::vector<std::string>& known,
                                       std::string_view word,
                                       std::size_t count = 5);

/// The word of `known` nearest to `word`, empty if none is near.
std::string nearest_word(const std::vector<std::string>& known,
                         std::string_view word);

}  // namespace physinv
