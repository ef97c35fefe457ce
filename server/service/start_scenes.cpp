#include "server/service/start_scenes.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "idl/clocks.hpp"
#include "server/service/commands/scene_loading.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/server.hpp"

namespace collided::engine::service {
namespace {

/// A line of progress on the terminal that is redrawn and leaves no trace. Draws nothing in the first moments, nor if
/// stderr is not a terminal.
class StartProgress {
 public:
  explicit StartProgress(std::string what) : what_(std::move(what)) {}
  ~StartProgress() {
    if (drawn_.load()) fmt::print(stderr, "\r\x1b[K");
  }
  void show(double fraction) {
    constexpr std::int64_t kPatienceNs = 400'000'000;
    constexpr std::int64_t kPeriodNs = 100'000'000;
    const std::int64_t now_ns = steady_ns();
    std::int64_t last_ns = shown_ns_.load();
    if (!terminal_ || now_ns - started_ns_ < kPatienceNs || now_ns - last_ns < kPeriodNs) return;
    // Any of the threads that load may call this; one of them draws.
    if (!shown_ns_.compare_exchange_strong(last_ns, now_ns)) return;
    const double elapsed_s = static_cast<double>(now_ns - started_ns_) * wire_contract::kNanosecond_s;
    const double left_s = fraction > 0 ? elapsed_s * (1 - fraction) / fraction : 0;
    fmt::print(stderr, "\r\x1b[K{}  {:3.0f} %  {:.0f} s left", what_, fraction * 100, left_s);
    drawn_.store(true);
  }

 private:
  std::string what_;
  const bool terminal_ = isatty(STDERR_FILENO) == 1;
  const std::int64_t started_ns_ = steady_ns();
  std::atomic<std::int64_t> shown_ns_{0};
  std::atomic<bool> drawn_{false};
};

/// Whether SIGTERM or SIGINT has come: both are blocked, so they stay pending until this checks.
bool is_stop_pending() {
  sigset_t pending;
  sigpending(&pending);
  return sigismember(&pending, SIGTERM) == 1 || sigismember(&pending, SIGINT) == 1;
}

LoadedScene load(const Options& options, const std::string& path) {
  StartProgress line("loading " + path);
  LoadOptions load_options;
  load_options.unit_m = options.unit_m;
  load_options.up = options.up;
  load_options.mend_m = options.mend_m;
  load_options.solid = options.solid;
  load_options.solid_by_winding = options.solid_by_winding;
  load_options.cancelled = is_stop_pending;
  load_options.progress = [&](double fraction) { line.show(fraction); };
  LoadedScene loaded = load_and_index(path, load_options, options.shard ? &*options.shard : nullptr);
  nlohmann::json again{{"path", std::filesystem::absolute(path).lexically_normal().string()}};
  if (options.unit_m != 1) again["unit_m"] = options.unit_m;
  if (options.up != 0) again["up"] = std::string(1, options.up);
  if (options.mend_m) again["mend"] = true;
  if (options.mend_m && *options.mend_m > 0) again["crack_m"] = *options.mend_m;
  if (!options.solid.empty()) again["solid"] = options.solid;
  if (options.solid_by_winding) again["solid_by"] = "winding";
  loaded.indexed.geometry->source = again.dump();
  return loaded;
}

LoadedScene embedded(const Options& options) {
  LoadOptions load_options;
  load_options.solid = options.solid;
  load_options.solid_by_winding = options.solid_by_winding;
  LoadedScene loaded = load_and_index(kEmbeddedPath, load_options, options.shard ? &*options.shard : nullptr);
  nlohmann::json again{{"path", kEmbeddedPath}};
  if (!options.solid.empty()) again["solid"] = options.solid;
  if (options.solid_by_winding) again["solid_by"] = "winding";
  loaded.indexed.geometry->source = again.dump();
  return loaded;
}

void add(World& world, const LoadedScene& loaded) {
  const std::variant<std::uint32_t, Refusal> added = world.add_scene(loaded.indexed);
  if (const auto* refusal = std::get_if<Refusal>(&added)) throw StartError(refusal->reason);
  fmt::print("{}\n", describe(loaded));
}

}  // namespace

void load_start_scenes(const Options& options, World& world, std::int64_t now_ns) {
  for (const std::string& path : options.scenes) add(world, load(options, path));
  if (options.scenes.empty()) add(world, embedded(options));
  if (!options.covers.empty()) world.state_covers("", options.covers);
  world.step(now_ns, 1, {});
  std::fflush(stdout);
}

std::string_view how_to_ask() {
  return "no scene was named, so this is the embedded one; try, in another terminal:\n"
         "  collide ray 0 0 5  0 0 -1        what is below (0 0 5)\n"
         "  collide add ball sphere 0.2 --at 0 0 1\n"
         "  collide watch                    collisions as they begin and end\n"
         "  collide plan                     what was built for it, what was left out, and why\n";
}

}  // namespace collided::engine::service
