// The server is killed without warning amid add, move, rm, load, upload, clear and the removal of a scene's part, then
// the files that it left are damaged one at a time:
//   kept_over_kills SERVER KILLS DAMAGES [SEED]
// Prints one line and exits 1 where something acknowledged was lost, something removed came back, a move was undone, or
// a damage took something without a word.

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <thread>

#include "collided/client.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;

constexpr int kThings = 8;
/// Three parts, "SCENE/a" to "SCENE/c".
constexpr const char* kFile =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\nv 5 0 0\nv 6 0 0\nv 5 1 0\no b\nf 4 5 6\n"
    "v 9 0 0\nv 10 0 0\nv 9 1 0\no c\nf 7 8 9\n";

/// The x of each object by name; 0 for the parts of scenes.
using World = std::map<std::string, double>;

class KeptOverKills {
 public:
  KeptOverKills(std::string server, std::uint64_t seed)
      : server_path_(std::move(server)), random_(seed), file_(folder_.write("hall.obj", kFile)) {
    std::filesystem::create_directories(state_dir());
    start();
    wait_until_ready();
  }

  /// Works until the kill comes, then compares what the next server has with what the last one had acknowledged.
  void kill_once() {
    World before = world_;
    World after = world_;
    std::atomic<bool> is_killed{false};
    std::thread killer([&, delay_us = random_() % 120'000] {
      std::this_thread::sleep_for(std::chrono::microseconds(delay_us));
      is_killed.store(true);
      server_->signal(SIGKILL);
    });
    while (!is_killed.load()) {
      before = after;
      if (!change(after)) break;
      ++acknowledged_;
      before = after;
    }
    killer.join();
    server_->wait(5s);
    start();
    wait_until_ready();
    compare(before, after);
  }

  /// Damages one file of what a killed server left, and starts the next one on it.
  void damage_once(const std::string& kept) {
    namespace fs = std::filesystem;
    server_->signal(SIGKILL);
    server_->wait(5s);
    fs::remove_all(state_dir());
    fs::copy(kept, state_dir(), fs::copy_options::recursive);
    const std::string path = damage();
    start();
    // A server that lacks something is not ready before that is accepted, so the first of the two decides.
    static_cast<void>(wait_for([&] { return state() == "ready" || losses("show") > 0; }, 30s));
    const bool is_ready = state() == "ready";
    const World now = list();
    const bool is_all_there = now == world_;
    if (is_ready && !is_all_there) {
      ++silent_;
      std::fprintf(stderr, "silent loss after a damage to %s: %zu of %zu objects\n%s", path.c_str(), now.size(),
                   world_.size(), server_->errors().c_str());
    }
    told_ += is_ready ? 0 : 1;
    // The loss is named, and the world counts as whole once that is accepted.
    const bool is_named = losses("show") > 0;
    if (is_named) static_cast<void>(losses("accept"));
    if (!is_ready && !(is_named && wait_for([&] { return state() == "ready"; }, 15s))) {
      ++silent_;
      std::fprintf(stderr, "neither ready nor a loss after a damage to %s\n%s", path.c_str(),
                   server_->errors().c_str());
    }
  }

  int run(int kills, int damages) {
    for (int i = 0; i < kills; ++i) {
      kill_once();
      tell_progress("kills", i + 1, kills);
    }
    const std::string kept = folder_.path() + "/kept";
    server_->signal(SIGKILL);
    server_->wait(5s);
    std::filesystem::copy(state_dir(), kept, std::filesystem::copy_options::recursive);
    for (int i = 0; i < damages; ++i) {
      damage_once(kept);
      tell_progress("damages", i + 1, damages);
    }
    std::printf("kills=%d acknowledged=%d lost=%d back=%d undone=%d damages=%d told=%d silent=%d\n", kills,
                acknowledged_, lost_, back_, undone_, damages, told_, silent_);
    return lost_ + back_ + undone_ + silent_ + slow_ == 0 ? 0 : 1;
  }

 private:
  static void tell_progress(const char* what, int done, int all) {
    if (done % 100 == 0 && done < all) std::fprintf(stderr, "%d of %d %s\n", done, all, what);
  }
  std::string state_dir() const { return folder_.path() + "/state"; }
  void start() {
    client_.reset();
    server_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{server_path_, "--domain", std::to_string(domain_), "--state-dir", state_dir()},
        folder_.path(), "server");
    if (!server_->says("ready:", 20s)) {
      std::fprintf(stderr, "the server does not start: %s\n", server_->errors().c_str());
      std::exit(2);
    }
    client_.emplace(value_of(Client::connect({.domain = domain_, .wait = 20s}), "connect"));
  }
  template <class Condition>
  static bool wait_for(Condition&& condition, std::chrono::milliseconds longest) {
    const auto until = SteadyClock::now() + longest;
    while (!condition()) {
      if (SteadyClock::now() > until) return false;
      std::this_thread::sleep_for(5ms);
    }
    return true;
  }
  std::string state() {
    const Result<ServerStatus> status = client_->status();
    const bool is_own = status && status->pid == static_cast<std::uint32_t>(server_->pid());
    return is_own ? status->state : std::string();
  }
  void wait_until_ready() {
    if (wait_for([&] { return state() == "ready"; }, 15s)) return;
    ++slow_;
    std::fprintf(stderr, "not ready: %s\n", server_->errors().c_str());
  }
  /// What the call answers. A server that gets no core for a while counts as silent, and lives.
  template <class Call>
  static auto answer_of(Call&& call, const char* what) {
    auto answer = call();
    const auto until = SteadyClock::now() + 15s;
    const auto may_come = [&] {
      return !answer && (answer.error().code == ErrorCode::disconnected || answer.error().code == ErrorCode::timeout);
    };
    while (may_come() && SteadyClock::now() < until) {
      std::this_thread::sleep_for(20ms);
      answer = call();
    }
    return value_of(std::move(answer), what);
  }
  World list() {
    World now;
    const ObjectList listed = answer_of([&] { return client_->list(); }, "list");
    for (const ListedObject& object : listed.objects) {
      if (object.scene != "warehouse") now[object.name] = object.position ? object.position->x() : 0;
    }
    return now;
  }
  /// Shows or accepts them; how many there are or were.
  std::size_t losses(const std::string& what) {
    const nlohmann::json asked{{"show", what == "show"}};
    const auto ask = [&] { return client_->command("accept_loss", asked.dump()); };
    const nlohmann::json answer = nlohmann::json::parse(answer_of(ask, what.c_str()));
    return answer.at("losses").size();
  }

  /// One change; `world` is as it is afterwards. False where no answer came.
  bool change(World& world) {
    const std::uint64_t what = random_() % 10;
    if (what < 7) return change_thing(world, "thing " + std::to_string(random_() % kThings));
    return change_scene(world, what == 7 ? "sent" : "hall");
  }
  bool change_thing(World& world, const std::string& name) {
    const double x = 1'000 + static_cast<double>(random_() % 1'000'000) / 64;
    if (!world.contains(name)) {
      world[name] = x;
      return !!client_->add({.name = name, .shape = {SphereShape{.radius_m = 0.1}}, .pose = {.position = {x, 0, 0}}});
    }
    if (random_() % 2 == 0) {
      world[name] = x;
      return !!client_->move(name, {.position = {x, 0, 0}});
    }
    world.erase(name);
    return !!client_->remove(name);
  }
  bool change_scene(World& world, const std::string& scene) {
    const auto is_member = [&](const auto& entry) { return entry.first.starts_with(scene + "/"); };
    const auto member = std::find_if(world.begin(), world.end(), is_member);
    if (member == world.end() || random_() % 4 == 0) {
      std::erase_if(world, is_member);
      for (const char* part : {"/a", "/b", "/c"}) world[scene + part] = 0;
      if (scene == "hall") return !!client_->load(file_, {.name = scene, .replace = true});
      const std::span<const char> text(kFile, std::strlen(kFile));
      return !!client_->load(std::as_bytes(text), "sent.obj", {.name = scene, .replace = true});
    }
    if (random_() % 4 == 0) {
      std::erase_if(world, is_member);
      return !!client_->clear({.scene = scene});
    }
    const std::string name = member->first;
    world.erase(member);
    return !!client_->remove(name);
  }

  /// Of what was under way either may be.
  void compare(const World& before, const World& after) {
    world_ = list();
    for (const World* known : {&before, &after}) {
      if (world_ == *known) return;
    }
    for (const auto& [name, x] : before) {
      const auto also = after.find(name);
      if (also == after.end() || also->second != x) continue;  // under way
      const auto now = world_.find(name);
      const bool is_lost = now == world_.end();
      lost_ += is_lost ? 1 : 0;
      undone_ += !is_lost && now->second != x ? 1 : 0;
      if (is_lost || now->second != x) std::fprintf(stderr, "%s %s\n", is_lost ? "lost" : "undone", name.c_str());
    }
    for (const auto& [name, x] : world_) {
      if (before.contains(name) || after.contains(name)) continue;
      ++back_;
      std::fprintf(stderr, "back %s\n", name.c_str());
    }
  }

  std::string damage() {
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(state_dir())) {
      if (entry.is_regular_file() && entry.file_size() > 0) paths.push_back(entry.path().string());
    }
    const std::string path = paths[random_() % paths.size()];
    std::string bytes;
    {
      std::ifstream in(path, std::ios::binary);
      bytes.assign(std::istreambuf_iterator<char>(in), {});
    }
    const std::size_t at = random_() % bytes.size();
    const auto spoil = [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < std::min(last, bytes.size()); ++i) bytes[i] = static_cast<char>(random_());
    };
    switch (random_() % 5) {
      case 0: bytes[at] = static_cast<char>(bytes[at] ^ (1 << random_() % 8)); break;
      case 1: bytes.resize(at); break;
      case 2: spoil(at, at + 64); break;
      case 3: spoil(0, bytes.size()); break;
      default: std::filesystem::remove(path); return path;
    }
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
    return path;
  }

  std::string server_path_;
  std::mt19937_64 random_;
  const int domain_ = own_domain();
  ScratchFolder folder_;
  std::string file_;
  std::unique_ptr<ChildProcess> server_;
  std::optional<Client> client_;
  World world_;
  int acknowledged_ = 0;
  int lost_ = 0;
  int back_ = 0;
  int undone_ = 0;
  int told_ = 0;
  int silent_ = 0;
  int slow_ = 0;
};

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: kept_over_kills SERVER KILLS DAMAGES [SEED]\n");
    return 2;
  }
  const std::uint64_t seed = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : std::random_device{}();
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  collided::testing_support::KeptOverKills loop(argv[1], seed);
  return loop.run(std::atoi(argv[2]), std::atoi(argv[3]));
}
