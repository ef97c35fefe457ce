#include "client/cli/sibling_program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>

#include "client/cli/command.hpp"

namespace collided::cli {
namespace {

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

Failure cannot_start(const Sibling& sibling, int fault) {
  if (fault == ENOENT) return bad_use(fmt::format("the program {} was not found", sibling.name), sibling.remedy);
  return {Exit::refused, fmt::format("{} cannot be started: {}", sibling.name, std::strerror(fault))};
}

// Buffered text would be lost, or follow the other program's.
void flush(const Io& io) {
  io.out.flush();
  io.err.flush();
}

/// The program of a verb that `collide` itself lacks.
Sibling wing_program(std::string_view name) {
  return {.name = fmt::format("collide-{}", name),
          .remedy = "it is installed with collide, unless this build leaves it out"};
}

}  // namespace

std::string path_of(const Io& io, const Sibling& sibling) {
  namespace fs = std::filesystem;
  if (sibling.variable != nullptr) {
    if (std::string chosen = io.env(sibling.variable); !chosen.empty()) return chosen;
  }
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* folder : {".", "../libexec/collided", "../../bin", "../../server"}) {
    const fs::path place = here / folder / sibling.name;
    if (fs::is_regular_file(place, error)) return place.lexically_normal().string();
  }
  return sibling.name;
}

pid_t start_sibling(const Io& io, const Sibling& sibling, SiblingStart start) {
  const std::string program = path_of(io, sibling);
  start.words.insert(start.words.begin(), sibling.name);
  std::vector<std::string> variables{fmt::format("{}={}", kWhereVariable, start.where)};
  for (char** variable = environ; *variable != nullptr; ++variable) variables.emplace_back(*variable);
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  for (const auto& [from, to] :
       {std::pair(start.in, STDIN_FILENO), std::pair(start.out, STDOUT_FILENO), std::pair(start.err, STDERR_FILENO)})
    if (from >= 0) posix_spawn_file_actions_adddup2(&streams, from, to);
  flush(io);
  pid_t child = 0;
  const int fault = ::posix_spawnp(&child, program.c_str(), &streams, nullptr, pointers_to(start.words).data(),
                                   pointers_to(variables).data());
  posix_spawn_file_actions_destroy(&streams);
  if (fault != 0) throw cannot_start(sibling, fault);
  return child;
}

int exit_code_of(const Sibling& sibling, pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) return static_cast<int>(Exit::interrupted);
  if (WIFSIGNALED(status))
    throw Failure(Exit::refused, fmt::format("{} was ended by signal {}", sibling.name, WTERMSIG(status)));
  return WEXITSTATUS(status);
}

void become_sibling(const Io& io, const Sibling& sibling, std::vector<std::string> words) {
  const std::string program = path_of(io, sibling);
  words.insert(words.begin(), sibling.name);
  flush(io);
  ::execvp(program.c_str(), pointers_to(words).data());
  throw cannot_start(sibling, errno);
}

Exit run_wing(const Session& session, std::string_view name) {
  const Sibling program = wing_program(name);
  if (!session.has_many_verbs) become_sibling(session.io, program, session.words);
  // The lines come from this program's standard input, so the child must not read it.
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  const pid_t child =
      start_sibling(session.io, program, {.words = session.words, .in = nothing, .where = session.where});
  ::close(nothing);
  const auto code = static_cast<Exit>(exit_code_of(program, child));
  if (code != Exit::bad_use && code != Exit::no_server && code != Exit::refused) return code;
  Failure failure(code, "");
  failure.is_printed = true;
  throw failure;
}

}  // namespace collided::cli
