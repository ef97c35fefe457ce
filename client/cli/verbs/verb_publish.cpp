#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/solid_flag.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/package_folder.hpp"
#include "client/cli/input/shape_file.hpp"
#include "client/cli/input/shape_text.hpp"
#include "client/cli/publish/bounce_source.hpp"
#include "client/cli/publish/csv_source.hpp"
#include "client/cli/publish/loop.hpp"
#include "client/cli/publish/path.hpp"
#include "client/cli/publish/robot_source.hpp"
#include "client/cli/publish/voxel_source.hpp"
#include "client/cli/publish/walker.hpp"

namespace collided::cli {
namespace {

enum class Kind { poses, recording, robot, spheres, path, voxels };

/// An option of only some kinds of publisher: its text as written, and those kinds.
struct Setting {
  const char* name;
  std::string_view value;  // its name in the help; empty: a flag
  std::vector<Kind> kinds;
  const char* meaning;
  std::string text = {};
  bool flag = false;
  bool given = false;
};

class PublishCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(
        app, "file FILE", file_,
        "Poses (.csv, -), a motion capture (.bvh), with --joints a robot (.urdf), with --voxels a scan (.pcd, .xyz)");
    declare_group(app, "Pace", {"--rate", "--speed", "--gap", "--loop", "--stay", "--steps", "--for"});
    declare_group(app, "Objects", {"--shape", "--name", "--solid", "--layers", "--mask", "--when-lost", "--as"});
    declare_group(app, "Motion capture", {"--unit", "--radius", "--bone-radius", "--up", "--group"});
    declare_group(app, "Robot", {"--joints", "--at", "--rpy", "--beyond-limits", "--package"});
    declare_group(app, "Spheres in a cube",
                  {"--spheres", "--polygons", "--round", "--size", "--side", "--seed", "--spin", "--bounce",
                   "--as-asked", "--response", "--restitution", "--stiffness"});
    declare_group(app, "Scan", {"--voxels", "--from", "--unknown", "--decay", "--reach"});
    declare_group(app, "Path", {"--path", "--waypoints", "--face"});
  }

  Exit run(Session& session, const Globals& globals) override {
    setting("--solid").flag = solid_.is_given();
    for (Setting& setting : settings_) setting.given = setting.given || setting.flag || !setting.text.empty();
    const Kind kind = kind_of_run();
    for (const Setting& setting : settings_) refuse_unless_known(setting, kind);
    if (!globals.shards.empty() && (kind == Kind::robot || kind == Kind::voxels))
      throw bad_use(fmt::format("{} is published to one server, so --shards is not for it",
                                kind == Kind::robot ? "a robot" : "a scan"));
    PublishLoopOptions loop = loop_options();
    const std::unique_ptr<MotionSource> source = make_source(session.io, kind, loop);
    return publish(session, globals, *source, loop);
  }

  bool takes_shards() const override { return true; }

 private:
  Setting& setting(std::string_view name) {
    const auto found =
        std::find_if(settings_.begin(), settings_.end(), [&](const Setting& entry) { return name == entry.name; });
    if (found == settings_.end()) throw std::logic_error(fmt::format("no setting {}", name));
    return *found;
  }
  const std::string& text(std::string_view name) { return setting(name).text; }
  bool given(std::string_view name) { return setting(name).given; }

  void declare_group(CLI::App& app, const std::string& group, std::initializer_list<const char*> names) {
    for (const char* name : names) {
      Setting& entry = setting(name);
      if (std::string_view(entry.name) == "--solid") {
        solid_.declare(app, entry.meaning);
        app.get_option("--solid")->group(group);
        continue;
      }
      if (entry.value.empty()) app.add_flag(name, entry.flag, entry.meaning)->group(group);
      else option(app, fmt::format("{} {}", name, entry.value), entry.text, entry.meaning)->group(group);
    }
  }

  Kind kind_of_run() {
    const int motions = !file_.empty() + given("--spheres") + given("--path") + given("--waypoints");
    if (given("--voxels") && file_.empty()) throw bad_use("--voxels needs the file of a scan");
    if (motions == 0) throw bad_use("what? a file of poses, --spheres N, --path FILE or --waypoints \"X,Y,Z X,Y,Z\"");
    if (motions > 1) throw bad_use("a file, --spheres, --path and --waypoints exclude each other");
    if (given("--voxels")) return Kind::voxels;
    if (given("--spheres")) return Kind::spheres;
    if (file_.empty()) return Kind::path;
    if (given("--joints") || file_.ends_with(".urdf")) return Kind::robot;
    return file_.ends_with(".bvh") ? Kind::recording : Kind::poses;
  }

  static void refuse_unless_known(const Setting& setting, Kind kind) {
    const bool known =
        setting.kinds.empty() || std::find(setting.kinds.begin(), setting.kinds.end(), kind) != setting.kinds.end();
    if (setting.given && !known)
      throw bad_use(fmt::format("{} has no meaning for this kind of publisher", setting.name), "collide help publish");
  }

  double positive(std::string_view name, Measure measure, double otherwise) {
    if (!given(name)) return otherwise;
    const double value = parse_finite(text(name), measure);
    if (!(value > 0)) throw bad_use(fmt::format("{} {} must be above 0", name, text(name)));
    return value;
  }

  PublishLoopOptions loop_options() {
    PublishLoopOptions loop;
    loop.publisher_name = given("--as") ? text("--as") : "collide publish";
    loop.loop = setting("--loop").flag;
    loop.stay = setting("--stay").flag;
    if (given("--steps")) loop.most_frames = parse_count(text("--steps"), 1);
    if (given("--for")) loop.most_time = parse_duration(text("--for"));
    if (given("--gap")) loop.gap = gap_of(text("--gap"));
    return loop;
  }

  static std::chrono::nanoseconds gap_of(const std::string& text) {
    const std::chrono::nanoseconds gap = parse_duration(text);
    if (gap < std::chrono::milliseconds(1) || gap > std::chrono::seconds(8))
      throw bad_use(fmt::format("--gap {}; allowed 1ms to 8s", text));
    return gap;
  }

  ObjectTexts object_texts() {
    ObjectTexts objects;
    if (given("--layers")) objects.layers = parse_bits(text("--layers"));
    if (given("--mask")) objects.mask = parse_bits(text("--mask"));
    objects.solid = solid_.is_given();
    objects.solid_by_winding = solid_.is_by_winding();
    const std::string& lost = text("--when-lost");
    if (lost == "freeze") objects.lost_policy = LostPolicy::freeze;
    else if (lost == "hold") objects.lost_policy = LostPolicy::hold;
    else if (!lost.empty() && lost != "remove")
      throw bad_use(fmt::format("--when-lost '{}'; allowed: remove, freeze, hold", lost));
    return objects;
  }

  std::unique_ptr<MotionSource> make_source(Io& io, Kind kind, PublishLoopOptions& loop) {
    switch (kind) {
      case Kind::poses: return poses(io, loop);
      case Kind::recording: return recording(loop);
      case Kind::robot: return robot(io, loop);
      case Kind::spheres: return spheres();
      case Kind::voxels: return voxels(io, loop);
      case Kind::path: break;
    }
    return path(io);
  }

  std::unique_ptr<MotionSource> poses(Io& io, PublishLoopOptions& loop) {
    loop.rate_hz = positive("--rate", Measure::rate, 0);
    loop.speed = positive("--speed", Measure::none, 1);
    if (loop.loop && file_ == "-") throw bad_use("--loop needs a file that can be read again, not a pipe");
    CsvSourceOptions options{.path = file_, .objects = object_texts(), .paced = loop.rate_hz > 0};
    if (given("--shape")) options.shape = shape_of_text(text("--shape"), io);
    return make_csv_source(io, options);
  }

  std::unique_ptr<MotionSource> recording(PublishLoopOptions& loop) {
    loop.rate_hz = positive("--rate", Measure::rate, 0);
    loop.speed = positive("--speed", Measure::none, 1);
    WalkerOptions options;
    options.objects = object_texts();
    options.name = given("--name") ? text("--name") : "walker";
    options.unit_m = positive("--unit", Measure::length, 1);
    options.foot_radius_m = positive("--radius", Measure::length, options.foot_radius_m);
    options.bone_radius_m = positive("--bone-radius", Measure::length, options.bone_radius_m);
    if (given("--group")) options.group = parse_bits(text("--group"));
    if (given("--up") && text("--up") != "y" && text("--up") != "z")
      throw bad_use(fmt::format("--up '{}'; allowed: y, z", text("--up")));
    if (given("--up")) options.up = text("--up").front();
    return make_walker(read_bvh(file_), options);
  }

  std::unique_ptr<MotionSource> robot(Io& io, PublishLoopOptions& loop) {
    if (!given("--joints")) throw bad_use("a robot moves by its joints", "--joints FILE: t and the names of joints");
    loop.rate_hz = positive("--rate", Measure::rate, 0);
    loop.speed = positive("--speed", Measure::none, 1);
    if (loop.loop && text("--joints") == "-") throw bad_use("--loop needs a file that can be read again, not a pipe");
    RobotSourceOptions options{.robot_path = file_, .joints_path = text("--joints"), .scene = text("--name")};
    options.base = parse_pose(text("--at"), text("--rpy"), {});
    print_warning(io, angle_warning("--rpy", text("--rpy")));
    if (given("--when-lost")) options.lost_policy = object_texts().lost_policy;
    options.beyond_limits = setting("--beyond-limits").flag;
    if (given("--package")) options.package = absolute_package(text("--package"));
    options.paced = loop.rate_hz > 0;
    return make_robot_source(io, options);
  }

  /// Without an end of its own the scan stays: a scan that is removed at once is useless.
  std::unique_ptr<MotionSource> voxels(const Io& io, PublishLoopOptions& loop) {
    loop.stay = loop.stay || !given("--steps");
    VoxelSourceOptions options{.path = file_, .name = given("--name") ? text("--name") : stem_of(file_)};
    options.objects = object_texts();
    if (!given("--when-lost")) options.objects.lost_policy = LostPolicy::freeze;
    options.voxels.cell_m = positive("--voxels", Measure::length, 0);
    options.voxels.reach_m = positive("--reach", Measure::length, options.voxels.reach_m);
    if (given("--decay")) options.voxels.decay = parse_duration(text("--decay"));
    if (given("--from")) options.origin = parse_vector(text("--from"), Measure::length);
    const std::string& unknown = text("--unknown");
    if (unknown == "undecided") options.voxels.unknown = UnknownCells::undecided;
    else if (unknown == "occupied") options.voxels.unknown = UnknownCells::occupied;
    else if (!unknown.empty() && unknown != "free")
      throw bad_use(fmt::format("--unknown '{}'; allowed: free, undecided, occupied", unknown));
    if (given("--unknown") && unknown != "free" && !options.origin)
      throw bad_use("without --from no space is known to be free", "--from X,Y,Z: where the sensor stood");
    options.rate_hz = loop.rate_hz = positive("--rate", Measure::rate, options.rate_hz);
    return make_voxel_source(io, options);
  }

  static std::string stem_of(const std::string& path) {
    const std::string file = path.substr(path.rfind('/') + 1);
    const std::string stem = file.substr(0, file.rfind('.'));
    return stem.empty() ? "scan" : stem;
  }

  std::unique_ptr<MotionSource> spheres() {
    constexpr std::uint64_t kMostSpheres = 1'000'000;
    constexpr std::uint64_t kMostPolygons = 1'000'000;
    BounceSourceOptions options;
    options.objects = object_texts();
    options.bounce.sphere_count = parse_count(text("--spheres"), 1);
    if (options.bounce.sphere_count > kMostSpheres)
      throw bad_use(fmt::format("--spheres {}, allowed {}", text("--spheres"), kMostSpheres));
    if (given("--polygons")) options.polygon_count = parse_count(text("--polygons"), 6);
    if (options.polygon_count > kMostPolygons)
      throw bad_use(fmt::format("--polygons {}, allowed {}", text("--polygons"), kMostPolygons));
    options.bounce.relative_size = positive("--size", Measure::none, options.bounce.relative_size);
    options.bounce.side_m = positive("--side", Measure::length, options.bounce.side_m);
    options.bounce.speed_m_s = positive("--speed", Measure::speed, options.bounce.speed_m_s);
    options.bounce.spin_rad_s = positive("--spin", Measure::none, 0);
    if (given("--seed")) options.bounce.seed = parse_count(text("--seed"));
    options.bounce.as_asked = setting("--as-asked").flag;
    options.bounces = setting("--bounce").flag || options.bounce.as_asked;
    read_response(options);
    options.round = setting("--round").flag;
    options.rate_hz = positive("--rate", Measure::rate, options.rate_hz);
    if (given("--name")) options.name = text("--name");
    return make_bounce_source(options);
  }

  void read_response(BounceSourceOptions& options) {
    using response::ResponseLaw;
    BounceOptions& bounce = options.bounce;
    const std::string& answer = text("--response");
    if (answer == "impulse") bounce.answer = ResponseLaw::impulse;
    else if (answer == "compliant") bounce.answer = ResponseLaw::compliant;
    else if (!answer.empty() && answer != "flip")
      throw bad_use(fmt::format("--response '{}'; allowed: flip, impulse, compliant", answer));
    if (given("--response") && !options.bounces) throw bad_use("--response answers contacts: it needs --bounce");
    if (bounce.as_asked && bounce.answer != ResponseLaw::flip)
      throw bad_use("--as-asked is a way to flip, and --response something else");
    if (given("--restitution") && bounce.answer == ResponseLaw::flip)
      throw bad_use("--restitution needs --response impulse or compliant");
    if (given("--stiffness") && bounce.answer != ResponseLaw::compliant)
      throw bad_use("--stiffness needs --response compliant");
    bounce.restitution = given("--restitution") ? parse_finite(text("--restitution"), Measure::none) : 1;
    bounce.stiffness_n_m = positive("--stiffness", Measure::none, bounce.stiffness_n_m);
    // The range for which the response library is tested.
    if (!(bounce.stiffness_n_m >= 1e2 && bounce.stiffness_n_m <= 1e12))
      throw bad_use(fmt::format("--stiffness {}, allowed 1e2 to 1e12 N/m", text("--stiffness")));
  }

  std::unique_ptr<MotionSource> path(Io& io) {
    PathOptions options;
    options.objects = object_texts();
    if (given("--name")) options.name = text("--name");
    if (given("--shape")) options.shape = shape_of_text(text("--shape"), io);
    options.speed_m_s = positive("--speed", Measure::speed, options.speed_m_s);
    options.rate_hz = positive("--rate", Measure::rate, options.rate_hz);
    options.face_forward = setting("--face").flag;
    std::vector<Vec3> points =
        given("--path") ? read_waypoints(io, text("--path")) : parse_waypoints(text("--waypoints"));
    return make_path_source(std::move(points), setting("--loop").flag, options);
  }

  std::string file_;
  SolidFlag solid_;
  std::vector<Setting> settings_{
      {"--rate", "HZ", {}, "Frames a second (recordings: their own times; spheres 60, path 100)"},
      {"--speed", "SPEED", {}, "Of a recording: times faster (1); of spheres and paths: m/s (0.5, 1)"},
      {"--gap",
       "TIME",
       {},
       "Poses of an object at most this far apart connect; beyond, it rested until one gap before (1.5s)"},
      {"--loop", "", {Kind::poses, Kind::recording, Kind::robot, Kind::path, Kind::voxels}, "Again from the start"},
      {"--stay", "", {}, "After the last frame: keep the objects until Ctrl-C"},
      {"--steps", "N", {}, "End after so many frames"},
      {"--for", "TIME", {}, "End after this time"},
      {"--shape", "SHAPE", {Kind::poses, Kind::path}, "sphere:0.1 (default), box:0.4,0.4,0.4, mesh:part.stl"},
      {"--name",
       "NAME",
       {Kind::recording, Kind::robot, Kind::spheres, Kind::path, Kind::voxels},
       "Of the object or the robot's scene, or what its parts' names begin with"},
      {"--solid",
       "",
       {Kind::poses, Kind::path},
       "The mesh of --shape is the border of a solid; refused where it does not close; =winding: solid by winding "
       "number then"},
      {"--layers",
       "BITS",
       {Kind::poses, Kind::recording, Kind::spheres, Kind::path, Kind::voxels},
       "Layers the objects are in: bits (1)"},
      {"--mask",
       "BITS",
       {Kind::poses, Kind::recording, Kind::spheres, Kind::path},
       "Layers that they meet: bits (all)"},
      {"--when-lost", "WHAT", {}, "If this publisher is lost: remove (default; robots, scans: freeze), freeze or hold"},
      {"--as", "NAME", {}, "Name of the publisher"},
      {"--unit", "UNIT", {Kind::recording}, "Metres a unit of the file (1): 0.056444, 1cm"},
      {"--radius", "LENGTH", {Kind::recording}, "Of the spheres at feet and toes (0.12)"},
      {"--bone-radius", "LENGTH", {Kind::recording}, "Of the other bones (0.05)"},
      {"--up", "AXIS", {Kind::recording}, "y: as recorded (default); z: turned so that z is up"},
      {"--group", "N", {Kind::recording}, "Parts of one group never meet (made from the name)"},
      {"--joints", "FILE", {Kind::robot}, "Positions of its joints (.csv, -): t and the names of joints, rad and m"},
      {"--at", "X Y Z", {Kind::robot}, "Where its root link stands: 1,2,0"},
      {"--rpy", "R P Y", {Kind::robot}, "Roll, pitch and yaw of its root link: 0,0,90deg"},
      {"--beyond-limits", "", {Kind::robot}, "Take positions beyond the joints' limits"},
      {"--package", "NAME=DIR", {Kind::robot}, "NAME=DIR, where a package lies that the robot's file names"},
      {"--spheres", "N", {Kind::spheres}, "So many spheres in a cube about the origin"},
      {"--polygons", "N", {Kind::spheres}, "Triangles a sphere, by latitude and longitude (256)"},
      {"--round", "", {Kind::spheres}, "Real spheres instead of polygons"},
      {"--size", "SIZE", {Kind::spheres}, "Mean diameter over the cube's side (0.2)"},
      {"--side", "LENGTH", {Kind::spheres}, "Of the cube (1)"},
      {"--seed", "N", {Kind::spheres}, "Of sizes, places and velocities (7)"},
      {"--spin", "RATE", {Kind::spheres}, "Largest angular speed, rad/s (0)"},
      {"--bounce", "", {Kind::spheres}, "On contact: flip velocities, once a contact"},
      {"--as-asked", "", {Kind::spheres}, "On contact: flip on every frame, as the homework words it"},
      {"--response", "NAME", {Kind::spheres}, "To a contact: flip (default), impulse or compliant (spring and damper)"},
      {"--restitution", "FACTOR", {Kind::spheres}, "Of impulse 0 to 1, of compliant 0.001 to 1 (1: no energy is lost)"},
      {"--stiffness", "NUMBER", {Kind::spheres}, "Of compliant, N/m: 1e2 to 1e12 (1e6); pressed by v sqrt(m/k)"},
      {"--voxels", "LENGTH", {Kind::voxels}, "Cells of this side that hold points are occupied: 0.05"},
      {"--from", "X Y Z", {Kind::voxels}, "Where the sensor stood: what lies before the points is free: 0,0,1.2"},
      {"--unknown",
       "WORD",
       {Kind::voxels},
       "What no scan has met: free (default), undecided (not_covered) or occupied"},
      {"--decay", "TIME", {Kind::voxels}, "What was not met for so long is unknown again (never): 5s"},
      {"--reach", "LENGTH", {Kind::voxels}, "Points farther from the sensor do not count (no limit)"},
      {"--path", "FILE", {Kind::path}, "One object along the points of this file: x,y,z"},
      {"--waypoints", "POINTS", {Kind::path}, "One object along these points: \"0,0,1 2,0,1\""},
      {"--face", "", {Kind::path}, "Its x axis points along the way"},
  };
};

}  // namespace

std::unique_ptr<Command> make_publish() { return std::make_unique<PublishCommand>(); }

}  // namespace collided::cli
