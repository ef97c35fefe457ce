#include <algorithm>
#include <chrono>
#include <map>
#include <set>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/ros/bridge.hpp"
#include "client/ros/live_clouds.hpp"
#include "client/ros/marker_objects.hpp"
#include "client/ros/shown_world.hpp"
#include "idl/clocks.hpp"

namespace collided::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kRosWait{20};         // a publisher must send more often than its lease of 500 ms
constexpr std::chrono::milliseconds kRosFind{500};        // from one search for new objects to the next
constexpr std::chrono::milliseconds kRosShowAgain{1000};  // the same, if nothing changes: for late readers
constexpr std::chrono::milliseconds kRosShow{100};        // from one message of contacts to the next
constexpr std::chrono::milliseconds kRosRefused{5000};    // from one check for refused publishers to the next
constexpr std::chrono::milliseconds kRosTell{1000};       // from one message of diagnostics to the next
constexpr std::size_t kRosMostContacts = 10'000;          // shown at a time

std::int64_t ros_now_ns() { return wire_contract::since_1970_ns(); }

/// The open contacts, as a watch reports them. A contact that began before points were requested has none yet, and is
/// left out until one of the two moves.
class RosContacts {
 public:
  explicit RosContacts(Watch watch) : watch_(std::move(watch)) {}

  /// Takes the events that have come; true if something has changed.
  bool take() {
    bool has_changed = false;
    // Even if contacts arrive faster than they are read, frames must have their turn.
    for (std::size_t taken = 0; taken < kRosMostContacts; ++taken) {
      const std::optional<Event> event = watch_.next(std::chrono::nanoseconds(0));
      if (!event) break;
      has_changed = true;
      if (event->kind == EventKind::ended) open_.erase({event->a, event->b});
      else if (can_show(*event))
        open_[{event->a, event->b}] = {event->point, event->normal, event->depth_m, event->a, event->b};
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
    option(app, "--ros-domain N", domain_, "ROS's domain (ROS_DOMAIN_ID, else 0)");
    option(app, "--ros-interface NAME", follow_interface_, "ROS's network interface: lo (default), auto, eth0");
    option(app, "--ros-peer HOST", peers_, "Another machine's address, where multicast does not reach")
        ->allow_extra_args(false);
    option(app, "--frame FRAME", follow_.fixed, "Frame that is the server's world (world)");
    option(app, "--only GLOB", follow_.only, "Objects that may follow a frame: name glob (all)");
    option(app, "--pose TOPIC=FRAME", poses_, "A topic of PoseStamped that moves a frame")->allow_extra_args(false);
    option(app, "--markers TOPIC", markers_, "A topic of MarkerArray whose markers are objects")
        ->allow_extra_args(false);
    option(app, "--cloud TOPIC=NAME", clouds_, "A topic of PointCloud2 that becomes occupied cells")
        ->allow_extra_args(false);
    option(app, "--octomap TOPIC=NAME", maps_, "A topic of Octomap that becomes occupied cells")
        ->allow_extra_args(false);
    option(app, "--voxels", Measure::length, voxels_.cell_m, "Side of a cloud's cells (0.1)");
    option(app, "--reach", Measure::length, voxels_.reach_m, "Points farther from the sensor do not count (no limit)");
    option(app, "--decay", voxels_.decay, "What was not met for so long is unknown again (10s)");
    option(app, "--unknown WORD", unknown_, "Cells that nothing has met: free (default), undecided or occupied")
        ->check(CLI::IsMember({"free", "undecided", "occupied"}));
    option(app, "--clearance-of GLOB", clearance_, "Objects whose least clearance goes out on /collided/clearance");
    app.add_flag("--objects", shows_objects_, "Show the world's objects on /collided/objects");
    app.add_flag("--tf", sends_tf_, "Send the poses of objects that follow no frame on /tf");
    app.add_flag("--sim-time", has_clock_, "Time is that of /clock (use_sim_time)");
    app.add_flag("--joint-states", has_joint_states_, "Read /joint_states with /robot_description too");
    option(app, "--as NAME", name_, "Name of the publisher (collide ros)");
    option(app, "--for", time_, "End after this time");
  }

  Exit run(Session& session, const Globals& globals) override {
    Client& client = session.client(globals);
    Publisher publisher = take(client.publish(name_));
    RosContacts contacts(take(client.watch({.persisted = true})));
    ros::RosLink link = join(session.io);
    ros::Bridge bridge(client, publisher, follow_);
    clouds_in_.emplace(client, cloud_options());
    markers_in_.emplace(client, follow_.fixed, object_names(markers_));
    take(clouds_in_->start());
    take(markers_in_->start());
    ros::ShownWorld world(
        client,
        {.fixed = follow_.fixed, .clearance_of = clearance_, .shows_objects = shows_objects_, .sends_tf = sends_tf_});
    print_hint(session.io, globals, "follows frames; Ctrl-C ends");
    const Clock::time_point end = time_ ? Clock::now() + *time_ : Clock::time_point::max();
    Clock::time_point refused_at = Clock::now() + kRosRefused;
    Clock::time_point find_at = Clock::now(), shown = Clock::now(), told = Clock::now() - kRosTell;
    bool is_shown = true;
    while (!stop_requested && Clock::now() < end) {
      bridge.counts().messages += link.take(kRosWait, taker(session.io, bridge, world));
      tell_broadcasters(session.io, globals, link.broadcasters());
      if (has_clock_ && clock_ns_ == 0) {
        static_cast<void>(publisher.keep_alive());
        continue;
      }
      bridge.send(now_ns());
      clouds_in_->go_on(bridge.frames(), now_ns());
      markers_in_->go_on(bridge.frames(), now_ns());
      world.go_on(link, bridge.frames(), now_ns());
      tell_flaws(session.io, clouds_in_->take_flaws());
      tell_flaws(session.io, markers_in_->take_flaws());
      if (Clock::now() >= find_at) {
        find(session.io, globals, bridge);
        find_at = Clock::now() + kRosFind;
      }
      if (Clock::now() >= refused_at) {
        look_for_refusals(session.io, publisher);
        refused_at = Clock::now() + kRosRefused;
      }
      static_cast<void>(publisher.keep_alive());
      is_shown = !contacts.take() && is_shown;
      if (Clock::now() >= (is_shown ? shown + kRosShowAgain : shown + kRosShow)) {
        is_shown = link.show(contacts.shown(), follow_.fixed, now_ns());
        is_shown = link.tell(contacts.shown(), follow_.fixed, now_ns()) && is_shown;
        shown = Clock::now();
      }
      if (Clock::now() >= told + kRosTell) {
        static_cast<void>(link.tell(diagnostics(client, bridge, world), now_ns()));
        told = Clock::now();
      }
    }
    look_for_refusals(session.io, publisher);
    return report(session.io, globals, bridge);
  }

 private:
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
                           .poses = poses,
                           .clouds = names_of(clouds_, "--cloud", true),
                           .octomaps = names_of(maps_, "--octomap", true),
                           .markers = markers_,
                           .has_clock = has_clock_,
                           .sends_tf = sends_tf_});
    } catch (const std::runtime_error& failed) { throw Failure(Exit::no_server, std::string("ROS: ") + failed.what()); }
  }

  std::int64_t now_ns() const { return has_clock_ ? clock_ns_ : ros_now_ns(); }

  /// One half of each TOPIC=NAME.
  static std::vector<std::string> names_of(const std::vector<std::string>& texts, std::string_view option,
                                           bool is_topic) {
    std::vector<std::string> names;
    for (const std::string& text : texts) {
      const std::size_t sign = text.find('=');
      if (sign == 0 || sign == std::string::npos || sign + 1 == text.size())
        throw bad_use(fmt::format("{} '{}'; it is to be TOPIC={}", option, printable(text),
                                  option == "--pose" ? "FRAME" : "NAME"));
      names.push_back(is_topic ? text.substr(0, sign) : text.substr(sign + 1));
    }
    return names;
  }

  std::vector<ros::RosPoseTopic> pose_topics() const {
    const std::vector<std::string> topics = names_of(poses_, "--pose", true);
    const std::vector<std::string> frames = names_of(poses_, "--pose", false);
    std::vector<ros::RosPoseTopic> made;
    for (std::size_t i = 0; i < topics.size(); ++i) made.push_back({topics[i], frames[i]});
    return made;
  }

  /// A topic's name without its leading slash.
  static std::vector<std::string> object_names(std::vector<std::string> topics) {
    for (std::string& topic : topics) {
      if (topic.starts_with('/')) topic.erase(0, 1);
    }
    return topics;
  }

  ros::LiveCloudOptions cloud_options() const {
    ros::LiveCloudOptions options{.fixed = follow_.fixed,
                                  .clouds = names_of(clouds_, "--cloud", false),
                                  .maps = names_of(maps_, "--octomap", false)};
    options.voxels = voxels_;
    options.voxels.unknown = unknown_ == "undecided"  ? UnknownCells::undecided
                             : unknown_ == "occupied" ? UnknownCells::occupied
                                                      : UnknownCells::free;
    return options;
  }

  ros::RosTaker taker(Io& io, ros::Bridge& bridge, const ros::ShownWorld& world) {
    return {
        .transform =
            [&](const ros::RosTransform& transform) {
              if (!world.has_sent(transform)) bridge.take(transform, now_ns());
            },
        .joints = [&](const ros::RosJoints& joints) { bridge.take(joints, now_ns()); },
        .robot =
            [&](const std::string& urdf) {
              if (const Result<void> taken = bridge.take_robot(urdf); !taken) print_warning(io, taken.error().message);
            },
        .cloud = [&](std::size_t topic, const ros::CloudMessage& cloud) { clouds_in_->take(topic, cloud, now_ns()); },
        .octomap = [&](std::size_t topic, const ros::OctomapMessage& map) { clouds_in_->take(topic, map, now_ns()); },
        .marker = [&](std::size_t topic,
                      const ros::MarkerMessage& marker) { markers_in_->take(topic, marker, now_ns()); },
        .clock = [&](std::int64_t clock_ns) { clock_ns_ = clock_ns; }};
  }

  /// Prints each sentence once.
  void tell_flaws(Io& io, const std::vector<std::string>& flaws) {
    constexpr std::size_t kMostTold = 100;
    for (const std::string& flaw : flaws) {
      if (told_.size() < kMostTold && told_.insert(flaw).second) print_warning(io, flaw);
    }
  }

  std::vector<ros::RosDiagnostic> diagnostics(Client& client, ros::Bridge& bridge, const ros::ShownWorld& world) {
    const Result<ServerStatus> status = client.status();
    ros::RosDiagnostic server{.name = "collided: server", .message = "ready", .level = 0, .values = {}};
    if (!status) {
      server.message = status.error().message;
      server.level = 2;
    } else {
      server.values = {{"objects", std::to_string(status->objects)},
                       {"contacts", std::to_string(status->contacts)},
                       {"version", std::to_string(status->version)}};
    }
    ros::RosDiagnostic input{.name = "collided: input", .message = "all messages were taken", .level = 0, .values = {}};
    std::uint64_t left_out = 0;
    for (const auto& [name, count] : troubles(bridge)) {
      input.values.emplace_back(name, std::to_string(count));
      left_out += count;
    }
    if (left_out > 0) {
      input.level = 1;
      input.message = fmt::format("{} could not be taken as they came", format_count(left_out));
    }
    std::vector<ros::RosDiagnostic> told{server, input};
    if (!clearance_.empty()) told.push_back(world.clearance_diagnostic());
    return told;
  }

  /// The counts of data not accepted unchanged, by their names in the report.
  std::vector<std::pair<std::string, std::uint64_t>> troubles(ros::Bridge& bridge) const {
    const ros::BridgeCounts& counts = bridge.counts();
    const ros::CloudCounts& clouds = clouds_in_->counts();
    const ros::MarkerCounts& markers = markers_in_->counts();
    return {{"missing", bridge.followed().missing_count()},
            {"unnamed", counts.unnamed + clouds.unnamed + markers.unnamed},
            {"bad", counts.bad + clouds.bad + markers.bad},
            {"loops", counts.loops},
            {"late", counts.late},
            {"full", counts.full},
            {"unstamped", counts.unstamped + clouds.unstamped + markers.unstamped},
            {"ahead", counts.ahead + clouds.ahead + markers.ahead},
            {"robotless", counts.robotless},
            {"joints", counts.joints},
            {"frameless", clouds.frameless + markers.frameless},
            {"shapeless", markers.shapeless},
            {"not_finite", clouds.not_finite},
            {"dropped", clouds.dropped}};
  }

  void tell_broadcasters(Io& io, const Globals& globals, std::size_t count) {
    if (count == broadcasters_) return;
    broadcasters_ = count;
    print_hint(io, globals, fmt::format("hears {}", counted(count, "writer")));
  }

  /// Prints each kind of trouble once.
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

  /// Without this a bridge whose objects never enter the world would look normal. It continues: they enter once there
  /// is room.
  void look_for_refusals(Io& io, Publisher& of_frames) {
    constexpr std::chrono::milliseconds kPatience{200};
    refused_.clear();
    for (Publisher* const publisher : {&of_frames, clouds_in_->publisher(), markers_in_->publisher()}) {
      if (publisher == nullptr) continue;
      const Result<PublisherReport> found = publisher->report(kPatience);
      if (found && !found->refused.empty()) refused_ = found->refused;
    }
    if (!refused_.empty() && refused_ != last_refused_)
      print_warning(io, "the server takes nothing of a publisher of this bridge: " + refused_);
    last_refused_ = refused_;
  }

  Exit report(Io& io, const Globals& globals, ros::Bridge& bridge) const {
    const ros::BridgeCounts& counts = bridge.counts();
    const ros::CloudCounts& clouds = clouds_in_->counts();
    const ros::MarkerCounts& markers = markers_in_->counts();
    Record record{{"messages", counts.messages},
                  {"transforms", counts.transforms},
                  {"frames", std::uint64_t{bridge.frames().names().size()}},
                  {"objects", std::uint64_t{bridge.followed().size()}},
                  {"poses", counts.poses},
                  {"unsent", bridge.followed().unsent_count() + clouds.unsent + markers.unsent},
                  {"clouds", clouds.clouds},
                  {"maps", clouds.maps},
                  {"points", clouds.points},
                  {"occupied", std::uint64_t{clouds_in_->occupied_count()}},
                  {"markers", markers.markers},
                  {"marker_objects", std::uint64_t{markers_in_->size()}}};
    for (const auto& [name, count] : troubles(bridge)) record.emplace_back(name, count);
    Printer printer = make_printer(io, globals);
    printer.set_usual_fields({"messages", "transforms", "frames", "objects", "poses", "unsent"});
    if (printer.human()) print_report(printer, bridge);
    else printer.record(record);
    if (stop_requested) return Exit::interrupted;
    return refused_.empty() ? Exit::yes : Exit::refused;
  }

  void print_report(Printer& printer, ros::Bridge& bridge) const {
    const ros::BridgeCounts& counts = bridge.counts();
    const ros::CloudCounts& clouds = clouds_in_->counts();
    printer.line(fmt::format("{} of {}; {} sent of {}", counted(counts.transforms, "transform"),
                             counted(bridge.frames().names().size(), "frame"), counted(counts.poses, "pose"),
                             counted(bridge.followed().size(), "object")));
    if (!clouds_.empty() || !maps_.empty())
      printer.line(fmt::format("{} and {}; {}", counted(clouds.clouds, "cloud"), counted(clouds.maps, "map"),
                               counted(clouds_in_->occupied_count(), "occupied cell")));
    if (!markers_.empty())
      printer.line(fmt::format("{}; {}", counted(markers_in_->counts().markers, "marker"),
                               counted(markers_in_->size(), "object")));
    const std::map<std::string, std::string> meanings{
        {"missing", "followed frames are not connected to '" + follow_.fixed + "'"},
        {"unnamed", "messages without a frame, or transforms of a frame in itself: left out"},
        {"bad", "messages that cannot be meant, as with numbers that are not finite: left out"},
        {"loops", "transforms that would make a frame its own ancestor: left out"},
        {"late", "transforms older than the ten seconds that are kept: left out"},
        {"full", "transforms of more frames than there may be: left out"},
        {"unstamped", "messages stamped 0: taken as of their reception"},
        {"ahead", "messages stamped more than 0.5 s ahead: taken as of their reception"},
        {"robotless", "messages of joints came without a /robot_description before them: left out"},
        {"joints", "messages of joints with a joint or position that the robot cannot have"},
        {"frameless", "messages whose frame was not known at their stamp, nor a second later: left out"},
        {"shapeless", "markers that fill no space that is known here: left out"},
        {"not_finite", "points of clouds that are not finite: left out"},
        {"dropped", "points in blocks of cells beyond the limit: left out"}};
    for (const auto& [name, count] : troubles(bridge)) {
      if (count > 0) printer.line(fmt::format("  warning  {} {}", format_count(count), meanings.at(name)));
    }
  }

  std::string domain_;
  std::string follow_interface_ = "lo";
  std::vector<std::string> peers_;
  std::vector<std::string> poses_;
  std::vector<std::string> markers_;
  std::vector<std::string> clouds_;
  std::vector<std::string> maps_;
  VoxelOptions voxels_{.cell_m = 0.1, .decay = std::chrono::seconds(10)};
  std::string unknown_ = "free";
  std::string clearance_;
  std::set<std::string> told_;
  std::string refused_;  // why the server refuses one of the publishers; empty: it does not
  std::string last_refused_;
  std::optional<ros::LiveClouds> clouds_in_;
  std::optional<ros::MarkerObjects> markers_in_;
  std::int64_t clock_ns_ = 0;  // of /clock; 0: it has not come yet
  std::string name_ = "collide ros";
  std::optional<std::chrono::nanoseconds> time_;
  std::string last_error_;
  ros::FollowedFramesOptions follow_;
  std::size_t broadcasters_ = 0;
  bool has_joint_states_ = false;
  bool shows_objects_ = false;
  bool sends_tf_ = false;
  bool has_clock_ = false;
  bool has_told_static_ = false;
};

}  // namespace

std::unique_ptr<Command> make_ros() { return std::make_unique<RosCommand>(); }

}  // namespace collided::cli
