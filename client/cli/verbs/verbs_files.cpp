#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <filesystem>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"

namespace collided::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "collided-files";

/// The path of the program: with the helpers where it is installed, beside this one, or in a build tree; else found by PATH.
std::string find_program(const Io& io) {
  if (std::string chosen = io.env("COLLIDED_FILES"); !chosen.empty()) return chosen;
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& place :
       {here / kProgram, here / "../libexec/collided" / kProgram, here / "../../server" / kProgram}) {
    if (fs::is_regular_file(place, error)) return place.string();
  }
  return kProgram;
}

/// Runs the program with these words, on this process's stdin, stdout and stderr. Returns its exit code.
int run_program(const std::string& program, std::vector<std::string> words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw Failure(Exit::refused, fmt::format("{} cannot be started: {}", kProgram, std::strerror(errno)));
  if (child == 0) {
    ::execvp(program.c_str(), pointers.data());
    ::_exit(127);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) return static_cast<int>(Exit::interrupted);
  if (WIFSIGNALED(status))
    throw Failure(Exit::refused, fmt::format("{} was ended by signal {}", kProgram, WTERMSIG(status)));
  return WEXITSTATUS(status);
}

/// A verb that reads files. Only the server's code reads files, and this program does not contain it, so another
/// program does the work.
class FilesCommand : public PassOn {
 public:
  /// joins_values  whether a negative number after an option is the option's value
  FilesCommand(const char* verb, bool joins_values) : verb_(verb), joins_values_(joins_values) {}

  void declare(CLI::App&) override {}

  void take_words(std::vector<std::string> words) override {
    for (std::size_t at = 0; at < words.size(); ++at) {
      // A value that begins with a minus sign is joined to its option.
      const bool value_follows = joins_values_ && words[at].starts_with("--") && at + 1 < words.size() &&
                                 words[at + 1].starts_with("-") && is_number_text(words[at + 1]);
      words_.push_back(value_follows ? words[at] + "=" + words[at + 1] : words[at]);
      if (value_follows) ++at;
    }
  }

  Exit run(Session& session, const Globals&) override {
    std::vector<std::string> words{kProgram, verb_};
    words.insert(words.end(), words_.begin(), words_.end());
    session.io.out.flush();
    session.io.err.flush();
    const int code = run_program(find_program(session.io), std::move(words));
    if (code == 127)
      throw Failure(Exit::bad_use, fmt::format("the program {} was not found", kProgram),
                    "it is installed with collide; COLLIDED_FILES may name it");
    return static_cast<Exit>(code);
  }

 private:
  const char* verb_;
  bool joins_values_;
  std::vector<std::string> words_;
};

}  // namespace

std::unique_ptr<Command> make_check() { return std::make_unique<FilesCommand>("check", true); }
std::unique_ptr<Command> make_convert() { return std::make_unique<FilesCommand>("convert", true); }
std::unique_ptr<Command> make_implicit() { return std::make_unique<FilesCommand>("implicit", false); }

}  // namespace collided::cli
