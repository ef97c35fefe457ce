// A server, a watcher beside it, and behind a bad network two to five publishers, each a process with a rate, a phase, jitter
// and delays of its own, whose bodies come near each other in lanes:
//   crossings SERVER CROSSINGS LANES
// What is told of each pair is compared with what follows from the pose lists alone. In network namespaces of its own;
// without the right to make them it says so and exits 77. Prints a line; exits 1 where a contact was missed, one was told that
// never was, or a bracket does not hold the truth; 2 where nothing could be measured. A round in which a publisher got no
// processor for longer than its lease, and was lost, is played again. COLLIDED_SEED: another run.

#include <algorithm>
#include <atomic>
#include <cinttypes>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>

#include "tests/oracle/meeting_oracle.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/endurance/crossing_round.hpp"
#include "tests/service/endurance/measuring.hpp"
#include "tests/service/network/tap_hub.hpp"

namespace collided::testing_support {
using namespace engine;
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr int kCannotRun = 77;
constexpr std::chrono::milliseconds kSignOfLife{100};  // well within a publisher's lease

// ---- a publisher -----------------------------------------------------------------------------------------------------

std::string body_name(std::uint64_t seed, std::size_t body) {
  return std::to_string(seed) + "/" + std::to_string(body);
}

nanoseconds now() {
  return std::chrono::duration_cast<nanoseconds>(std::chrono::system_clock::now().time_since_epoch());
}

void stop_without(bool taken, const char* what) {
  if (taken) return;
  std::fprintf(stderr, "%s\n", what);
  std::exit(2);
}

ShapePart shape_of(const oracle::MovingBody& body) {
  if (const double* radius = std::get_if<double>(&body.form)) return SphereShape{.radius_m = *radius};
  return BoxShape{.half_m = std::get<Vec3>(body.form)};
}

/// One of a round's publishers, told by files in a folder when to begin and when to leave.
class CrossingProcess {
 public:
  CrossingProcess(char** words)
      : seed_(std::strtoull(words[0], nullptr, 10)),
        round_(crossing_round(seed_, std::strtoull(words[1], nullptr, 10))),
        number_(std::strtoull(words[2], nullptr, 10)),
        folder_(words[4]),
        client_(value_of(Client::connect({.domain = std::atoi(words[3]), .interface = "collided1", .wait = 20s}),
                         "connect")),
        publisher_(value_of(client_.publish("publisher " + std::to_string(number_),
                                            {.gap = round_.publishers[number_].streamed ? nanoseconds(kStreamedGapNs)
                                                                                        : PublishOptions{}.gap}),
                            "publish")) {}

  void run() {
    if (round_.publishers[number_].streamed) publisher_.stream();
    for (std::size_t i = 0; i < round_.bodies.size(); ++i) {
      if (round_.bodies[i].publisher == number_) add(i);
    }
    // From its first word on its time is its own.
    flush(now());
    say_applied("ready");
    const nanoseconds start(std::stoll(wait_for("start")));
    for (const CrossingFlush& batch : round_.publishers[number_].flushes) {
      sleep_until(start + nanoseconds(batch.sent_ns));
      for (const auto& [body, at] : batch.poses) value_of(publisher_.move(objects_.at(body), {.position = at}), "move");
      flush(start + nanoseconds(batch.stamp_ns));
    }
    say_applied("done");
    wait_for("leave");
  }

 private:
  void add(std::size_t body) {
    const oracle::MovingBody& moving = round_.bodies[body].moving;
    objects_[body] = value_of(publisher_.add({.name = body_name(seed_, body),
                                              .shape = {shape_of(moving)},
                                              .pose = {.position = moving.instants.front().position}}),
                              "add");
  }
  void flush(nanoseconds stamp) {
    stop_without(publisher_.flush(stamp).operator bool(), "the server takes nothing more");
  }
  void say_applied(const char* what) {
    stop_without(publisher_.wait_applied(20s).operator bool(), "the server has not applied everything");
    std::puts(what);
    std::fflush(stdout);
  }
  void live() { static_cast<void>(publisher_.keep_alive()); }
  void sleep_until(nanoseconds until) {
    for (; now() + kSignOfLife < until; live()) std::this_thread::sleep_for(kSignOfLife);
    std::this_thread::sleep_for(until - now());
  }
  std::string wait_for(const std::string& file) {
    std::string text;
    const auto is_there = [&] {
      live();
      return static_cast<bool>(std::getline(std::ifstream(folder_ + "/" + file), text));
    };
    stop_without(wait_until(is_there, 60s, 20ms), "nobody says how it goes on");
    return text;
  }

  std::uint64_t seed_;
  CrossingRound round_;
  std::size_t number_;
  std::string folder_;
  Client client_;
  Publisher publisher_;
  std::map<std::size_t, Publisher::Object> objects_;
};

// ---- the judge -------------------------------------------------------------------------------------------------------

using Pair = std::pair<std::string, std::string>;

/// All that a subscriber on the server's side is told, by pair.
class CrossingWatcher {
 public:
  explicit CrossingWatcher(int domain)
      : client_(value_of(Client::connect({.domain = domain, .interface = "collided0", .wait = 20s}), "connect")),
        watch_(value_of(client_.watch({}, [this](const Event& event) { hear(event); }), "watch")) {}

  std::map<Pair, std::vector<Event>> take() {
    const std::lock_guard lock(mutex_);
    return std::move(reported_);
  }
  /// Whether all has come that the server has told up to now.
  bool wait_whole() {
    const auto is_whole = [&] {
      const ServerStatus status = value_of(client_.status(), "status");
      const std::lock_guard lock(mutex_);
      return sequence_ >= status.last_event_sequence;
    };
    // What is applied is decided in the next step, which is over two statuses later.
    int later = 0;
    auto heard = SteadyClock::now();
    const auto is_later = [&] {
      const auto newest = SteadyClock::now() - value_of(client_.status(), "status").age;
      if (newest > heard + 10ms) {
        heard = newest;
        ++later;
      }
      return later >= 2;
    };
    return wait_until(is_later, 10s) && wait_until(is_whole, 10s);
  }
  std::uint64_t resyncs() const { return watch_.resyncs(); }

 private:
  void hear(const Event& event) {
    const std::lock_guard lock(mutex_);
    sequence_ = std::max(sequence_, event.sequence);
    reported_[std::minmax(event.a, event.b)].push_back(event);
  }

  std::mutex mutex_;
  std::uint64_t sequence_ = 0;
  std::map<Pair, std::vector<Event>> reported_;
  Client client_;
  Watch watch_;
};

struct CrossingCounts {
  oracle::MeetingTally tally;
  int rounds = 0;
  int processes = 0;
  int doubtful = 0;  // ended for another reason than that they parted
  int repeated = 0;
};

oracle::Bracket bracket_of(const Event& event, nanoseconds start) {
  const auto at = [&](double seconds_before) {
    return (event.world_time - start).count() - std::llround(1e9 * seconds_before);
  };
  return {at(event.bracket_low_s), at(event.bracket_high_s)};
}

/// began and ended alternate; what does not is a contact that nobody can have seen.
std::vector<oracle::ToldMeeting> meetings_of(const std::vector<Event>& events, nanoseconds start,
                                             CrossingCounts& counts) {
  std::vector<oracle::ToldMeeting> told;
  for (const Event& event : events) {
    counts.doubtful += event.kind == EventKind::ended && event.reason != EndReason::separated ? 1 : 0;
    if (event.kind != EventKind::ended) told.push_back({.began = bracket_of(event, start), .ended = {}});
    else if (!told.empty() && !told.back().ended) told.back().ended = bracket_of(event, start);
    else ++counts.tally.invented;
  }
  return told;
}

void judge(const CrossingRound& round, std::uint64_t seed, nanoseconds start, std::map<Pair, std::vector<Event>> told,
           CrossingCounts& counts) {
  for (std::size_t a = 0; a < round.bodies.size(); a += 2) {
    const Pair pair = std::minmax(body_name(seed, a), body_name(seed, a + 1));
    const int lies_before = counts.tally.lies();
    const std::vector<Event> events = std::move(told[pair]);
    const std::vector<oracle::ToldMeeting> meetings = meetings_of(events, start, counts);
    oracle::compare(round.bodies[a].moving, round.bodies[a + 1].moving, meetings, counts.tally);
    told.erase(pair);
    if (counts.tally.lies() == lies_before) continue;
    std::fprintf(stderr, "seed %" PRIu64 ": %s and %s by %zu and %zu were told %zu contacts:", seed, pair.first.c_str(),
                 pair.second.c_str(), round.bodies[a].publisher, round.bodies[a + 1].publisher, meetings.size());
    for (const auto& meeting : meetings)
      std::fprintf(stderr, " from %" PRId64 " to %" PRId64, meeting.began.high_ns,
                   meeting.ended ? meeting.ended->low_ns : -1);
    double closest_m = 0;
    for (const auto& truth : oracle::meetings(round.bodies[a].moving, round.bodies[a + 1].moving, closest_m)) {
      std::fprintf(stderr, "; true: from %.1f to %.1f ns", truth.begin_ns.get_d(), truth.end_ns.get_d());
    }
    std::fputc('\n', stderr);
  }
  counts.tally.invented += static_cast<int>(told.size());
  for (const auto& [pair, events] : told) {
    std::fprintf(stderr, "seed %" PRIu64 ": %s and %s of two lanes were told %zu events, first at %" PRId64 " ns\n",
                 seed, pair.first.c_str(), pair.second.c_str(), events.size(),
                 bracket_of(events.front(), start).high_ns);
  }
}

// ---- the stage -------------------------------------------------------------------------------------------------------

/// Server and watcher with their side of the network, made by a thread of its own: namespaces are a thread's.
struct FarSide {
  std::unique_ptr<TapDevice> device;
  std::unique_ptr<ChildProcess> server;
};

class Crossings {
 public:
  Crossings(const std::string& program, const std::string& server) : program_(program), domain_(own_domain()) {
    in_network_of_its_own([&] {
      far_.device = std::make_unique<TapDevice>("collided0", 1);
      far_.server = std::make_unique<ChildProcess>(
          std::vector<std::string>{server, "--domain", std::to_string(domain_), "--state-dir", folder_.path(),
                                   "--interface", "collided0"},
          folder_.path(), "server");
      if (!far_.server->says("ready:", 20s)) throw std::runtime_error(far_.server->errors());
      watcher_ = std::make_unique<CrossingWatcher>(domain_);
    });
    enter_own_network();
    near_ = std::make_unique<TapDevice>("collided1", 2);
  }

  /// False where a publisher was lost.
  bool perform(std::uint64_t seed, std::size_t lanes, CrossingCounts& counts) {
    const CrossingRound round = crossing_round(seed, lanes);
    if (!link_) link_ = std::make_unique<TapHub>(std::vector<int>{far_.device->file(), near_->file()}, seed);
    link_->set({.loss = 0.01 * static_cast<double>(seed % 3), .reorder = 0.1, .is_cut = false});
    const std::size_t lost_before = publishers_lost();
    const ScratchFolder folder;
    std::vector<std::unique_ptr<ChildProcess>> processes;
    for (std::size_t i = 0; i < round.publishers.size(); ++i) {
      processes.push_back(std::make_unique<ChildProcess>(
          std::vector<std::string>{program_, "--publish", std::to_string(seed), std::to_string(lanes),
                                   std::to_string(i), std::to_string(domain_), folder.path()},
          folder.path(), "publisher" + std::to_string(i)));
    }
    wait_all(processes, "ready");
    const nanoseconds start = now() + 300ms;
    say(folder, "start", std::to_string(start.count()));
    wait_all(processes, "done");
    stop_without(watcher_->wait_whole(), "not all events came");
    const bool is_whole = publishers_lost() == lost_before;
    if (is_whole) judge(round, seed, start, watcher_->take(), counts);
    say(folder, "leave", "now");
    for (const auto& process : processes) stop_without(process->wait(20s) == 0, "a publisher did not leave");
    stop_without(watcher_->wait_whole(), "not all events came");
    watcher_->take();
    ++(is_whole ? counts.rounds : counts.repeated);
    counts.processes += static_cast<int>(processes.size());
    return is_whole;
  }

  std::uint64_t resyncs() const { return watcher_->resyncs(); }
  std::uint64_t lost_frames() const { return link_->lost(); }

 private:
  template <class Make>
  void in_network_of_its_own(Make&& make) {
    std::exception_ptr failure;
    std::thread([&] {
      try {
        enter_own_network();
        make();
      } catch (...) { failure = std::current_exception(); }
    }).join();
    if (failure) std::rethrow_exception(failure);
  }
  /// As the server says it.
  std::size_t publishers_lost() const {
    const std::string said = far_.server->output() + far_.server->errors();
    std::size_t count = 0;
    for (std::size_t at = said.find(" is lost"); at != std::string::npos; at = said.find(" is lost", at + 1)) ++count;
    return count;
  }
  static void wait_all(const std::vector<std::unique_ptr<ChildProcess>>& processes, const char* what) {
    for (const auto& process : processes) {
      if (process->says(what, 40s)) continue;
      std::fprintf(stderr, "a publisher is not %s: %s\n", what, process->errors().c_str());
      std::exit(2);
    }
  }
  /// In one piece: a reader sees all of it or nothing.
  static void say(const ScratchFolder& folder, const std::string& file, const std::string& text) {
    const std::string path = folder.path() + "/" + file;
    std::ofstream(path + ".new") << text << '\n';
    stop_without(std::rename((path + ".new").c_str(), path.c_str()) == 0, "cannot write to the scratch folder");
  }

  ScratchFolder folder_;
  std::string program_;
  int domain_;
  FarSide far_;
  std::unique_ptr<TapDevice> near_;
  std::unique_ptr<TapHub> link_;
  std::unique_ptr<CrossingWatcher> watcher_;
};

int run(char** argv) {
  const int wanted = std::atoi(argv[2]);
  const std::size_t lanes = std::strtoull(argv[3], nullptr, 10);
  const char* asked = std::getenv("COLLIDED_SEED");
  const std::uint64_t first_seed = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 1804;
  Crossings crossings(argv[0], argv[1]);
  CrossingCounts counts;
  const oracle::MeetingTally& tally = counts.tally;
  for (std::uint64_t seed = first_seed; tally.pairs + tally.too_near < wanted; ++seed) {
    while (!crossings.perform(seed, lanes, counts))
      stop_without(counts.repeated < 3 + counts.rounds / 4, "publishers are lost again and again");
  }
  std::printf(
      "crossings=%d meetings=%d missed=%d invented=%d wrong_brackets=%d doubtful=%d too_near=%d rounds=%d repeated=%d "
      "publishers=%d resyncs=%" PRIu64 " lost_frames=%" PRIu64 " COLLIDED_SEED=%" PRIu64 "\n",
      tally.pairs, tally.meetings, tally.missed, tally.invented, tally.wrong_brackets, counts.doubtful, tally.too_near,
      counts.rounds, counts.repeated, counts.processes, crossings.resyncs(), crossings.lost_frames(), first_seed);
  // Of half the pairs or so the bodies meet; were it next to none, nothing would have been shown.
  return tally.lies() == 0 && counts.doubtful == 0 && crossings.resyncs() == 0 && tally.meetings * 10 > tally.pairs ? 0
                                                                                                                    : 1;
}

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  using namespace collided::testing_support;
  if (argc == 7 && std::string(argv[1]) == "--publish") {
    CrossingProcess(argv + 2).run();
    return 0;
  }
  if (argc != 4) {
    std::fprintf(stderr, "usage: crossings SERVER CROSSINGS LANES\n");
    return 2;
  }
  try {
    return run(argv);
  } catch (const std::runtime_error& missing) {
    std::printf("skipped: no network of its own (%s)\n", missing.what());
    return kCannotRun;
  }
}
