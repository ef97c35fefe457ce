#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "client/cli/io.hpp"

// Other programs of this project that are installed with this one.
namespace collided::cli {

struct Sibling {
  std::string name;
  const char* variable = nullptr;  // of the environment, which may name its path; null: none
  std::string remedy = {};         // what to do where it is missing
};

/// Its path: the one that the variable names; else beside this program, with the installed helpers, beside `collide` for a
/// helper, or in a build tree; else its name, for PATH.
std::string path_of(const Io& io, const Sibling& sibling);

/// The variable by which a program that runs one of another's lines learns how its messages begin.
inline constexpr const char* kWhereVariable = "COLLIDE_WHERE";

/// How a program is started; descriptors of -1 are this process's.
struct SiblingStart {
  std::vector<std::string> words;
  int in = -1;
  int out = -1;
  int err = -1;
  std::string where = {};  // for kWhereVariable
};

/// Starts it as a child. Throws Failure where it is missing.
pid_t start_sibling(const Io& io, const Sibling& sibling, SiblingStart start);

/// Waits for its end. Throws Failure where a signal ended it, unless that was Ctrl-C.
int exit_code_of(const Sibling& sibling, pid_t child);

/// Goes on as that program. Throws Failure where it is missing.
[[noreturn]] void become_sibling(const Io& io, const Sibling& sibling, std::vector<std::string> words);

}  // namespace collided::cli
