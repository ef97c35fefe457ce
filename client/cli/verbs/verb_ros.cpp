#include <algorithm>
#include <chrono>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/ros/bridge.hpp"
#include "idl/clocks.hpp"

namespace collided::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kRosWait{20};         // a publisher must speak more often than its lease of 500 ms
constexpr std::chrono::milliseconds kRosFind{500};        // from one look for new objects to the next
constexpr std::chrono::milliseconds kRosShowAgain{1000};  // the same, where nothing changes: for readers that come late
constexpr std::chrono::milliseconds kRosShow{100};        // from one message of contacts to the next
constexpr std::size_t kRosMostContacts = 10'000;          // shown at a time

std::int64_t ros_now_ns() { return wire_contract::since_1970_ns(); }

/// The contacts that hold, as a watch tells them. One that began before somebody wanted to know where has no point yet,
/// and is left out until one of the two moves.
class RosContacts {
 public:
  explicit RosContacts(Watch watch) : watch_(std::move(watch)) {}

  /// Takes the events that have come; true where something has changed.
  bool take() {
    bool has_changed = false;
    // Where contacts go on faster than they are read, frames must have their turn all the same.
    for (std::size_t taken = 0; taken < kRosMostContacts; ++taken) {
      const std::optional<Event> event = watch_.next(std::chrono::nanoseconds(0));
      if (!event) break;
      has_changed = true;
      if (event->kind == EventKind::ended) open_.erase({event->a, event->b});
      else if (can_show(*event)) open_[{event->a, event->b}] = {event->point, event->normal, event->depth_m};
    }
    return has_changed;
  }
  std::vector<ros::ShownContact> shown() const {
    std::vector<ros::ShownContact> contacts;
    for (const auto& [pair, contact] : open_) contacts.push_back(contact);
    return contacts;
  }

 private:
  bool can_show(const Event& event) const {
    const bool has_point = event.doubt == Doubt::none && event.normal != Vec3::Zero();
    return has_point && (open_.size() < kRosMostContacts || open_.contains({event.a, event.b}));
  }

  Watch watch_;
  std::map<std::pair<std::string, std::string>, ros::ShownContact> open_;
};

class RosCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    app.add_option("--ros-domain", domain_, "ROS's domain (ROS_DOMAIN_ID, else 0)");
    app.add_option("--ros-interface", follow_interface_, "ROS's network interface: lo (default), auto, eth0");
    app.add_option("--ros-peer", peers_, "Another machine's address, where multicast does not reach")
        ->allow_extra_args(false);
    app.add_option("--frame", follow_.fixed, "Frame that is the server's world (world)");
    app.add_option("--only", follow_.only, "Objects that may follow a frame: name glob (all)");
    app.add_option("--pose", poses_, "TOPIC=FRAME: a topic of PoseStamped that moves a frame")->allow_extra_args(false);
    app.add_flag("--joint-states", has_joint_states_, "Read /joint_states with /robot_description too");
    app.add_option("--as", name_, "Name of the publisher (collide ros)");
    app.add_option("--for", for_, "End after this time");
  }

  Exit run(Session& session, const Globals& globals) override {
    Client& client = session.client(globals);
    Publisher publisher = take(client.publish(name_));
    RosContacts contacts(take(client.watch({.persisted = true})));
    ros::RosLink link = join(session.io);
    ros::Bridge bridge(client, publisher, follow_);
    print_hint(session.io, globals, "follows frames; Ctrl-C ends");
    const Clock::time_point end = for_.empty() ? Clock::time_point::max() : Clock::now() + duration();
    Clock::time_point find_at = Clock::now(), shown = Clock::now();
    bool is_shown = true;
    while (!stop_requested && Clock::now() < end) {
      bridge.counts().messages += link.take(kRosWait, taker(session.io, bridge));
      bridge.send(ros_now_ns());
      tell_broadcasters(session.io, globals, link.broadcasters());
      if (Clock::now() >= find_at) {
        find(session.io, globals, bridge);
        find_at = Clock::now() + kRosFind;
      }
      static_cast<void>(publisher.keep_alive());
      is_shown = !contacts.take() && is_shown;
      if (Clock::now() >= (is_shown ? shown + kRosShowAgain : shown + kRosShow)) {
        is_shown = link.show(contacts.shown(), follow_.fixed, ros_now_ns());
        shown = Clock::now();
      }
    }
    return report(session.io, globals, bridge);
  }

 private:
  std::chrono::nanoseconds duration() const { return parse_duration(for_); }

  ros::RosLink join(const Io& io) const {
    const std::string domain = domain_.empty() ? io.env("ROS_DOMAIN_ID") : domain_;
    const std::uint64_t number = domain.empty() ? 0 : parse_count(domain);
    if (number > 230) throw bad_use(fmt::format("--ros-domain {}, allowed 0 to 230", domain));
    const std::vector<ros::RosPoseTopic> poses = pose_topics();
    try {
      return ros::RosLink({.domain = static_cast<int>(number),
                           .interface = follow_interface_,
                           .peers = peers_,
                           .has_joint_states = has_joint_states_,
                           .poses = poses});
    } catch (const std::runtime_error& failed) { throw Failure(Exit::no_server, std::string("ROS: ") + failed.what()); }
  }

  std::vector<ros::RosPoseTopic> pose_topics() const {
    std::vector<ros::RosPoseTopic> topics;
    for (const std::string& text : poses_) {
      const std::size_t sign = text.find('=');
      if (sign == 0 || sign == std::string::npos || sign + 1 == text.size())
        throw bad_use(fmt::format("--pose '{}'; it is to be TOPIC=FRAME", printable(text)));
      topics.push_back({text.substr(0, sign), text.substr(sign + 1)});
    }
    return topics;
  }

  ros::RosTaker taker(Io& io, ros::Bridge& bridge) const {
    return {.transform = [&](const ros::RosTransform& transform) { bridge.take(transform, ros_now_ns()); },
            .joints = [&](const ros::RosJoints& joints) { bridge.take(joints, ros_now_ns()); },
            .robot =
                [&](const std::string& urdf) {
                  if (const Result<void> taken = bridge.take_robot(urdf); !taken)
                    print_warning(io, taken.error().message);
                }};
  }

  void tell_broadcasters(Io& io, const Globals& globals, std::size_t count) {
    if (count == broadcasters_) return;
    broadcasters_ = count;
    print_hint(io, globals, fmt::format("hears {} of frames", counted(count, "writer")));
  }

  /// Says each kind of trouble once.
  void find(Io& io, const Globals& globals, ros::Bridge& bridge) {
    const Result<std::size_t> found = bridge.find_objects();
    if (!found && found.error().message != last_error_) {
      last_error_ = found.error().message;
      print_warning(io, last_error_);
    }
    if (found && *found > 0)
      print_hint(io, globals, fmt::format("{} now follow frames", counted(bridge.followed().size(), "object")));
    if (bridge.followed().static_count() > 0 && !has_told_static_) {
      has_told_static_ = true;
      print_warning(io, fmt::format("{} with the name of a frame: standing still; load their scene with --moving",
                                    counted(bridge.followed().static_count(), "object")));
    }
  }

  Exit report(Io& io, const Globals& globals, ros::Bridge& bridge) const {
    const ros::BridgeCounts& counts = bridge.counts();
    const std::size_t missing = bridge.followed().missing_count();
    Record record{{"messages", counts.messages},
                  {"transforms", counts.transforms},
                  {"frames", std::uint64_t{bridge.frames().names().size()}},
                  {"objects", std::uint64_t{bridge.followed().size()}},
                  {"poses", counts.poses},
                  {"unsent", bridge.followed().unsent_count()},
                  {"missing", std::uint64_t{missing}},
                  {"unnamed", counts.unnamed},
                  {"bad", counts.bad},
                  {"loops", counts.loops},
                  {"late", counts.late},
                  {"full", counts.full},
                  {"unstamped", counts.unstamped},
                  {"ahead", counts.ahead},
                  {"robotless", counts.robotless},
                  {"joints", counts.joints}};
    Printer printer = make_printer(io, globals);
    printer.set_usual_fields({"messages", "transforms", "frames", "objects", "poses", "unsent"});
    if (!printer.human()) {
      printer.record(record);
      return stop_requested ? Exit::interrupted : Exit::yes;
    }
    printer.line(fmt::format("{} of {}; {} sent of {}", counted(counts.transforms, "transform"),
                             counted(bridge.frames().names().size(), "frame"), counted(counts.poses, "pose"),
                             counted(bridge.followed().size(), "object")));
    const auto warn = [&](std::uint64_t count, std::string_view what) {
      if (count > 0) printer.line(fmt::format("  warning  {} {}", format_count(count), what));
    };
    warn(missing, "followed frames are not connected to '" + follow_.fixed + "'");
    warn(counts.unnamed, "transforms without a frame, or of a frame in itself: left out");
    warn(counts.bad, "transforms that are not finite, or whose quaternion is none: left out");
    warn(counts.loops, "transforms that would make a frame its own ancestor: left out");
    warn(counts.late, "transforms older than the ten seconds that are kept: left out");
    warn(counts.full, "transforms of more frames than there may be: left out");
    warn(counts.unstamped, "transforms stamped 0: taken as of their reception");
    warn(counts.ahead, "transforms stamped more than 0.5 s ahead: taken as of their reception");
    warn(counts.robotless, "messages of joints came without a /robot_description before them: left out");
    warn(counts.joints, "messages of joints with a joint or position that the robot cannot have");
    return stop_requested ? Exit::interrupted : Exit::yes;
  }

  std::string domain_;
  std::string follow_interface_ = "lo";
  std::vector<std::string> peers_;
  std::vector<std::string> poses_;
  std::string name_ = "collide ros";
  std::string for_;
  std::string last_error_;
  ros::FollowedFramesOptions follow_;
  std::size_t broadcasters_ = 0;
  bool has_joint_states_ = false;
  bool has_told_static_ = false;
};

}  // namespace

std::unique_ptr<Command> make_ros() { return std::make_unique<RosCommand>(); }

}  // namespace collided::cli
