#pragma once

#include <filesystem>
#include <vector>

#include "tests/studies/growth/law.hpp"
#include "tests/studies/report/page/page.hpp"

namespace collided::growth {

/// A plot of each knob, with all that grows with it, and the table.
std::vector<report::Figure> growth_figures(const std::vector<Law>& laws);

/// One row a sample.
void write_samples(const std::filesystem::path& file, const std::vector<Law>& laws, const report::Provenance& from);

}  // namespace collided::growth
