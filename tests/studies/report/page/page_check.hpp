#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace collided::report {

/// What is wrong with a written report, one line each: a figure of the contents that is not on the page, a drawing that
/// is not well-formed XML or shows nothing, a row whose error is beyond its bound.
std::vector<std::string> page_complaints(const std::filesystem::path& folder);

/// Empty if every tag is closed in order, every attribute quoted once, every & an entity; else what is wrong first.
std::string xml_fault(std::string_view xml);

}  // namespace collided::report
