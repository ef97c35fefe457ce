#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace collided::cli {

/// The one pass ahead of the option parser. `@file` is replaced by the words of that file; after an option that takes a
/// vector (`--at 0 0 -1`) its numbers are joined by commas; and tokens that are numbers are marked, so that the option
/// parser never takes `-.5` for an option. Everything after `--` is left alone but marked.
std::vector<std::string> prepare_tokens(const std::vector<std::string>& arguments);

/// The token as the user wrote it.
std::string unmarked(std::string token);

/// Words of a line: blanks separate, quotes (' and ") keep them, backslash takes the next character, # starts a comment.
/// Throws Failure on an open quote.
std::vector<std::string> split_words(std::string_view line);

}  // namespace collided::cli
