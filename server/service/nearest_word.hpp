#pragma once

#include <span>
#include <string>
#include <string_view>

namespace collided::service {

/// The word that was probably meant: the one reached by the fewest letters added, left out, changed or swapped with
/// their neighbour, at most a third of the word's length; empty where none is that near.
///
/// source  Damerau, "A technique for computer detection and correction of spelling errors", 1964
std::string nearest_word(std::string_view typed, std::span<const std::string> words);

/// "; did you mean 'threads'?" or nothing.
std::string did_you_mean(std::string_view typed, std::span<const std::string> words);

}  // namespace collided::service
