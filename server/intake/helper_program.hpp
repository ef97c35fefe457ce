#pragma once

#include <string>

namespace collided::engine {

/// A program of this project that another one runs as a separate process.
struct HelperProgram {
  std::string path;     // empty if not found
  std::string why_not;  // "NAME, which is not in ... nor ...; VARIABLE may name it"
};

/// Finds a program: by the environment variable; if that is not set, beside the running program, then in the folder in
/// which this project's programs are installed.
HelperProgram find_helper_program(const std::string& name, const char* variable);

}  // namespace collided::engine
