#pragma once

#include <string>

#include "client/cli/guides/guides.hpp"

namespace collided::cli {

/// A guide as a terminal shows it.
///
/// width   columns, above 0
/// bright  headings and code stand out
std::string guide_page(const Guide& guide, std::size_t width, bool bright);

/// The name of the guide that a link leads to; empty for all other links.
std::string guide_of_link(std::string_view target);

}  // namespace collided::cli
