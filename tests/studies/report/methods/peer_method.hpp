#pragma once

#include "tests/studies/report/measure.hpp"
#include "tests/studies/report/methods/peer.hpp"

namespace collided::report {
using namespace engine;

/// Adds a peer to the methods of a study, if its program was built and knows the kind of problem.
void add_peer(std::vector<Method>& methods, const Setting& setting, const std::string& program,
              const std::string& option, const std::filesystem::path& problem, const std::string& series,
              const std::string& label);

/// Where the study may put its problem.
std::filesystem::path problem_file(const Setting& setting, const std::string& study);

}  // namespace collided::report
