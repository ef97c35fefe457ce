// Two servers and an etcd, each on a network of its own, which are cut from each other again and again:
//   network_cuts SERVER ROUNDS [SEED] [strict|fast]
// On each server's network is a witness that publishes, hears the events and asks, so that a server that goes on behind a cut
// is seen. A round cuts one place from one or both of the others for up to 6 s, joins them, and waits for a primary and a
// standby that agree; a server that has given way is started again. strict: no two servers may be active in the same moment.
// fast: for a third of the lease, 1 s, at most. Prints how long two were, and how long nobody was heard by whom; exits 1
// where the promise was broken, an answer was wrong or the pair did not heal, 77 without etcd or the right to make networks.

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/service/child_process.hpp"
#include "tests/service/endurance/cut_witness.hpp"
#include "tests/service/endurance/measuring.hpp"
#include "tests/service/etcd_process.hpp"
#include "tests/service/network/tap_hub.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;

constexpr int kCannotRun = 77;
constexpr auto kHeals = 60s;
constexpr double kThirdOfLease_ms = 1'000;
constexpr std::size_t kEtcd = 2;

/// A network with one device; what is started on it is started by a thread of its own: namespaces are a thread's.
class Place {
 public:
  explicit Place(std::size_t number) : number_(number) {
    on_network([&] {
      enter_own_network();
      device_ = std::make_unique<TapDevice>(interface(), static_cast<int>(number_) + 1);
      network_ = ::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC);
    });
  }
  ~Place() { ::close(network_); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  int device() const { return device_->file(); }
  std::string interface() const { return "collided" + std::to_string(number_); }
  std::string address() const { return "10.77.0." + std::to_string(number_ + 1); }
  std::unique_ptr<ChildProcess> start(const std::vector<std::string>& words, const std::string& folder,
                                      const std::string& name) {
    std::unique_ptr<ChildProcess> process;
    on_network([&] { process = std::make_unique<ChildProcess>(words, folder, name); });
    return process;
  }

 private:
  template <class Work>
  void on_network(Work&& work) {
    std::exception_ptr failure;
    std::thread([&] {
      try {
        if (network_ >= 0 && ::setns(network_, CLONE_NEWNET) != 0)
          throw std::runtime_error(std::string("setns: ") + std::strerror(errno));
        work();
      } catch (...) { failure = std::current_exception(); }
    }).join();
    if (failure) std::rethrow_exception(failure);
  }

  const std::size_t number_;
  std::unique_ptr<TapDevice> device_;
  int network_ = -1;
};

/// What the witnesses saw of one server's start.
struct SeenEpoch {
  std::int64_t first_ns = INT64_MAX;  // by then it was active
  std::int64_t last_ns = 0;           // it was active after that
};

class NetworkCuts {
 public:
  NetworkCuts(std::string program, std::string server, std::uint64_t seed, std::string mode)
      : random_(seed),
        domain_(own_domain()),
        program_(std::move(program)),
        server_(std::move(server)),
        mode_(std::move(mode)) {
    for (std::size_t i = 0; i < 3; ++i) places_.push_back(std::make_unique<Place>(i));
    hub_ = std::make_unique<TapHub>(std::vector<int>{places_[0]->device(), places_[1]->device(), places_[2]->device()},
                                    seed);
    const std::string client = "http://" + places_[kEtcd]->address() + ":2379";
    etcd_ = places_[kEtcd]->start({"/usr/bin/etcd", "--data-dir", folder_.path() + "/etcd", "--listen-client-urls",
                                   client, "--advertise-client-urls", client, "--listen-peer-urls",
                                   "http://127.0.0.1:2380", "--logger", "zap", "--log-outputs", "stdout"},
                                  folder_.path(), "etcd");
    if (!etcd_->says("serving", 20s)) stop_with("etcd does not start: " + etcd_->output());
    for (std::size_t side = 0; side < 2; ++side) {
      start_server(side);
      if (!servers_[side]->says("ready:", 30s)) stop_with(servers_[side]->errors());
    }
    add_wall();
    for (std::size_t side = 0; side < 2; ++side) {
      witnesses_[side] = places_[side]->start(
          {program_, "--witness", std::to_string(domain_), places_[side]->interface(), name(side), fleet_path(side)},
          folder_.path(), "witness-" + name(side));
    }
    if (!heal()) stop_with("no pair at the beginning");
  }

  int run(int rounds) {
    int done = 0;
    for (; done < rounds; ++done)
      if (!one_round(done)) break;
    // What was on its way is heard.
    std::this_thread::sleep_for(1s);
    return report(done, rounds);
  }

 private:
  enum class Cut { primary, standby, etcd, servers, primary_from_etcd, standby_from_etcd };
  static std::string name(std::size_t side) { return side == 0 ? "a" : "b"; }
  std::string fleet_path(std::size_t side) const { return folder_.path() + "/fleet-" + name(side); }
  [[noreturn]] static void stop_with(const std::string& why) {
    std::fprintf(stderr, "%s\n", why.c_str());
    std::exit(2);
  }
  std::uint64_t below(std::uint64_t bound) { return random_() % bound; }

  void start_server(std::size_t side) {
    servers_[side] = places_[side]->start(
        {server_, "--domain", std::to_string(domain_), "--interface", places_[side]->interface(), "--member",
         name(side), "--state-dir", folder_.path() + "/state-" + name(side), "--join", "collided", "--take-over-after",
         "200ms", "--authority", "etcd://" + places_[kEtcd]->address() + ":2379", "--authority-mode", mode_},
        folder_.path(), name(side) + std::to_string(starts_++));
  }

  /// A static wall that every question is about.
  void add_wall() {
    const std::string collide = server_.substr(0, server_.rfind('/')) + "/../client/cli/collide";
    std::unique_ptr<ChildProcess> add =
        places_[0]->start({collide, "add", "wall", "box", "2", "100", "2", "--at", "0", "0", "80", "--domain",
                           std::to_string(domain_), "--interface", places_[0]->interface()},
                          folder_.path(), "add");
    if (add->wait(20s) != 0) stop_with("the wall is not added: " + add->errors());
  }

  struct SeenFleet {
    std::int64_t seen_ns = 0;
    std::size_t faults = 1;
    std::map<std::string, std::string> roles;  // of members that are ready and were compared
    std::size_t members = 0;
  };
  SeenFleet seen_by(std::size_t side) const {
    SeenFleet seen;
    std::ifstream in(fleet_path(side));
    in >> seen.seen_ns >> seen.faults;
    std::string member, role, state;
    bool is_hashed = false;
    while (in >> member >> role >> state >> is_hashed) {
      ++seen.members;
      if (state == "ready" && is_hashed) seen.roles[member] = role;
    }
    return seen;
  }
  /// Both witnesses see one primary and one standby that agree.
  bool is_whole(std::int64_t since_ns) {
    for (std::size_t side = 0; side < 2; ++side) {
      const SeenFleet seen = seen_by(side);
      // Looking takes 1.5 s.
      if (seen.seen_ns < since_ns + 1'600'000'000 || seen.faults != 0 || seen.members != 2) return false;
      for (std::size_t i = 0; i < 2; ++i) {
        const auto found = seen.roles.find(name(i));
        if (found == seen.roles.end()) return false;
        if (found->second == "primary") primary_ = i;
      }
    }
    return true;
  }
  /// Starts again what has given way, as systemd would, until there is a pair again.
  bool heal() {
    const std::int64_t since_ns = std::chrono::nanoseconds(SteadyClock::now().time_since_epoch()).count();
    const auto is_healed = [&] {
      for (std::size_t side = 0; side < 2; ++side) {
        const int code = servers_[side]->wait(1ms);
        if (code == -1) continue;
        ++ended_with_[code];
        start_server(side);
      }
      return is_whole(since_ns);
    };
    return wait_until(is_healed, kHeals, 100ms);
  }

  void set(Cut cut, bool is_cut) {
    const std::size_t standby = 1 - primary_;
    if (cut == Cut::primary || cut == Cut::standby || cut == Cut::servers) hub_->cut(primary_, standby, is_cut);
    if (cut == Cut::primary || cut == Cut::etcd || cut == Cut::primary_from_etcd) hub_->cut(primary_, kEtcd, is_cut);
    if (cut == Cut::standby || cut == Cut::etcd || cut == Cut::standby_from_etcd) hub_->cut(standby, kEtcd, is_cut);
  }

  bool one_round(int round) {
    const Cut cut = static_cast<Cut>(below(6));
    const std::chrono::milliseconds lasts(200 + below(5'800));
    set(cut, true);
    std::this_thread::sleep_for(lasts);
    set(cut, false);
    const auto healing = SteadyClock::now();
    if (!heal()) {
      std::printf("round %d, cut %d of %lld ms: no pair after a minute\n", round, static_cast<int>(cut),
                  static_cast<long long>(lasts.count()));
      for (std::size_t side = 0; side < 2; ++side) {
        std::ifstream fleet(fleet_path(side));
        std::printf("witness %s sees:\n%s\n%s\n", name(side).c_str(),
                    std::string(std::istreambuf_iterator<char>(fleet), {}).c_str(), servers_[side]->errors().c_str());
      }
      return false;
    }
    heal_ms_.push_back(ms_since(healing));
    return true;
  }

  void read(const std::string& lines) {
    std::istringstream in(lines);
    std::string line;
    while (std::getline(in, line)) {
      std::istringstream words(line);
      std::string kind;
      std::uint64_t epoch = 0;
      std::int64_t at_ns = 0;
      words >> kind;
      if (kind == kRefusedLine) {
        ++refused_;
        continue;
      }
      if (!(words >> epoch >> at_ns)) continue;
      SeenEpoch& seen = epochs_[epoch];
      seen.last_ns = std::max(seen.last_ns, at_ns);
      if (kind == kEventLine) {
        ++events_;
        seen.first_ns = std::min(seen.first_ns, at_ns);
      } else {
        std::string how;
        words >> how;
        ++answers_[how];
      }
    }
  }

  int report(int done, int rounds) {
    for (const auto& witness : witnesses_) read(witness->output());
    double together_ms = 0;
    int overlaps = 0;
    std::int64_t last_ns = 0;
    for (const auto& [epoch, seen] : epochs_) {
      if (last_ns > seen.first_ns) {
        ++overlaps;
        together_ms = std::max(together_ms, static_cast<double>(last_ns - seen.first_ns) / 1e6);
      }
      last_ns = std::max(last_ns, seen.last_ns);
    }
    std::printf("%s: %d cuts, %zu servers were active one after another; two at once %d times, for %.0f ms at most\n",
                mode_.c_str(), done, epochs_.size(), overlaps, together_ms);
    std::printf(
        "%zu events heard; of the questions %zu were answered right, %zu undecided, %zu wrong, %zu not at all\n",
        events_, answers_["right"], answers_["undecided"], answers_["wrong"], refused_);
    std::printf("a pair again after p50 %.1f s, longest %.1f s; servers that ended:", percentile(heal_ms_, 0.5) / 1e3,
                percentile(heal_ms_, 1) / 1e3);
    for (const auto& [code, count] : ended_with_) std::printf(" %d with %d", count, code);
    std::printf("\n");
    const double most_ms = mode_ == "strict" ? 0 : kThirdOfLease_ms;
    const bool is_kept = together_ms <= most_ms && answers_["wrong"] == 0 && done == rounds && epochs_.size() > 1;
    return is_kept ? 0 : 1;
  }

  std::mt19937_64 random_;
  ScratchFolder folder_;
  const int domain_;
  const std::string program_;
  const std::string server_;
  const std::string mode_;
  std::vector<std::unique_ptr<Place>> places_;
  std::unique_ptr<TapHub> hub_;
  std::unique_ptr<ChildProcess> etcd_;
  std::array<std::unique_ptr<ChildProcess>, 2> servers_;
  std::array<std::unique_ptr<ChildProcess>, 2> witnesses_;
  int starts_ = 0;
  std::size_t primary_ = 0;
  std::vector<double> heal_ms_;
  std::map<int, int> ended_with_;
  std::map<std::uint64_t, SeenEpoch> epochs_;
  std::size_t events_ = 0;
  std::map<std::string, std::size_t> answers_;  // by how they were
  std::size_t refused_ = 0;
};

}  // namespace
}  // namespace collided::testing_support

int main(int count, char** words) {
  using namespace collided::testing_support;
  if (count == 6 && std::string(words[1]) == "--witness")
    return run_cut_witness(std::atoi(words[2]), words[3], words[4], words[5]);
  if (count < 3) return 2;
  if (!has_etcd()) return kCannotRun;
  const std::uint64_t seed = count > 3 ? std::strtoull(words[3], nullptr, 10) : 28;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  std::fflush(stdout);
  try {
    enter_own_network();  // as somebody who may make further ones
    NetworkCuts cuts(words[0], words[1], seed, count > 4 ? words[4] : "strict");
    return cuts.run(std::atoi(words[2]));
  } catch (const std::runtime_error& missing) {
    std::printf("skipped: no network of its own (%s)\n", missing.what());
    return kCannotRun;
  }
}
