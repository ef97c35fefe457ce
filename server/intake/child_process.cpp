#include "server/intake/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

namespace collided::engine {
namespace {

class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) { ends_ = {-1, -1}; }
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  bool is_open() const { return ends_[0] >= 0; }
  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_write_end() { close_end(1); }

  /// Appends what can be read now; at the end of the stream, closes the read end.
  void drain_into(std::string& text) {
    std::array<char, 4096> piece;
    const ssize_t got = ::read(ends_[0], piece.data(), piece.size());
    if (got > 0) { text.append(piece.data(), std::min(static_cast<std::size_t>(got), kMaxChildText - text.size())); }
    if (got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN)) { close_end(0); }
  }

 private:
  void close_end(std::size_t end) {
    if (ends_[end] >= 0) {
      ::close(ends_[end]);
      ends_[end] = -1;
    }
  }

  std::array<int, 2> ends_{-1, -1};
};

/// A file in memory with these bytes, positioned at its beginning.
class ChildInput {
 public:
  explicit ChildInput(std::span<const std::byte> bytes) : file_(::memfd_create("input", MFD_CLOEXEC)) {
    while (file_ >= 0 && !bytes.empty()) {
      const ssize_t written = ::write(file_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) break;
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    is_whole_ = file_ >= 0 && bytes.empty() && ::lseek(file_, 0, SEEK_SET) == 0;
  }
  ~ChildInput() {
    if (file_ >= 0) ::close(file_);
  }
  ChildInput(const ChildInput&) = delete;
  ChildInput& operator=(const ChildInput&) = delete;
  bool is_whole() const { return is_whole_; }
  int descriptor() const { return file_; }

 private:
  int file_ = -1;
  bool is_whole_ = false;
};

/// Starts the program. Returns the process id, or the negated error number.
pid_t start(const std::vector<std::string>& words, const ChildInput& input, const Pipe& output, const Pipe& errors) {
  std::vector<char*> arguments;
  for (const std::string& word : words) { arguments.push_back(const_cast<char*>(word.c_str())); }
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&actions, input.descriptor(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output.write_end(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, errors.write_end(), STDERR_FILENO);
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&attributes, &signals);
  sigfillset(&signals);
  posix_spawnattr_setsigdefault(&attributes, &signals);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return error == 0 ? child : -error;
}

void read_until_end(pid_t child, Pipe& output, Pipe& errors, std::chrono::milliseconds time_limit,
                    const std::function<bool()>& cancelled, ChildResult& result) {
  constexpr int kLook_ms = 50;
  const auto end = std::chrono::steady_clock::now() + time_limit;
  bool is_ended = false;
  while (output.is_open() || errors.is_open()) {
    std::array<pollfd, 2> waits = {pollfd{output.read_end(), POLLIN, 0}, pollfd{errors.read_end(), POLLIN, 0}};
    ::poll(waits.data(), waits.size(), kLook_ms);  // a closed end is -1, which poll() ignores
    if (waits[0].revents != 0) { output.drain_into(result.output); }
    if (waits[1].revents != 0) { errors.drain_into(result.errors); }
    if (is_ended) { continue; }
    result.timed_out = std::chrono::steady_clock::now() >= end;
    result.cancelled = cancelled && cancelled();
    if (result.timed_out || result.cancelled) {
      ::kill(-child, SIGKILL);
      is_ended = true;
    }
  }
}

}  // namespace

ChildResult run_child(const std::vector<std::string>& words, std::chrono::milliseconds time_limit,
                      const std::function<bool()>& cancelled, std::span<const std::byte> input) {
  ChildResult result;
  const ChildInput input_file(input);
  Pipe output;
  Pipe errors;
  if (!input_file.is_whole() || !output.is_open() || !errors.is_open()) {
    result.start_failure = std::strerror(errno);
    return result;
  }
  const pid_t child = start(words, input_file, output, errors);
  if (child < 0) {
    result.start_failure = std::strerror(-child);
    return result;
  }
  output.close_write_end();
  errors.close_write_end();
  try {
    read_until_end(child, output, errors, time_limit, cancelled, result);
  } catch (...) {  // thrown by the caller's cancelled(): leave no process behind
    ::kill(-child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    throw;
  }
  int status = 0;
  pid_t waited = 0;
  while ((waited = ::waitpid(child, &status, 0)) < 0 && errno == EINTR) {}
  if (waited == child && WIFEXITED(status)) {
    result.exit_code = WEXITSTATUS(status);
  } else if (waited == child && WIFSIGNALED(status)) {
    result.signal = WTERMSIG(status);
  }
  return result;
}

}  // namespace collided::engine
