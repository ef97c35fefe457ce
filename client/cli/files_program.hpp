#pragma once

#include <string>
#include <vector>

#include "client/cli/io.hpp"

namespace collided::cli {

// collided-files, the program that reads files: only the server's code does, and this program does not contain it.

/// Runs it with these words on this process's stdin, stdout and stderr. Returns its exit code. Throws Failure where it is
/// not installed or was ended by a signal.
int run_files_program(const Io& io, std::vector<std::string> words);

/// The same with its standard output as the result. Throws Failure as well where it fails; it has then said why.
std::string files_program_output(const Io& io, std::vector<std::string> words);

}  // namespace collided::cli
