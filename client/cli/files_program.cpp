#include "client/cli/files_program.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/sibling_program.hpp"

namespace collided::cli {
namespace {

constexpr const char* kProgram = "collided-files";

/// Starts it; its standard output goes to the descriptor, unless that is -1.
pid_t start(const Io& io, std::vector<std::string> words, int out) {
  words.insert(words.begin(), kProgram);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const std::string program = sibling_program(io, "COLLIDED_FILES", kProgram);
  io.out.flush();
  io.err.flush();
  const pid_t child = ::fork();
  if (child < 0) throw Failure(Exit::refused, fmt::format("{} cannot be started: {}", kProgram, std::strerror(errno)));
  if (child == 0) {
    if (out >= 0) ::dup2(out, STDOUT_FILENO);
    ::execvp(program.c_str(), pointers.data());
    ::_exit(127);
  }
  return child;
}

int exit_code_of(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) return static_cast<int>(Exit::interrupted);
  if (WIFSIGNALED(status))
    throw Failure(Exit::refused, fmt::format("{} was ended by signal {}", kProgram, WTERMSIG(status)));
  if (WEXITSTATUS(status) == 127) {
    throw Failure(Exit::bad_use, fmt::format("the program {} was not found", kProgram),
                  "it is installed with collide; COLLIDED_FILES may name it");
  }
  return WEXITSTATUS(status);
}

}  // namespace

int run_files_program(const Io& io, std::vector<std::string> words) {
  return exit_code_of(start(io, std::move(words), -1));
}

std::string files_program_output(const Io& io, std::vector<std::string> words) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw Failure(Exit::refused, fmt::format("no pipe: {}", std::strerror(errno)));
  const pid_t child = start(io, std::move(words), ends[1]);
  ::close(ends[1]);
  std::string text;
  std::array<char, 65'536> chunk{};
  for (;;) {
    const ssize_t count = ::read(ends[0], chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    text.append(chunk.data(), static_cast<std::size_t>(count));
  }
  ::close(ends[0]);
  if (exit_code_of(child) != 0) throw Failure(Exit::bad_use, "the file was not read");
  return text;
}

}  // namespace collided::cli
