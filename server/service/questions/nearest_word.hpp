#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace collided::engine::service {

/// The word that was probably meant: the one reached by the fewest letters added, left out, changed or swapped with
/// their neighbour, at most a third of the typed word's length (and at least one); empty if none is that near.
///
/// source  Damerau, "A technique for computer detection and correction of spelling errors", 1964
std::string nearest_word(std::string_view typed, std::span<const std::string> words);

/// Up to `most` words, nearest first, within half of the typed word's length in edits, or within two.
std::vector<std::string> nearest_words(std::string_view typed, std::span<const std::string_view> words,
                                       std::size_t most);

/// "object 'palet' is not in the world (31 objects); nearest names: pallet_01, ..."
std::string unknown_object(std::string_view name, std::span<const std::string_view> others);

/// "; did you mean 'threads'?", or nothing if no word is near.
std::string did_you_mean(std::string_view typed, std::span<const std::string> words);

}  // namespace collided::engine::service
