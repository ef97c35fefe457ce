#include "client/cli/files_program.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/sibling_program.hpp"
#include "idl/terminal_text.hpp"

namespace collided::cli {
namespace {

constexpr const char* kProgram = "collided-files";

/// Starts it; its standard output and its errors go to these descriptors, unless they are -1.
pid_t start(const Io& io, std::vector<std::string> words, int out, int err) {
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
    if (err >= 0) ::dup2(err, STDERR_FILENO);
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

/// Everything that can be read from the descriptor.
std::string all_of(int descriptor) {
  std::string text;
  std::array<char, 65'536> chunk{};
  for (;;) {
    const ssize_t count = ::read(descriptor, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(chunk.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

int run_files_program(const Io& io, std::vector<std::string> words) {
  return exit_code_of(start(io, std::move(words), -1, -1));
}

std::string files_program_output(const Io& io, std::vector<std::string> words) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw Failure(Exit::refused, fmt::format("no pipe: {}", std::strerror(errno)));
  // A file takes what it says, however much that is, while its output is read.
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> said(std::tmpfile(), std::fclose);
  const pid_t child = start(io, std::move(words), ends[1], said ? ::fileno(said.get()) : -1);
  ::close(ends[1]);
  const std::string text = all_of(ends[0]);
  ::close(ends[0]);
  const int code = exit_code_of(child);
  std::string messages;
  if (said) {
    std::rewind(said.get());
    messages = all_of(::fileno(said.get()));
  }
  constexpr std::string_view kError = "error: ";
  if (code != 0 && messages.starts_with(kError)) {
    messages.erase(0, kError.size());
    messages.erase(std::min(messages.find('\n'), messages.size()));
    throw bad_use(messages);
  }
  io.err << wire_contract::terminal_text(messages);
  if (code != 0) throw bad_use("the file was not read");
  return text;
}

}  // namespace collided::cli
