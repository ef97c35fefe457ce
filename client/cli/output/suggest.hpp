#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace collided::cli {

/// The names nearest to `wrong`, best first, at most `most`: within a third of its letters by edit distance (a swap of
/// neighbours counts as one), or equal once separators (_ - / and zeros that pad a number) are left out.
std::vector<std::string> nearest_names(std::string_view wrong, const std::vector<std::string>& names, std::size_t most);

/// "; did you mean 'ray'?" or nothing.
std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace collided::cli
