#pragma once

#include <string>

namespace collided::engine {

/// A program of ours that is run as a process of its own.
struct HelperProgram {
  std::string path;     // empty where there is none
  std::string why_not;  // "NAME, which is not in ... nor ...; VARIABLE may name it"
};

/// Looks where an environment variable says; without it beside this program, then where programs of ours are installed.
HelperProgram find_helper_program(const std::string& name, const char* variable);

}  // namespace collided::engine
