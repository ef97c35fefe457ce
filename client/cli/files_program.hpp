#pragma once

#include <string>
#include <vector>

#include "client/cli/io.hpp"

namespace collided::cli {

// collided-files, the program that reads files: only the server's code can, and this program does not contain it.

/// Runs it with these words on this process's stdin, stdout and stderr. Returns its exit code. Throws Failure if it is
/// not installed or was ended by a signal.
int run_files_program(const Io& io, std::vector<std::string> words);

/// The same with its standard output as the result. Throws Failure also if it fails; it has then printed the reason.
std::string files_program_output(const Io& io, std::vector<std::string> words);

}  // namespace collided::cli
