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
  std::string remedy = {};         // what to do if it is missing
};

/// Its path: the variable's value; else next to this program, with the installed helpers, next to `collide` for a
/// helper, or in a build tree; else its name, for PATH.
std::string path_of(const Io& io, const Sibling& sibling);

/// The variable from which a program that runs a line of another one learns the beginning of its messages.
inline constexpr const char* kWhereVariable = "COLLIDE_WHERE";

/// How a program is started; descriptors of -1 are this process's.
struct SiblingStart {
  std::vector<std::string> words;
  int in = -1;
  int out = -1;
  int err = -1;
  std::string where = {};  // for kWhereVariable
};

/// Starts it as a child. Throws Failure if it is missing.
pid_t start_sibling(const Io& io, const Sibling& sibling, SiblingStart start);

/// Waits for its end. Throws Failure if a signal ended it, unless that was Ctrl-C.
int exit_code_of(const Sibling& sibling, pid_t child);

/// Continues as that program. Throws Failure if it is missing.
[[noreturn]] void become_sibling(const Io& io, const Sibling& sibling, std::vector<std::string> words);

}  // namespace collided::cli
