#pragma once

#include <filesystem>
#include <string>

namespace collided::report {

/// Keeps of a report's rows those that the guide to accuracy shows, with machine, commit, seed and command.
void write_prices(const std::filesystem::path& rows, const std::filesystem::path& prices);

/// The guide's part between its markers, as Markdown.
std::string readme_part(const std::filesystem::path& pairs, const std::filesystem::path& prices);

}  // namespace collided::report
