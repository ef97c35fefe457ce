#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace collided::cli {

/// Prepares arguments for the option parser. Replaces `@file` by the words of that file; joins the numbers after an
/// option that takes a vector (`--at 0 0 -1`) by commas; and marks tokens that are numbers, so that the parser does not
/// take `-.5` for an option. Everything after `--` is only marked.
std::vector<std::string> prepare_tokens(const std::vector<std::string>& arguments);

/// A token without its mark, as the user wrote it.
std::string unmarked(std::string token);

/// Splits a line into words. Blanks separate them, except in quotes (' or "); a backslash makes the next character an
/// ordinary one; # begins a comment. Throws Failure for an open quote.
std::vector<std::string> split_words(std::string_view line);

}  // namespace collided::cli
