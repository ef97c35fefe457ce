#include "client/cli/publish/bounce_source.hpp"

#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "client/cli/event_watch.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/readable.hpp"
#include "client/cli/publish/sphere_mesh.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {
namespace {

constexpr std::size_t kMostEventsPerFrame = 100'000;
// If the server's world time differs from this publisher's time by more than this (the publisher's lease), the server
// does not use this publisher's clock.
constexpr double kMostClockOff_s = 0.5;

std::string escaped_glob(std::string_view name) {
  std::string glob;
  for (const char c : name) {
    const bool special = c == '*' || c == '?' || c == '[';
    glob += special ? fmt::format("[{}]", c) : std::string(1, c);
  }
  return glob;
}

class BounceSource : public MotionSource {
 public:
  explicit BounceSource(const BounceSourceOptions& options) : options_(options), bounce_(options.bounce) {}

  void begin(Session& session, const Globals& globals, WorldPublisher& publisher) override {
    // The watch begins before the first sphere is added, so that no contact is missed.
    WatchOptions own;
    own.only = escaped_glob(options_.name) + "/*";
    if (options_.bounces) watch_.emplace(session, globals, own);
    add(publisher, options_.name + "/cube", {cube_walls(options_.bounce.side_m / 2)}, {}, false);
    for (std::size_t at = 0; at < bounce_.spheres().size(); ++at) {
      const Sphere& sphere = bounce_.spheres()[at];
      const std::string name = fmt::format("{}/{}", options_.name, at);
      index_of_[name] = at;
      objects_.push_back(add(publisher, name, {shape_of(sphere)}, {sphere.position, sphere.rotation}, true));
    }
  }

  std::optional<double> next_time() override { return static_cast<double>(frame_) / options_.rate_hz; }

  std::size_t move(WorldPublisher& publisher) override {
    if (watch_) hear();
    if (frame_++ > 0) bounce_.step(1 / options_.rate_hz);
    for (std::size_t at = 0; at < objects_.size(); ++at) {
      const Sphere& sphere = bounce_.spheres()[at];
      moved(publisher.move(objects_[at], {sphere.position, sphere.rotation}));
    }
    return objects_.size();
  }

  void sent(std::chrono::nanoseconds instant) override { newest_ = instant; }

  bool restart() override { return false; }

  void report(Record& record, std::vector<std::string>& lines) const override {
    const BounceLedger ledger = bounce_.ledger();
    record.push_back({"seed", options_.bounce.seed});
    record.push_back({"contacts", ledger.contacts});
    record.push_back({"flips", ledger.flips});
    record.push_back({"sticking", ledger.sticking});
    record.push_back({"longest_flips", ledger.longest_flips});
    record.push_back({"cube_contacts", ledger.cube_contacts});
    record.push_back({"face_hits", ledger.wall_hits[1]});
    record.push_back({"edge_hits", ledger.wall_hits[2]});
    record.push_back({"corner_hits", ledger.wall_hits[3]});
    record.push_back({"energy_before", ledger.energy_before});
    record.push_back({"energy_after", ledger.energy_after});
    record.push_back({"momentum_before", MaybeVector(ledger.momentum_before)});
    record.push_back({"momentum_after", MaybeVector(ledger.momentum_after)});
    record.push_back({"response", std::string(answer_name())});
    record.push_back({"energy_drift", ledger.energy_drift()});
    record.push_back({"penetration_m", ledger.penetration_m});
    record.push_back({"seen_overlap_m", ledger.seen_overlap_m});
    record.push_back({"events_lost", watch_ ? watch_->lost() : 0});
    add_lines(ledger, lines);
  }

 private:
  ShapePart shape_of(const Sphere& sphere) const {
    if (options_.round) return SphereShape{.radius_m = sphere.radius_m};
    const LatitudeLongitude bands = bands_for(options_.polygon_count);
    return sphere_mesh(sphere.radius_m, bands.latitudes, bands.longitudes);
  }

  Publisher::Object add(WorldPublisher& publisher, const std::string& name, Shape shape, const Pose& pose,
                        bool moving) const {
    ObjectOptions object;
    object.name = name;
    object.shape = std::move(shape);
    object.pose = pose;
    object.moving = moving;
    object.layers = options_.objects.layers;
    object.mask = options_.objects.mask;
    object.lost_policy = options_.objects.lost_policy;
    return take(publisher.add(object));
  }

  /// Takes the events that have come since the last frame.
  void hear() {
    for (std::size_t count = 0; count < kMostEventsPerFrame; ++count) {
      const std::optional<Event> event = watch_->next(std::chrono::nanoseconds(0));
      if (!event) return;
      if (event->doubt != Doubt::none) continue;  // not known to touch, so it is ignored
      const auto a = index_of_.find(event->a);
      const auto b = index_of_.find(event->b);
      const bool pair = a != index_of_.end() && b != index_of_.end();
      const bool begins = event->kind == EventKind::began || event->kind == EventKind::open;
      if (pair && begins) bounce_.contact_began(a->second, b->second, touch_of(*event));
      if (pair && event->kind == EventKind::ended) bounce_.contact_ended(a->second, b->second);
      if (pair || !begins) continue;
      const std::string cube = options_.name + "/cube";
      if (a != index_of_.end() && event->b == cube) bounce_.touched_cube(a->second, event->normal);
      if (b != index_of_.end() && event->a == cube) bounce_.touched_cube(b->second, event->normal);
    }
  }

  /// When and how deep the spheres of an event touch. World time is this publisher's own, to the nanosecond, so an
  /// event's bracket can be compared with the spheres' times, even if it is received late. If the clocks differ so much
  /// that the server uses its own, only depth and velocity are used.
  response::Touch touch_of(const Event& event) const {
    const double told_s = std::chrono::duration<double>(newest_ - event.world_time).count();
    if (!(std::abs(told_s) < kMostClockOff_s)) return {.earliest_s = kMostClockOff_s, .depth_m = event.depth_m};
    const double latest_s = std::max(0.0, told_s + event.bracket_high_s);
    // The depth is that at the first frame after the touch. A bracket that ends at a frame may end a nanosecond before
    // or after it.
    const double seen_s = std::floor(latest_s * options_.rate_hz + 1e-6) / options_.rate_hz;
    return {.earliest_s = std::max(0.0, told_s + event.bracket_low_s),
            .latest_s = latest_s,
            .seen_s = seen_s,
            .depth_m = event.depth_m};
  }

  void add_lines(const BounceLedger& ledger, std::vector<std::string>& lines) const {
    std::string sizes;
    for (const std::size_t count : bounce_.size_histogram()) sizes += fmt::format(" {}", count);
    lines.push_back(fmt::format(
        "  {} spheres of {}, seed {}, sizes{} (half to one and a half of the mean)", objects_.size(),
        options_.round ? "radius" : fmt::format("{} triangles", triangle_count()), options_.bounce.seed, sizes));
    lines.push_back(fmt::format("  contacts {}  flips {}  sticking {}  longest {}  cube contacts {}", ledger.contacts,
                                ledger.flips, ledger.sticking, counted(ledger.longest_flips, "flip"),
                                ledger.cube_contacts));
    lines.push_back(fmt::format("  walls: {} faces, {} edges, {} corners", ledger.wall_hits[1], ledger.wall_hits[2],
                                ledger.wall_hits[3]));
    lines.push_back(fmt::format("  energy {} before, {} after; momentum {} before, {} after",
                                readable_number(ledger.energy_before), readable_number(ledger.energy_after),
                                readable_point(ledger.momentum_before, 0, Digits::rounded),
                                readable_point(ledger.momentum_after, 0, Digits::rounded)));
    lines.push_back(
        fmt::format("  response {}: energy drift {:.2g}, worst penetration {:.3g} m, in sent poses {:.3g} m",
                    answer_name(), ledger.energy_drift(), ledger.penetration_m, ledger.seen_overlap_m));
    if (bounce_.overlapping_at_start() > 0)
      lines.push_back(fmt::format("  {} spheres found no free place at the start", bounce_.overlapping_at_start()));
  }

  std::string_view answer_name() const {
    switch (options_.bounce.answer) {
      case response::ResponseLaw::flip: return "flip";
      case response::ResponseLaw::impulse: return "impulse";
      case response::ResponseLaw::compliant: break;
    }
    return "compliant";
  }

  std::size_t triangle_count() const {
    const LatitudeLongitude bands = bands_for(options_.polygon_count);
    return 2 * bands.longitudes * (bands.latitudes - 1);
  }

  BounceSourceOptions options_;
  Bounce bounce_;
  std::optional<EventWatch> watch_;
  std::vector<Publisher::Object> objects_;
  std::unordered_map<std::string, std::size_t> index_of_;
  std::uint64_t frame_ = 0;
  std::chrono::nanoseconds newest_{0};  // frame, since 1970
};

}  // namespace

std::unique_ptr<MotionSource> make_bounce_source(const BounceSourceOptions& options) {
  return std::make_unique<BounceSource>(options);
}

}  // namespace collided::cli
