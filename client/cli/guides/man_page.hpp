#pragma once

#include <string>
#include <string_view>

#include "client/cli/guides/guides.hpp"

// Manual pages in roff, as man(1) shows them (groff_man(7)).
namespace collided::cli {

/// A page's first lines: its title and section, and NAME.
std::string man_head(std::string_view title, int section, std::string_view name, std::string_view purpose);

/// A section's heading.
std::string man_section(std::string_view heading);

/// Text as it is, line by line.
std::string man_as_is(std::string_view text);

/// collided-NAME(7).
std::string man_page(const Guide& guide);

}  // namespace collided::cli
