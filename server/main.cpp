#include <fmt/format.h>
#include <malloc.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include "idl/terminal_text.hpp"
#include "server/fleet/fleet_source.hpp"
#include "server/service/options/options.hpp"
#include "server/service/questions/time_slice.hpp"
#include "server/service/runtime/dds_warnings.hpp"
#include "server/service/runtime/log.hpp"
#include "server/service/runtime/out_of_memory.hpp"
#include "server/service/runtime/supervisor.hpp"
#include "server/service/server.hpp"
#include "server/service/start_scenes.hpp"

namespace {

using namespace collided::engine::service;

/// Another server is the primary, or the primary is unknown: another start may succeed.
constexpr int kGivenWay = 3;

/// Blocked before any thread is made, so that only the waiting main thread receives them.
sigset_t block_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT, SIGUSR1}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

/// Waits for the next signal, at most for the given time; 0 if none comes.
int next_signal(const sigset_t& signals, const timespec& at_most) {
  const int signal = sigtimedwait(&signals, nullptr, &at_most);
  return signal < 0 ? 0 : signal;
}

/// For all threads, DDS's too. If memory is limited, the whole stack of each counts from the start, and 8 MB for each
/// of seventeen threads are most of a small machine's limit.
void limit_stacks() {
  constexpr std::size_t kBytes = std::size_t{2} << 20;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kBytes);
  pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
}

/// Ends the process if stopping takes too long. In short sleeps, so that time in which the process was suspended, or
/// found no processor, hardly counts.
void limit_stopping() {
  std::thread([] {
    constexpr std::chrono::milliseconds kLook{100};
    constexpr int kLooks = 100;
    for (int look = 0; look < kLooks; ++look) std::this_thread::sleep_for(kLook);
    fmt::print(stderr, "error: stopping took longer than 10 s; leaving at once\n");
    std::_Exit(1);
  }).detach();
}

/// Returns once a signal ends the server. The ready line is printed when the kept state is restored: before that an
/// answer may be "undecided", and clients that wait for the line ask at once.
void serve_until_ended(Server& server, const std::string& ready, const sigset_t& signals) {
  constexpr timespec kLook{.tv_sec = 0, .tv_nsec = 10'000'000};
  constexpr timespec kIdle{.tv_sec = 30, .tv_nsec = 0};
  bool is_announced = false;
  while (true) {
    if (!is_announced && !server.is_restoring()) {
      is_announced = true;
      fmt::print("{}\n", ready);
      std::fflush(stdout);
      notify_supervisor("READY=1\nSTATUS=" + ready);
    }
    const int signal = next_signal(signals, is_announced ? kIdle : kLook);
    if (signal == SIGUSR1) server.write_flight_recorder();
    // Returns free pages to the system; otherwise the allocator's pools keep the memory of past clients and loads.
    if (signal == 0 && is_announced) malloc_trim(0);
    if ((signal == SIGTERM || signal == SIGINT) && !server.goes_on()) return;
  }
}

int serve(const Options& options, const MakePlace& make_place) {
  // The files of the state folder contain the world and all questions. With keys these travel encrypted, so no other
  // user of the machine may read them there.
  ::umask(0077);
  const sigset_t signals = block_signals();
  // One pool for all threads: memory that one thread allocates and another frees would leave holes in each thread's own
  // pool. Frequent questions allocate nothing, so threads do not queue for it.
  mallopt(M_ARENA_MAX, 1);
  limit_stacks();
  report_aborts();
  set_time_slice(kShortSlice);
  const std::shared_ptr<spdlog::logger> log = make_log(options.log_level, options.log_json);
  const DdsWarnings dds_warnings(log);
  // If another server has taken over, this one ends as if it had been asked to.
  Server server(options, log, make_place, [] { kill(getpid(), SIGTERM); });
  const std::string ready = server.start();
  if (options.scenes.empty()) fmt::print("{}", how_to_ask());
  serve_until_ended(server, ready, signals);
  notify_supervisor("STOPPING=1");
  limit_stopping();
  server.stop();
  return server.has_given_way() ? kGivenWay : 0;
}

/// Prints each scene file that cannot be read. Returns the exit code of --check-config.
int check_scenes(const Options& options) {
  int code = 0;
  for (const std::string& scene : options.scenes) {
    if (access(scene.c_str(), R_OK) == 0) continue;
    fmt::print(stderr, "error: scene '{}': {}\n", scene, std::strerror(errno));
    code = 2;
  }
  return code;
}

int run(const std::vector<std::string>& arguments) {
  const PlaceSource places = fleet_source();
  ParsedOptions parsed = parse_options(
      arguments, [](const char* name) { return std::getenv(name); }, places.apply);
  Options& options = parsed.options;
  if (options.show_help || options.show_version) {
    fmt::print("{}", options.show_help ? help_text() : "collided " + version_text() + "\n");
    return 0;
  }
  if (options.print_config) fmt::print("{}", print_config(parsed));
  if (options.check_config) return check_scenes(options);
  if (options.print_config) return 0;
  places.complete(options);
  return options.once ? run_once(options) : serve(options, places.make);
}

/// The message may quote files, etcd and other servers.
void print_error(const std::exception& failed) {
  fmt::print(stderr, "error: {}\n", collided::wire_contract::terminal_text(failed.what()));
}

}  // namespace

int main(int count, char** values) {
  try {
    return run({values + 1, values + count});
  } catch (const CannotServeNow& failed) {
    print_error(failed);
    return kGivenWay;
  } catch (const std::exception& failed) {
    print_error(failed);
    return 2;
  }
}
