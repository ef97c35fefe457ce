#include "client/cli/programs/shell/prompt.hpp"

#include <editline/readline.h>

#include <cstdlib>
#include <filesystem>
#include <memory>

namespace collided::cli {
namespace {

constexpr int kMostRemembered = 1'000;

/// The history's file, or an empty path if there is no place for it.
std::filesystem::path history_file(const Io& io) {
  std::filesystem::path folder = io.env("XDG_STATE_HOME");
  if (folder.empty() && !io.env("HOME").empty()) folder = std::filesystem::path(io.env("HOME")) / ".local/state";
  if (folder.empty()) return {};
  std::error_code error;
  std::filesystem::create_directories(folder / "collide", error);
  return error ? std::filesystem::path() : folder / "collide" / "history";
}

/// Reads the history, and writes it when the last line has been read.
class History {
 public:
  explicit History(const Io& io) : file_(history_file(io)) {
    using_history();
    stifle_history(kMostRemembered);
    if (!file_.empty()) read_history(file_.c_str());
  }
  ~History() {
    if (!file_.empty()) write_history(file_.c_str());
  }
  History(const History&) = delete;
  History& operator=(const History&) = delete;

 private:
  std::filesystem::path file_;
};

}  // namespace

LineSource prompted_lines(const Io& io) {
  const auto history = std::make_shared<History>(io);
  return {.next = [history](std::string& line) {
    const std::unique_ptr<char, decltype(&std::free)> typed(readline("collide> "), &std::free);
    if (typed == nullptr) return false;
    line = typed.get();
    if (!line.empty()) add_history(line.c_str());
    return line != "exit" && line != "quit";
  }};
}

}  // namespace collided::cli
