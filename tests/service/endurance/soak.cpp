// Objects, publishers, clients, meshes and scenes that come and go for as long as is asked, and what is left of them:
//   soak SERVER SECONDS WARM_UP_SECONDS [RECORDER_SECONDS]
// Prints one line; exits 1 where memory grows, files stay open, a count goes back or something is not answered. An hour
// shows a slope; less only what is lost at a rate that nobody could live with.

#include <sys/prctl.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"
#include "tests/service/endurance/process_figures.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;

constexpr double kMostSlope_mib_h = 1;
/// A slope of so little counts only over so long; before that growth does.
constexpr double kSlopeCounts_s = 1'800;
constexpr double kMostGrowth_mib = 4;
constexpr std::chrono::milliseconds kPace{600};

struct Look {
  double time_s = 0;
  double mib = 0;
  int files = 0;
};

/// Least squares, MiB per hour.
double slope_of(const std::vector<Look>& looks) {
  double time = 0, mib = 0, time_squared = 0, product = 0;
  const auto count = static_cast<double>(looks.size());
  for (const Look& look : looks) {
    time += look.time_s, mib += look.mib;
    time_squared += look.time_s * look.time_s, product += look.time_s * look.mib;
  }
  const double divisor = count * time_squared - time * time;
  return divisor > 0 ? 3'600 * (count * product - time * mib) / divisor : 0;
}

/// From the first third to the last, MiB: the medians, since a single look may fall into a moment that needs more.
double growth_of(const std::vector<Look>& looks) {
  const auto median = [](std::vector<Look> some) {
    const auto middle = some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2);
    std::nth_element(some.begin(), middle, some.end(), [](const Look& a, const Look& b) { return a.mib < b.mib; });
    return middle->mib;
  };
  const auto third = static_cast<std::ptrdiff_t>(looks.size() / 3);
  if (third == 0) return 0;
  return median({looks.end() - third, looks.end()}) - median({looks.begin(), looks.begin() + third});
}

MeshShape tetrahedron(double size) {
  return {.vertices = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}},
          .triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

// ---- guests, in processes of their own, since they come, ask, move things and go without a word

int run_guest(int domain, std::uint64_t seed) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> coordinate(0, 9);
  std::uniform_real_distribution<double> motion(-0.05, 0.05);
  Client client = value_of(Client::connect({.domain = domain, .wait = 10s}), "connect");
  Watch watch = value_of(client.watch(), "watch");
  Publisher publisher = value_of(client.publish("guest"), "publish");
  std::vector<Publisher::Object> objects;
  std::vector<Vec3> places;
  for (int i = 0; i < 20; ++i) {
    places.emplace_back(100 + coordinate(random), coordinate(random), coordinate(random));
    const ShapePart part = i % 2 == 0 ? ShapePart(SphereShape{.radius_m = 0.5})
                                      : ShapePart(tetrahedron(0.5 + 1e-6 * static_cast<double>(random() % 1'000'000)));
    objects.push_back(value_of(publisher.add({.name = std::to_string(seed) + "/" + std::to_string(i),
                                              .shape = {part},
                                              .pose = {.position = places.back()},
                                              .lost_policy = i % 4 == 0 ? LostPolicy::freeze : LostPolicy::remove}),
                               "add"));
  }
  for (int round = 0; round < 20; ++round) {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      places[i] += Vec3(motion(random), motion(random), motion(random));
      static_cast<void>(publisher.move(objects[i], {.position = places[i]}));
    }
    static_cast<void>(publisher.flush());
    std::this_thread::sleep_for(10ms);
    // Few, so that less than 1 MiB a second is recorded: how much of its memory the recorder's ring gives back, and how much
    // the window holds, would else change with how fast the machine is at the time.
    std::vector<RayQuestion> rays(60, RayQuestion{.origin = {103, 3, 20}, .direction = {0, 0, -1}});
    value_of(client.ask(std::span<const RayQuestion>(rays)), "ask");
    while (watch.next(0ns)) {}
  }
  // Half of them leave without a word: what stays of those is removed later.
  if (seed % 2 == 0) std::_Exit(0);
  return 0;
}

class Soak {
 public:
  /// recorder  how far back the flight recorder keeps: memory grows until it is full
  Soak(std::string self, const std::string& server, const std::string& recorder)
      : self_(std::move(self)),
        server_(
            {server, "--domain", std::to_string(domain_), "--state-dir", folder_.path(), "--flight-recorder", recorder},
            folder_.path(), "server") {
    if (!server_.says("ready:", 20s)) std::exit(2);
    client_.emplace(value_of(Client::connect({.domain = domain_, .wait = 10s}), "connect"));
    scene_ = folder_.write("plate.obj", "v 50 0 0\nv 51 0 0\nv 50 1 0\nf 1 2 3\n");
  }

  void run(std::chrono::seconds time, std::chrono::seconds warm_up) {
    const auto started = SteadyClock::now();
    for (std::uint64_t round = 0; SteadyClock::now() - started < time; ++round) {
      // At an even pace: what is remembered for a time is more where more happens in it.
      std::this_thread::sleep_until(started + kPace * round);
      guest(round);
      things(round);
      if (round % 4 == 0) load_and_clear();
      look(started, warm_up);
      ++rounds_;
    }
  }

  int report() {
    const double slope = slope_of(looks_);
    const double time_s = looks_.empty() ? 0 : looks_.back().time_s - looks_.front().time_s;
    const double growth = growth_of(looks_);
    const auto [fewest, most] = std::minmax_element(looks_.begin(), looks_.end(),
                                                    [](const Look& a, const Look& b) { return a.files < b.files; });
    const int files = looks_.empty() ? 0 : most->files - fewest->files;
    std::printf(
        "rounds=%d seconds=%.0f rss_mib=%.1f rss_growth=%.2f rss_slope=%.2f fds=%d..%d wraps=%d unanswered=%d\n",
        rounds_, time_s, looks_.empty() ? 0 : looks_.back().mib, growth, slope, looks_.empty() ? 0 : fewest->files,
        looks_.empty() ? 0 : most->files, wraps_, unanswered_);
    const bool is_flat = time_s >= kSlopeCounts_s ? slope < kMostSlope_mib_h : growth < kMostGrowth_mib;
    const bool kept = !looks_.empty() && is_flat && files == 0 && wraps_ == 0 && unanswered_ == 0;
    if (!kept) std::fprintf(stderr, "the server said:\n%s", server_.errors().c_str());
    return kept ? 0 : 1;
  }

 private:
  void guest(std::uint64_t round) {
    ChildProcess guest({self_, "--guest", std::to_string(domain_), std::to_string(round)}, folder_.path(), "guest");
    if (guest.wait(30s) != 0) {
      ++unanswered_;
      std::fprintf(stderr, "guest %llu: %s\n", static_cast<unsigned long long>(round), guest.errors().c_str());
    }
  }
  void expect(const Result<std::string>& answer, const char* what) {
    if (answer) return;
    ++unanswered_;
    std::fprintf(stderr, "%s: %s\n", what, answer.error().message.c_str());
  }
  /// Objects by command, each with a mesh of its own.
  void things(std::uint64_t round) {
    for (int i = 0; i < 10; ++i) {
      const nlohmann::json arguments{{"name", "thing " + std::to_string(i)}, {"pose", {200.0 + i, 0, 0, 1, 0, 0, 0}}};
      expect(client_->command("add", arguments.dump(),
                              {tetrahedron(0.3 + 1e-9 * static_cast<double>(10 * round) + 1e-10 * i)}),
             "add");
    }
    expect(client_->command("remove", R"({"name": "thing *"})"), "remove");
    // What the last guest but one left frozen; it is known to be lost by now.
    if (round >= 2)
      static_cast<void>(client_->command("remove", nlohmann::json{{"name", std::to_string(round - 2) + "/*"}}.dump()));
  }
  void load_and_clear() {
    expect(client_->command("load", nlohmann::json{{"path", scene_}, {"name", "plate"}}.dump()), "load");
    expect(client_->command("clear", R"({"scene": "plate"})"), "clear");
  }
  void look(SteadyClock::time_point started, std::chrono::seconds warm_up) {
    const ServerStatus status = value_of(client_->status(), "status");
    const std::map<std::string, std::uint64_t> counts{{"version", status.version},
                                                      {"events", status.last_event_sequence},
                                                      {"poses", status.poses_applied},
                                                      {"answers", status.questions_answered}};
    for (const auto& [name, count] : counts) {
      if (count < counts_[name]) ++wraps_, std::fprintf(stderr, "%s went back\n", name.c_str());
      counts_[name] = count;
    }
    const double time_s = 1e-3 * ms_since(started);
    if (time_s >= static_cast<double>(warm_up.count()))
      looks_.push_back({time_s, resident_mib(server_.pid()), open_files(server_.pid())});
  }

  std::string self_;
  ScratchFolder folder_;
  int domain_ = own_domain();
  ChildProcess server_;
  std::optional<Client> client_;
  std::string scene_;
  std::vector<Look> looks_;
  std::map<std::string, std::uint64_t> counts_;
  int rounds_ = 0;
  int wraps_ = 0;
  int unanswered_ = 0;
};

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  using namespace collided::testing_support;
  if (argc == 4 && std::string(argv[1]) == "--guest")
    return run_guest(std::atoi(argv[2]), std::strtoull(argv[3], nullptr, 10));
  if (argc != 4 && argc != 5) {
    std::fprintf(stderr, "usage: soak SERVER SECONDS WARM_UP_SECONDS [RECORDER_SECONDS]\n");
    return 2;
  }
  Soak soak(argv[0], argv[1], std::string(argc == 5 ? argv[4] : "30") + "s");
  soak.run(std::chrono::seconds(std::atoi(argv[2])), std::chrono::seconds(std::atoi(argv[3])));
  return soak.report();
}
