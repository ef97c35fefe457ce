#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/sibling_program.hpp"
#include "client/cli/verbs/undo.hpp"

namespace collided::cli {
namespace {

/// A program that runs beside this one and ends with it.
class Child {
 public:
  explicit Child(std::vector<std::string> words) {
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    id_ = ::fork();
    if (id_ < 0) throw Failure(Exit::refused, fmt::format("{} cannot be started: {}", words[0], std::strerror(errno)));
    if (id_ > 0) return;
    // Ctrl-C reaches the whole terminal; this program ends its child itself, in order.
    ::setpgid(0, 0);
    // It says how to ask it, and so does the demo; what goes wrong comes by its standard error.
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere < 0 ? STDERR_FILENO : nowhere, STDOUT_FILENO);
    ::execvp(pointers[0], pointers.data());
    ::_exit(127);
  }
  ~Child() {
    if (ended()) return;
    ::kill(id_, SIGTERM);
    while (::waitpid(id_, &status_, 0) < 0 && errno == EINTR) {}
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  std::uint32_t id() const { return static_cast<std::uint32_t>(id_); }
  bool ended() {
    if (!ended_) ended_ = ::waitpid(id_, &status_, WNOHANG) == id_;
    return ended_;
  }
  /// Of a child that ended.
  int exit_code() const { return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_); }

 private:
  pid_t id_ = 0;
  int status_ = 0;
  bool ended_ = false;
};

class DemoCommand : public Command {
 public:
  void declare(CLI::App& app) override { app.add_option("--for", for_, "End after so long (at Ctrl-C)"); }

  Exit run(Session& session, const Globals& globals) override {
    const std::optional<std::chrono::nanoseconds> time =
        for_.empty() ? std::nullopt : std::optional(parse_duration(for_));
    const auto begun = std::chrono::steady_clock::now();
    const ConnectOptions where = connect_options(session.io, globals);
    Child server({sibling_program(session.io, "COLLIDED_SERVER", "collided"), "--log", "error", "--domain",
                  std::to_string(where.domain), "--namespace", where.name_space});
    meet(server, session, globals);
    tell(session, where);
    while (!stop_requested && !server.ended() && !(time && std::chrono::steady_clock::now() - begun > *time))
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (server.ended())
      throw Failure(Exit::refused, fmt::format("the server ended by itself ({})", server.exit_code()));
    return Exit::yes;
  }

 private:
  /// Waits until the server answers.
  static void meet(Child& server, Session& session, const Globals& globals) {
    for (;;) {
      if (stop_requested) throw Failure(Exit::interrupted, "");
      if (server.ended()) {
        throw Failure(Exit::refused, fmt::format("the server did not start ({})", server.exit_code()),
                      "it is the program collided; COLLIDED_SERVER may name it");
      }
      try {
        // Until ours runs another one may answer, and then ours ends and says so.
        const ServerStatus status = take(session.client(globals).status());
        if (status.state == "ready" && status.pid == server.id()) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      } catch (const Failure& failure) {
        if (failure.code != Exit::no_server) throw;
      }
    }
  }

  static void tell(Session& session, const ConnectOptions& where) {
    Client& client = session.client({});
    std::ostream& out = session.io.out;
    const RayQuestion ray{.origin = {0, 0, 5}, .direction = {0, 0, -1}};
    const Answer below = take(client.ask(ray));
    const Answer near = take(client.ask(NearQuestion{.point = {0, 0, 1}}));
    out << fmt::format("A small warehouse of {} objects is served until Ctrl-C.\n\n", take(client.list()).count)
        << "  $ collide ray 0 0 5  0 0 -1\n"
        << fmt::format("  5 m above its middle, a ray straight down {}\n\n", first_of(below, "meets"))
        << "  $ collide near 0 0 1\n"
        << fmt::format("  1 m above it, {}\n\n", first_of(near, "the nearest thing is"))
        << "Try in another terminal:\n\n"
        << environment_line(where) << "  collide ls\n"
        << "  collide add ball sphere 0.3 --at -5 0 0.5\n"
        << "  collide pair ball pallet_01\n"
        << "  collide watch          then, in a third one, collide move ball 5 0 0.5\n"
        << "  collide draw --term\n";
    out.flush();
  }
  static std::string first_of(const Answer& answer, std::string_view what) {
    if (answer.hits.empty()) return "meets nothing";
    const Hit& hit = answer.hits.front();
    return fmt::format("{} {} at {:.3g} m", what, printable(hit.object), hit.distance_m);
  }
  /// What another terminal must set to reach this server; nothing for the usual one.
  static std::string environment_line(const ConnectOptions& where) {
    std::string line;
    if (where.domain != 0) line += fmt::format(" COLLIDED_DOMAIN={}", where.domain);
    if (where.name_space != "collided") line += " COLLIDED_NAMESPACE=" + shell_word(where.name_space);
    return line.empty() ? line : "  export" + line + "\n";
  }

  std::string for_;
};

}  // namespace

std::unique_ptr<Command> make_demo() { return std::make_unique<DemoCommand>(); }

}  // namespace collided::cli
