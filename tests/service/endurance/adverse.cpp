// What a machine may do to a server that runs for long:
//   adverse SERVER SHIFTED_CLOCK CASE
// CASE is disk_full, memory_limit, sample_bomb, clock_jump or uptime. Prints one line; exits 1 where the server did not
// serve on, did not say what there was to say or took too much memory, 77 where the system does not let the case be made.

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>

#include "idl/dds.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"
#include "tests/service/endurance/process_figures.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;

constexpr int kCannotRun = 77;
/// Beyond what an idle server has.
constexpr double kBudget_mib = 100;

int cannot_run(const char* what) {
  std::printf("skipped: %s: %s\n", what, std::strerror(errno));
  return kCannotRun;
}

/// A server, somebody who asks it, and a ball on its floor.
class Bench {
 public:
  Bench(std::vector<std::string> launcher, const std::string& server, const std::string& state_dir)
      : server_(words(std::move(launcher), server, state_dir), folder_.path(), "server") {
    if (!server_.says("ready:", 20s)) {
      std::fprintf(stderr, "%s%s", server_.output().c_str(), server_.errors().c_str());
      std::exit(2);
    }
    client_.emplace(value_of(Client::connect({.domain = own_domain(), .wait = 10s}), "connect"));
    watch_.emplace(value_of(client_->watch({.only = "marker"}), "watch"));
    publisher_.emplace(value_of(client_->publish("marker"), "publish"));
    ball_ = value_of(
        publisher_->add({.name = "marker", .shape = {SphereShape{.radius_m = 0.1}}, .pose = {.position = {6, 0, 1}}}),
        "add");
    first_mib_ = resident_mib(server_.pid());
    // Until a status has vouched for what holds, events count as part of it; statuses come twenty times a second.
    for (int i = 0; i < 6; ++i) keep_alive(), std::this_thread::sleep_for(50ms);
  }

  Client& client() { return *client_; }
  ChildProcess& server() { return server_; }
  const ScratchFolder& folder() const { return folder_; }
  double grown_mib() const { return resident_mib(server_.pid()) - first_mib_; }
  bool says(const char* text) const { return server_.errors().find(text) != std::string::npos; }
  void move(double z, std::chrono::nanoseconds source_time = 0ns) {
    static_cast<void>(publisher_->move(ball_, {.position = {6, 0, z}}));
    static_cast<void>(publisher_->flush(source_time));
  }
  void keep_alive() { static_cast<void>(publisher_->keep_alive()); }

  /// A ray is answered as it should be, and a touch begins and ends once, in time and in order.
  bool serves(std::chrono::nanoseconds source_time = 0ns) {
    const Result<Answer> answer =
        client_->ask(RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}}, {.only = "warehouse/*"});
    const bool answered =
        answer && answer->verdict == Verdict::hit && std::abs(answer->hits[0].distance_m - 3.8) < 1e-9;
    move(0.05, source_time);
    const std::optional<Event> began = watch_->next(2s);
    move(1, source_time == 0ns ? source_time : source_time + 1ms);
    const std::optional<Event> ended = watch_->next(2s);
    const bool told = began && began->kind == EventKind::began && ended && ended->kind == EventKind::ended &&
                      ended->reason == EndReason::separated && ended->episode == began->episode;
    if (!answered) std::fprintf(stderr, "no right answer: %s\n", answer ? "wrong" : answer.error().message.c_str());
    if (!told)
      std::fprintf(stderr, "no right events: %s\n",
                   !began                            ? "no began"
                   : began->kind != EventKind::began ? "not began"
                   : !ended                          ? "no ended"
                                                     : "not ended as it should");
    return answered && told;
  }
  /// Nothing more was told than serves() has looked at.
  bool is_quiet() { return !watch_->next(0ns); }

 private:
  static std::vector<std::string> words(std::vector<std::string> launcher, const std::string& server,
                                        const std::string& state_dir) {
    launcher.insert(launcher.end(), {server, "--domain", std::to_string(own_domain()), "--state-dir", state_dir});
    return launcher;
  }
  ScratchFolder folder_;
  ChildProcess server_;
  std::optional<Client> client_;
  std::optional<Watch> watch_;
  std::optional<Publisher> publisher_;
  Publisher::Object ball_ = 0;
  double first_mib_ = 0;
};

int report(const char* name, Bench& bench, bool serves, bool said) {
  const double grown = bench.grown_mib();
  std::printf("case=%s serves=%d says_so=%d rss_grown_mib=%.0f\n", name, serves ? 1 : 0, said ? 1 : 0, grown);
  const bool kept = serves && said && grown <= kBudget_mib;
  if (!kept) std::fprintf(stderr, "the server said:\n%s", bench.server().errors().c_str());
  return kept ? 0 : 1;
}

// ---- cases

Shape ball_of_triangles(int rows) {
  MeshShape mesh;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column < rows; ++column) {
      const double polar = std::numbers::pi * row / rows;
      const double turn = 2 * std::numbers::pi * column / rows;
      mesh.vertices.emplace_back(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
    }
  }
  const auto at = [&](int row, int column) { return static_cast<std::uint32_t>(row * rows + column % rows); };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < rows; ++column)
      mesh.triangles.push_back({at(row, column), at(row + 1, column), at(row + 1, column + 1)});
  }
  return {mesh};
}

/// A disk of 256 KiB, of which others have a half, fills up with objects that commands add; then the others give it back.
int disk_full(const std::string& server) {
  if (unshare(CLONE_NEWNS) != 0 || mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0)
    return cannot_run("a mount namespace");
  const ScratchFolder disk;
  if (mount("tmpfs", disk.path().c_str(), "tmpfs", 0, "size=256k") != 0) return cannot_run("a small disk");
  const std::string others = disk.write("others", std::string(128 << 10, 'x'));
  int code = 1;
  {
    Bench bench({}, server, disk.path());
    const auto add = [&](int i) {
      const nlohmann::json arguments{{"name", "thing " + std::to_string(i)},
                                     {"pose", {1'000.0 + 3 * i, 0, 0, 1, 0, 0, 0}}};
      const Result<std::string> text = bench.client().command("add", arguments.dump(), ball_of_triangles(12));
      if (!text) std::fprintf(stderr, "add: %s\n", text.error().message.c_str());
      bench.keep_alive();
      return text ? nlohmann::json::parse(*text) : nlohmann::json();
    };
    int kept = 0;
    while (kept < 200 && !add(kept).contains("not_kept")) ++kept;
    bool serves = bench.serves();
    // Everything is in the world all the same.
    const Result<Answer> last =
        bench.client().ask(SphereQuestion{.center = {1'000.0 + 3 * kept, 0, 0}, .radius_m = 1.5});
    serves = serves && last && last->verdict == Verdict::hit;
    bool said =
        kept < 200 &&
        bench.says("cannot be written: No space left on device; what is added now is lost when the server ends");
    std::filesystem::remove(others);
    const bool again = !add(500).contains("not_kept");
    said = said && again && bench.says("what is added is kept again");
    code = report("disk_full", bench, serves && bench.serves(), said);
  }
  umount(disk.path().c_str());
  return code;
}

/// A mesh is loaded that does not fit into what the server may have.
int memory_limit(const std::string& server) {
  const ScratchFolder files;
  constexpr int kCells = 700;
  std::ofstream obj(files.path() + "/big.obj");
  for (int y = 0; y <= kCells; ++y) {
    for (int x = 0; x <= kCells; ++x) obj << "v " << 100 + x << ' ' << y << " 0\n";
  }
  for (int y = 0; y < kCells; ++y) {
    for (int x = 1; x <= kCells; ++x) {
      const int a = y * (kCells + 1) + x;
      obj << "f " << a << ' ' << a + 1 << ' ' << a + kCells + 2 << "\nf " << a << ' ' << a + kCells + 2 << ' '
          << a + kCells + 1 << '\n';
    }
  }
  obj.close();
  const ScratchFolder state;
  Bench bench({}, server, state.path());
  if (!bench.serves()) return report("memory_limit", bench, false, false);
  std::ifstream status("/proc/" + std::to_string(bench.server().pid()) + "/status");
  rlim_t size = 0;
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmSize:")) size = std::stoul(line.substr(7)) * 1'024;
  }
  const rlimit limit{size + (rlim_t{96} << 20), RLIM_INFINITY};
  if (prlimit(bench.server().pid(), RLIMIT_AS, &limit, nullptr) != 0) return cannot_run("a limit of memory");
  std::atomic<bool> over{false};
  std::thread alive([&] {
    while (!over.load()) bench.keep_alive(), std::this_thread::sleep_for(50ms);
  });
  bool said = true;
  for (int i = 0; i < 3; ++i) {
    const Result<std::string> loaded =
        bench.client().command("load", nlohmann::json{{"path", files.path() + "/big.obj"}}.dump(), {}, 30s);
    if (!loaded) std::fprintf(stderr, "load: %s\n", loaded.error().message.c_str());
    said = said && !loaded && loaded.error().code == ErrorCode::refused &&
           loaded.error().message.find("memory") != std::string::npos;
  }
  over.store(true);
  alive.join();
  const bool serves = bench.serves();
  const rlimit none{RLIM_INFINITY, RLIM_INFINITY};
  prlimit(bench.server().pid(), RLIMIT_AS, &none, nullptr);
  const double grown = bench.grown_mib();
  std::printf("refused with %.0f MiB more than at first\n", grown);
  return report("memory_limit", bench, serves, said);
}

/// Definitions of 200 MB from a participant without our limits.
int run_bomb(int domain) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setenv("CYCLONEDDS_URI",
         "<General><Interfaces><NetworkInterface name=\"lo\" "
         "multicast=\"false\"/></Interfaces><AllowMulticast>false</AllowMulticast>"
         "<MaxMessageSize>65500B</MaxMessageSize><FragmentSize>65000B</FragmentSize></General>"
         "<Discovery><ParticipantIndex>none</ParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers>"
         "<MaxAutoParticipantIndex>120</MaxAutoParticipantIndex></Discovery>",
         1);
  const dds::Participant participant({.domain = domain});
  const dds::Topic<wire::Definition> topic(participant, "collided");
  dds::Writer<wire::Definition> writer(topic, {.lease_ns = 60'000'000'000, .max_blocking_ns = 2'000'000'000});
  if (!wait_until([&] { return writer.matched_readers() > 0; }, 10s)) return 2;
  const std::vector<std::uint8_t> bomb(200'000'000, 7);
  for (std::uint32_t i = 0; i < 3; ++i) {
    dds::Sample<wire::Definition> definition;
    definition->publisher = 77;
    definition->incarnation = 1;
    definition->object_number = i;
    definition->sequence_number = i + 1;
    static_cast<void>(dds::set_text(definition->name, "bomb"));
    dds::borrow(definition->shape, bomb);
    std::printf("write %u: %d\n", i, writer.write(*definition) ? 1 : 0);
    std::fflush(stdout);
  }
  std::this_thread::sleep_for(2s);
  std::printf("done\n");
  std::fflush(stdout);
  return 0;
}

int sample_bomb(const std::string& self, const std::string& server) {
  const ScratchFolder state;
  Bench bench({}, server, state.path());
  ChildProcess bomber({self, "--bomb", std::to_string(own_domain())}, bench.folder().path(), "bomber");
  double most_mib = 0;
  bool serves = bench.serves();
  const bool over = wait_until(
      [&] {
        most_mib = std::max(most_mib, bench.grown_mib());
        bench.keep_alive();
        return bomber.wait(0ms) != -1;
      },
      60s, 20ms);
  const bool thrown = over && bomber.output().find("done") != std::string::npos;
  if (!thrown) std::fprintf(stderr, "the bomber: %s%s\n", bomber.output().c_str(), bomber.errors().c_str());
  std::printf("at most %.0f MiB more while they came\n", most_mib);
  serves = serves && bench.serves() && most_mib <= kBudget_mib;
  return report("sample_bomb", bench, serves, thrown);
}

/// The time of day jumps an hour on, two back and one on again, the server's and then the publisher's.
int clock_jump(const std::string& server, const std::string& preload) {
  const ScratchFolder files;
  const std::string path = files.path() + "/shift";
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0 || ftruncate(file, sizeof(std::int64_t)) != 0) return 2;
  auto* shift = static_cast<volatile std::int64_t*>(
      mmap(nullptr, sizeof(std::int64_t), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0));
  close(file);
  const ScratchFolder state;
  Bench bench({"/usr/bin/env", "LD_PRELOAD=" + preload, "COLLIDED_CLOCK_SHIFT=" + path}, server, state.path());
  constexpr std::int64_t kHour_ns = 3'600'000'000'000;
  bool serves = bench.serves();
  const auto started = SteadyClock::now();
  const std::chrono::nanoseconds first = value_of(bench.client().status(), "status").world_time;
  for (const std::int64_t hours : {1, -1, 0}) {
    *shift = hours * kHour_ns;
    for (int i = 0; i < 5; ++i) {
      serves = bench.serves() && serves;
      std::this_thread::sleep_for(100ms);
    }
  }
  const double world_ms =
      1e-6 * static_cast<double>((value_of(bench.client().status(), "status").world_time - first).count());
  const double drift_ms = std::abs(world_ms - ms_since(started));
  // A publisher's clock: its poses are neither held back nor old.
  const auto now = [] { return std::chrono::system_clock::now().time_since_epoch(); };
  double oldest_ms = 0;
  for (const std::int64_t hours : {1, -1, 1, 0}) {
    serves = bench.serves(std::chrono::nanoseconds(now()) + std::chrono::hours(hours)) && serves;
    const RayQuestion down{.origin = {6, 0, 5}, .direction = {0, 0, -1}};
    const Result<Answers> answers = bench.client().ask(std::span(&down, 1));
    serves = serves && answers && answers->oldest_pose_age;
    if (answers && answers->oldest_pose_age)
      oldest_ms = std::max(oldest_ms, 1e-6 * static_cast<double>(answers->oldest_pose_age->count()));
  }
  std::printf("world time drifted %.0f ms, oldest pose %.0f ms\n", drift_ms, oldest_ms);
  // Statuses come every 50 ms; a pose is shifted by a second at most before its publisher's clock is known anew.
  const bool keeps_time = drift_ms < 500 && oldest_ms < 1'500;
  return report("clock_jump", bench, serves && keeps_time && bench.is_quiet(), true);
}

/// Steady clocks that pass 2^32 milliseconds, 49.7 days, while it runs. Exec takes on the namespace.
int run_long_up(char** words) {
  constexpr long kBefore_s = 4'294'967 - 6;
  std::ifstream uptime("/proc/uptime");
  double up_s = 0;
  uptime >> up_s;
  if (unshare(CLONE_NEWTIME) != 0) return kCannotRun;
  std::ofstream offsets("/proc/self/timens_offsets");
  const long shift_s = kBefore_s - static_cast<long>(up_s);
  offsets << "monotonic " << shift_s << " 0\nboottime " << shift_s << " 0\n";
  offsets.close();
  if (!offsets) return kCannotRun;
  execv(words[0], words);
  return kCannotRun;
}

int uptime(const std::string& self, const std::string& server) {
  if (geteuid() != 0) return cannot_run("a time namespace");
  const ScratchFolder state;
  Bench bench({self, "--long-up"}, server, state.path());
  const auto namespace_of = [](const std::string& pid) {
    return std::filesystem::read_symlink("/proc/" + pid + "/ns/time").string();
  };
  if (namespace_of(std::to_string(bench.server().pid())) == namespace_of("self"))
    return cannot_run("a time namespace that exec takes on");
  bool serves = true;
  int rounds = 0;
  for (const auto started = SteadyClock::now(); ms_since(started) < 10'000; ++rounds) {
    serves = bench.serves() && serves;
    std::this_thread::sleep_for(50ms);
  }
  std::printf("%d rounds across 49.7 days\n", rounds);
  return report("uptime", bench, serves && bench.is_quiet(), true);
}

int run(const std::string& self, const std::string& server, const std::string& preload, const std::string& name) {
  if (name == "disk_full") return disk_full(server);
  if (name == "memory_limit") return memory_limit(server);
  if (name == "sample_bomb") return sample_bomb(self, server);
  if (name == "clock_jump") return clock_jump(server, preload);
  if (name == "uptime") return uptime(self, server);
  std::fprintf(stderr, "no case '%s'\n", name.c_str());
  return 2;
}

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  using namespace collided::testing_support;
  const std::string first = argc > 1 ? argv[1] : "";
  if (argc == 3 && first == "--bomb") return run_bomb(std::atoi(argv[2]));
  if (argc > 3 && first == "--long-up") return run_long_up(argv + 2);
  if (argc == 4) return run(argv[0], first, argv[2], argv[3]);
  std::fprintf(stderr, "usage: adverse SERVER SHIFTED_CLOCK disk_full|memory_limit|sample_bomb|clock_jump|uptime\n");
  return 2;
}
