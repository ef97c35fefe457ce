#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace collided::cli {

/// Up to `most` names similar to `wrong`, best first: those within an edit distance of a third of its letters, where
/// swapping two neighbours counts as one edit, and those equal without separators (_ - / and zeros that pad a number).
std::vector<std::string> nearest_names(std::string_view wrong, const std::vector<std::string>& names, std::size_t most);

/// "; did you mean 'ray'?", or empty if no name is similar.
std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace collided::cli
