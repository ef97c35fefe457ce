#include "client/cli/own_server.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/sibling_program.hpp"

namespace collided::cli {

OwnServer::Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

OwnServer::OwnServer(Io& io, const ConnectOptions& where, const std::vector<std::string>& words)
    : folder_{(std::filesystem::temp_directory_path() / fmt::format("collide-{}", ::getpid())).string()} {
  std::vector<std::string> all{path_of(io, {.name = "collided", .variable = "COLLIDED_SERVER"}), "--log", "error"};
  all.insert(all.end(), {"--domain", std::to_string(where.domain), "--namespace", where.name_space});
  all.insert(all.end(), {"--state-dir", folder_.path});
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> pointers;
  for (std::string& word : all) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  id_ = ::fork();
  if (id_ < 0) throw Failure(Exit::refused, fmt::format("{} cannot be started: {}", all[0], std::strerror(errno)));
  if (id_ > 0) return;
  // Ctrl-C reaches the whole terminal; this program ends its child itself, properly.
  ::setpgid(0, 0);
  // Its hints on how to ask repeat those of the program that starts it; its errors come on standard error.
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere < 0 ? STDERR_FILENO : nowhere, STDOUT_FILENO);
  ::execvp(pointers[0], pointers.data());
  ::_exit(127);
}

OwnServer::~OwnServer() {
  if (ended()) return;
  ::kill(id_, SIGTERM);
  while (::waitpid(id_, &status_, 0) < 0 && errno == EINTR) {}
}

bool OwnServer::ended() {
  if (!ended_) ended_ = ::waitpid(id_, &status_, WNOHANG) == id_;
  return ended_;
}

int OwnServer::exit_code() const { return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_); }

void OwnServer::meet(Session& session, const Globals& globals) {
  for (;;) {
    if (stop_requested) throw Failure(Exit::interrupted, "");
    if (ended()) {
      throw Failure(Exit::refused, fmt::format("the server did not start ({})", exit_code()),
                    "it is the program collided; COLLIDED_SERVER may name it");
    }
    try {
      // Until our server runs another one may answer; then ours ends with a message.
      const ServerStatus status = take(session.client(globals).status());
      if (status.state == "ready" && status.pid == static_cast<std::uint32_t>(id_)) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    } catch (const Failure& failure) {
      if (failure.code != Exit::no_server) throw;
    }
  }
}

}  // namespace collided::cli
