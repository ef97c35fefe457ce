// A server on one side of a bad network, a publisher and two subscribers on the other:
//   lossy_network SERVER SECONDS_A_CELL PARTITION_SECONDS LOSS...
// For each LOSS (per cent of the frames, both ways) a cell without and one with frames that overtake others, then a
// partition. Everything in network namespaces of its own, joined by a cable that is this program; without the right to
// make them it says so and exits 77. Prints a line for each cell; exits 1 where a contact was missed or told twice, a
// gap not noticed, or healing took too long.

#include <memory>
#include <stdexcept>
#include <string>

#include "tests/service/child_process.hpp"
#include "tests/service/endurance/moving_crowd.hpp"
#include "tests/service/network/tap_hub.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;

constexpr int kCannotRun = 77;
constexpr double kMostHeal_ms = 2'000;
constexpr std::uint64_t kSeed = 20261122;

/// The server with its side of the network, made and started by a thread of its own: namespaces are a thread's.
struct FarSide {
  std::unique_ptr<TapDevice> device;
  std::unique_ptr<ChildProcess> server;
};

FarSide start_far_side(const std::string& server, const std::string& folder, int domain) {
  FarSide far;
  std::exception_ptr failure;
  std::thread([&] {
    try {
      enter_own_network();
      far.device = std::make_unique<TapDevice>("collided0", 1);
      far.server =
          std::make_unique<ChildProcess>(std::vector<std::string>{server, "--domain", std::to_string(domain),
                                                                  "--state-dir", folder, "--interface", "collided0"},
                                         folder, "server");
    } catch (...) { failure = std::current_exception(); }
  }).join();
  if (failure) std::rethrow_exception(failure);
  return far;
}

class LossyNetwork {
 public:
  LossyNetwork(const std::string& server_path)
      : domain_(own_domain()),
        far_(start_far_side(server_path, folder_.path(), domain_)),
        near_((enter_own_network(), std::make_unique<TapDevice>("collided1", 2))),
        link_({far_.device->file(), near_->file()}, kSeed) {
    if (!far_.server->says("ready:", 20s)) {
      std::fprintf(stderr, "%s", far_.server->errors().c_str());
      std::exit(2);
    }
    for (int i = 0; i < 3; ++i) {
      clients_.push_back(std::make_unique<Client>(
          value_of(Client::connect({.domain = domain_, .interface = "collided1", .wait = 20s}), "connect")));
    }
    crowd_ = std::make_unique<MovingCrowd>(*clients_[0], kSeed);
    for (int i = 1; i < 3; ++i)
      keepers_.push_back(std::make_unique<Bookkeeper>(*clients_[static_cast<std::size_t>(i)]));
    settle(10s);
  }

  void lossy_cell(double loss, double reorder, std::chrono::seconds time) {
    link_.set({.loss = loss, .reorder = reorder, .is_cut = false});
    const std::uint64_t lost = link_.lost();
    const auto until = SteadyClock::now() + time;
    int moves = 0;
    for (; SteadyClock::now() < until; ++moves) {
      static_cast<void>(crowd_->move_all());
      std::this_thread::sleep_for(20ms);
    }
    // The weather stays while they catch up.
    const double settled_ms = settle(20s);
    char name[64];
    std::snprintf(name, sizeof name, "loss%.0f%%%s", 100 * loss, reorder > 0 ? "+reorder" : "");
    report(name, settled_ms, moves, link_.lost() - lost, false);
  }

  /// Half of the balls come to rest meanwhile; the others go on until after the cut.
  void partition(std::chrono::seconds time) {
    link_.set({.loss = 0, .reorder = 0, .is_cut = true});
    const auto cut = SteadyClock::now();
    int moves = 0;
    for (; SteadyClock::now() < cut + time; ++moves) {
      static_cast<void>(
          crowd_->move_first(SteadyClock::now() < cut + time * 3 / 4 ? MovingCrowd::kBalls : MovingCrowd::kBalls / 2));
      std::this_thread::sleep_for(20ms);
    }
    int connected = 0;
    for (const auto& keeper : keepers_) connected += keeper->connected() ? 1 : 0;
    if (connected > 0) std::fprintf(stderr, "%d subscribers take themselves for connected\n", connected);
    broken_ += connected;
    const std::uint64_t lost = link_.lost();
    link_.set({});
    const auto healed = SteadyClock::now();
    for (; SteadyClock::now() < healed + 1s; ++moves) {
      static_cast<void>(crowd_->move_first(MovingCrowd::kBalls / 2));
      std::this_thread::sleep_for(20ms);
    }
    settle(30s);
    report("partition" + std::to_string(time.count()) + "s", ms_since(healed), moves, lost, true);
  }

  int broken() const { return broken_; }

 private:
  /// Until every subscriber holds what touches; how long that took.
  double settle(std::chrono::milliseconds most) {
    const auto since = SteadyClock::now();
    const std::set<NamedPair> truth = crowd_->touching();
    const auto agree = [&] {
      static_cast<void>(crowd_->flush());
      return std::all_of(keepers_.begin(), keepers_.end(), [&](const auto& keeper) { return keeper->holds(truth); });
    };
    wait_until(agree, most, 5ms);
    return ms_since(since);
  }

  void report(const std::string& cell, double ms, int moves, std::uint64_t lost_frames, bool heals) {
    // An ended too many would come now.
    std::this_thread::sleep_for(300ms);
    const std::set<NamedPair> truth = crowd_->touching();
    int missed = 0;
    int dup = 0;
    int gaps = 0;
    std::uint64_t resyncs = 0;
    for (const auto& keeper : keepers_) {
      missed += keeper->differences(truth);
      dup += keeper->take_unpaired();
      gaps += keeper->take_undetected_gaps();
      resyncs += keeper->resyncs();
    }
    std::printf("cell=%s missed=%d dup=%d undetected_gaps=%d %s=%.0f moves=%d lost_frames=%llu resyncs=%llu\n",
                cell.c_str(), missed, dup, gaps, heals ? "heal_ms" : "settle_ms", ms, moves,
                static_cast<unsigned long long>(lost_frames), static_cast<unsigned long long>(resyncs));
    broken_ += missed + dup + gaps + (heals && ms > kMostHeal_ms ? 1 : 0);
  }

  ScratchFolder folder_;
  int domain_;
  FarSide far_;
  std::unique_ptr<TapDevice> near_;
  TapHub link_;
  std::vector<std::unique_ptr<Client>> clients_;
  std::unique_ptr<MovingCrowd> crowd_;
  std::vector<std::unique_ptr<Bookkeeper>> keepers_;
  int broken_ = 0;
};

int run(int argc, char** argv) {
  LossyNetwork network(argv[1]);
  const std::chrono::seconds time(std::atoi(argv[2]));
  for (int i = 4; i < argc; ++i) {
    const double loss = std::atof(argv[i]) / 100;
    network.lossy_cell(loss, 0, time);
    network.lossy_cell(loss, 0.2, time);
  }
  network.partition(std::chrono::seconds(std::atoi(argv[3])));
  return network.broken() == 0 ? 0 : 1;
}

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "usage: lossy_network SERVER SECONDS_A_CELL PARTITION_SECONDS LOSS...\n");
    return 2;
  }
  try {
    return collided::testing_support::run(argc, argv);
  } catch (const std::runtime_error& missing) {
    std::printf("skipped: no network of its own (%s)\n", missing.what());
    return collided::testing_support::kCannotRun;
  }
}
