#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/solid_flag.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/shape_file.hpp"
#include "client/cli/input/package_folder.hpp"
#include "client/cli/input/shape_text.hpp"
#include "client/cli/output/described_record.hpp"
#include "client/cli/output/progress.hpp"
#include "client/cli/server_command.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/verbs/undo.hpp"
#include "idl/answers/commands.hpp"
#include "idl/commands.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

namespace wire = wire_contract::command;

/// Warns if a change is lost when the server ends, and adds that to the record. If the server keeps nothing at all,
/// `status` and `plan` report it: a warning with every command would not be read.
void tell_not_kept(Session& session, const nlohmann::json& answer, Record& record) {
  const std::string why = text_of(answer, "not_kept");
  if (why.empty()) return;
  record.push_back({"not_kept", why});
  if (flag_of(answer, "keeps_nothing")) return;
  print_warning(session.io, "done, not kept: " + printable(why) + ". It is lost when the server ends");
}

/// Prints a command's answer: as a record for machines, or as one line for people.
void print_done(Session& session, const Globals& globals, const nlohmann::json& answer, Record record,
                const std::string& line) {
  tell_not_kept(session, answer, record);
  Printer printer = make_printer(session.io, globals);
  // For people the line is not data, so -q omits it.
  if (!printer.human()) printer.record(record);
  else if (!globals.quiet) printer.line(line);
  printer.finish();
}

nlohmann::json with_durable(nlohmann::json arguments, bool durable) {
  if (durable) arguments["durable"] = true;
  return arguments;
}

void declare_durable(CLI::App& app, bool& durable) {
  app.add_flag("--durable", durable, "Refuse it where it would not outlive the server");
}

std::vector<std::byte> bytes_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  if (!file || size < 0) throw Failure(Exit::bad_use, fmt::format("{} cannot be read: {}", path, std::strerror(errno)));
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  file.seekg(0);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), size))
    throw Failure(Exit::bad_use, fmt::format("{} cannot be read to its end", path));
  return bytes;
}

std::string joined(const std::vector<std::string>& names, std::size_t most = 5) {
  std::string text;
  for (std::size_t at = 0; at < std::min(most, names.size()); ++at)
    text += (at == 0 ? "" : ", ") + printable(names[at]);
  if (names.size() > most) text += fmt::format(" and {} more", names.size() - most);
  return text;
}

class AddCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "words", words_, "NAME SHAPE NUMBERS");
    option(app, "--at X Y Z", at_, "Position X Y Z");
    option(app, "--rpy R P Y", rpy_, "Roll, pitch, yaw: 0 0 30deg");
    option(app, "--quat W X Y Z", quat_, "Rotation w x y z");
    option(app, "--layers", layers_, "Layers it is in: bits (1)");
    option(app, "--mask", mask_, "Layers that it meets: bits (all)");
    read_option(app, "--group N", group_, "Members of one group other than 0 never meet", parse_bits);
    option(app, "--scale FACTOR", scale_, "Factor, or X,Y,Z for boxes, ellipsoids, heights");
    declare_mesh_reading(app, reading_);
    app.add_flag("--static", static_, "It will not move (a plane never does)");
    solid_.declare(
        app, "A mesh with what it encloses; refused if it does not close; =winding: not then, but by winding number");
    declare_durable(app, durable_);
  }

  Exit run(Session& session, const Globals& globals) override {
    if (words_.size() < 2) throw bad_use("a name and a shape are needed", kShapeForms);
    const std::string& name = words_[0];
    print_warning(session.io, angle_warning("--rpy", rpy_));
    const ShapePart shape = shape_of_words({words_.begin() + 1, words_.end()}, session.io, reading_);
    // A plane is unbounded, so it is static without --static.
    const bool moving = !static_ && !std::holds_alternative<HalfSpaceShape>(shape);
    nlohmann::json arguments{{"name", name},      {"pose", pose_json(parse_pose(at_, rpy_, quat_))},
                             {"layers", layers_}, {"mask", mask_},
                             {"group", group_},   {"scale", scale()},
                             {"moving", moving}};
    if (solid_.is_given()) arguments["solid"] = true;
    if (solid_.is_by_winding()) arguments["solid_by"] = "winding";
    const nlohmann::json answer =
        server_command(session, globals, wire::kAdd, with_durable(arguments, durable_), {shape});
    const auto [id, version, not_kept, warning] = answer_in<Added>(answer);
    if (!warning.empty())
      print_warning(session.io, printable(warning) + (solid_.is_by_winding() && warning.starts_with("solid by")
                                                          ? ""
                                                          : ": inside is where the mesh goes around a point"));
    print_done(session, globals, answer, {{"added", std::string(name)}, {"id", id}, {"world", version}},
               fmt::format("added {} (world {})", printable(name), version));
    return Exit::yes;
  }

 private:
  nlohmann::json scale() const {
    const std::vector<double> factors = parse_numbers({scale_});
    if (factors.size() == 1) return {factors[0], factors[0], factors[0]};
    if (factors.size() != 3) throw bad_use(fmt::format("--scale {}: one factor or three are needed", scale_));
    return {factors[0], factors[1], factors[2]};
  }

  std::vector<std::string> words_;
  MeshReading reading_;
  std::string scale_ = "1";
  std::string at_;
  std::string rpy_;
  std::string quat_;
  std::uint32_t layers_ = 1;
  std::uint32_t mask_ = 0xffffffff;
  std::uint32_t group_ = 0;
  bool static_ = false;
  SolidFlag solid_;
  bool durable_ = false;
};

class MoveCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "words OBJECT X Y Z", words_, "NAME X Y Z");
    option(app, "--rpy R P Y", rpy_, "Roll, pitch, yaw: 0 0 30deg (without: as it is)");
    option(app, "--quat W X Y Z", quat_, "Rotation w x y z");
    app.add_flag("--by", by_, "X Y Z is added to where it is");
    app.add_flag("--teleport", teleport_, "Nothing lies on the way");
    declare_durable(app, durable_);
  }

  Exit run(Session& session, const Globals& globals) override {
    if (words_.empty()) throw bad_use("which object?", "collide move NAME X Y Z");
    const std::string& name = words_[0];
    const std::vector<double> numbers = parse_numbers({words_.begin() + 1, words_.end()}, Measure::length);
    if (numbers.size() != 3) throw bad_use(fmt::format("{} numbers; a position takes 3", numbers.size()));
    print_warning(session.io, angle_warning("--rpy", rpy_));
    Pose pose = parse_pose({}, rpy_, quat_);
    pose.position = Vec3(numbers[0], numbers[1], numbers[2]);
    if (!pose.position.allFinite()) throw bad_use("a position must be finite");
    if (by_ || (rpy_.empty() && quat_.empty())) start_from_present(session, globals, name, pose);
    const nlohmann::json answer =
        object_command(session, globals, wire::kMove, name,
                       with_durable({{"name", name}, {"pose", pose_json(pose)}, {"teleport", teleport_}}, durable_));
    print(session, globals, name, answer);
    return Exit::yes;
  }

 private:
  void start_from_present(Session& session, const Globals& globals, const std::string& name, Pose& pose) const {
    const std::vector<double> now =
        numbers_of(object_command(session, globals, wire::kGet, name, {{"name", name}}), "pose");
    if (now.size() != 7) throw Failure(Exit::refused, fmt::format("the server gave no pose for '{}'", name));
    if (rpy_.empty() && quat_.empty()) pose.rotation = Quat(now[3], now[4], now[5], now[6]);
    if (by_) pose.position += Vec3(now[0], now[1], now[2]);
  }

  static void print(Session& session, const Globals& globals, const std::string& name, const nlohmann::json& answer) {
    const auto moved = answer_in<Moved>(answer);
    std::string line =
        fmt::format("moved {} {}", printable(name), readable_length(moved.distance_m, 0, Digits::rounded));
    if (!moved.began.empty()) line += "; began to touch " + joined(moved.began);
    if (!moved.ended.empty()) line += "; stopped touching " + joined(moved.ended);
    print_done(session, globals, answer,
               {{"moved", std::string(name)},
                {"distance", moved.distance_m},
                {"began", raw_json(moved.began)},
                {"ended", raw_json(moved.ended)},
                {"world", moved.version}},
               line);
  }

  std::vector<std::string> words_;
  std::string rpy_;
  std::string quat_;
  bool by_ = false;
  bool teleport_ = false;
  bool durable_ = false;
};

class RemoveCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "names GLOB", names_, "Names or globs");
    declare_durable(app, durable_);
  }

  Exit run(Session& session, const Globals& globals) override {
    if (names_.empty()) throw bad_use("which object?");
    std::size_t removed_count = 0;
    for (const std::string& name : names_) removed_count += remove(session, globals, name);
    return removed_count > 0 ? Exit::yes : Exit::no;
  }

 private:
  std::size_t remove(Session& session, const Globals& globals, const std::string& name) const {
    const bool is_glob = name.find_first_of("*?[") != std::string::npos;
    const nlohmann::json arguments = with_durable({{"name", name}}, durable_);
    const Undo undo = undo_of(session, globals, {.names = name});
    const nlohmann::json answer = is_glob ? server_command(session, globals, wire::kRemove, arguments)
                                          : object_command(session, globals, wire::kRemove, name, arguments);
    const auto [removed, ended, version, not_kept] = answer_in<Removed>(answer);
    std::string line = removed.empty() ? fmt::format("nothing is named '{}'", printable(name))
                                       : fmt::format("removed {} (world {})", joined(removed), version);
    if (ended > 0) line += fmt::format("; it had {}, ended (removed)", counted(ended, "open contact"));
    print_done(session, globals, answer, {{"removed", raw_json(removed)}, {"ended", ended}, {"world", version}}, line);
    if (const std::vector<std::string> detached = texts_of(answer, "detached"); !detached.empty())
      print_hint(session.io, globals, fmt::format("attached to it until now, and still there: {}", joined(detached)));
    if (!removed.empty()) print_undo(session, globals, undo);
    return removed.size();
  }

  std::vector<std::string> names_;
  bool durable_ = false;
};

class LoadCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "file FILE", path_,
           "File that the server can read; with --upload, that this side can read; embedded: for the small one inside");
    app.add_flag("--upload", upload_,
                 "Send the file's bytes; the server reads them in a process that may do nothing else");
    option(app, "--name NAME", options_.name, "Name of the scene (the file's stem)");
    option(app, "--unit UNIT", unit_, "Of the file: m, mm, in, ... or metres a unit (m)");
    option(app, "--up AXIS", options_.up, "Axis of the file that points up: y or z (as the format says, else z)")
        ->check(CLI::IsMember({"y", "z"}));
    option(app, "--radius", Measure::length, options_.radius_m,
           "Of the balls about the points of an .xyz or .pcd file (0)");
    app.add_flag("--strict", options_.strict, "Refuse what would be mended");
    app.add_flag("--mend", options_.mend, "Cut edges at T-vertices and close cracks");
    option(app, "--crack", Measure::length, options_.crack_m, "Widest crack (a ten-thousandth of the diagonal)");
    option(app, "--srdf FILE", options_.srdf, "Of a .urdf robot: the file that says which links may touch");
    option(app, "--package NAME=DIR", options_.packages,
           "Of a .urdf robot: NAME=DIR, where a package that it names lies")
        ->allow_extra_args(false);
    app.add_flag("--replace", options_.replace, "Replace the scene of that name");
    app.add_flag("--moving", options_.moving, "Its objects take poses: of `move`, or of a publisher that claims them");
    solid_.declare(app,
                   "Its meshes with what they enclose; those that do not close stay surfaces; =winding: they are by "
                   "winding number");
    option(app, "--solid-only GLOB", options_.solid, "The same for parts and objects whose name matches this glob");
    option(app, "--covers BOX", covers_,
           "Box X0,Y0,Z0:X1,Y1,Z1 in which it is complete; outside of all such nothing is called free")
        ->allow_extra_args(false);
    declare_durable(app, durable_);
  }

  Exit run(Session& session, const Globals& globals) override {
    if (path_.empty()) throw bad_use("which file?", "collide load FILE");
    options_.unit_m = unit_in_metres();
    if (!options_.srdf.empty()) options_.srdf = absolute(options_.srdf);
    for (std::string& package : options_.packages) package = absolute_package(package);
    options_.solid_by_winding = solid_.is_by_winding();
    if (solid_.is_given() && !options_.solid_by_winding && !options_.solid.empty())
      throw bad_use("--solid and --solid-only exclude each other");
    if (solid_.is_given() && options_.solid.empty()) options_.solid = "*";
    for (const std::string& box : covers_) options_.covers.push_back(box_of(box));
    nlohmann::json arguments = with_durable(json_of(options_), durable_);
    if (upload_ && !options_.srdf.empty())
      throw bad_use("--srdf names a file of the server's; an uploaded file comes alone");
    const bool is_embedded = path_ == "embedded:";
    if (!upload_) arguments["path"] = is_embedded ? path_ : absolute(path_);
    const nlohmann::json answer = upload_ ? upload(session, globals, arguments) : load(session, globals, arguments);
    const auto loaded = answer_in<Loaded>(answer);
    print(session, globals, answer, loaded);
    return loaded.refused.empty() ? Exit::yes : Exit::partly_refused;
  }

 private:
  static std::string absolute(const std::string& path) {
    return std::filesystem::absolute(path).lexically_normal().string();
  }
  double unit_in_metres() const {
    if (unit_.empty()) return 1;
    const double metres =
        is_number_text(unit_) ? parse_finite(unit_, Measure::length) : parse_finite("1" + unit_, Measure::length);
    if (!(metres > 0)) throw bad_use(fmt::format("--unit {} must be above 0", unit_));
    return metres;
  }

  static CoveredBox box_of(const std::string& text) {
    const std::size_t colon = text.find(':');
    const std::vector<double> low = parse_numbers({text.substr(0, colon)}, Measure::length);
    const std::vector<double> high =
        colon == std::string::npos ? std::vector<double>() : parse_numbers({text.substr(colon + 1)}, Measure::length);
    if (low.size() != 3 || high.size() != 3)
      throw bad_use(fmt::format("--covers {}: two corners are needed, X0,Y0,Z0:X1,Y1,Z1", text));
    const CoveredBox box{.low = Vec3(low.data()), .high = Vec3(high.data())};
    if ((box.low.array() > box.high.array()).any())
      throw bad_use(fmt::format("--covers {}: the lower corner comes first", text));
    return box;
  }

  /// Loads a file, with a progress bar. A server of another user, or with folders of its own such as a service's /tmp,
  /// may not see this side's files.
  nlohmann::json load(Session& session, const Globals& globals, const nlohmann::json& arguments) const {
    Progress progress(session.io, globals);
    try {
      return server_command(session, globals, wire::kLoad, arguments, {},
                            [&](double now) { progress.show(0, "loading", now); });
    } catch (const Failure& failure) {
      const bool is_unseen = std::string_view(failure.what()).find("cannot be opened") != std::string_view::npos;
      if (!is_unseen || !std::ifstream(path_).is_open()) throw;
      throw Failure(failure.code, failure.what(), "it is there on this side; --upload sends its bytes");
    }
  }

  /// Uploads a file and loads it. Characters of its name that a server does not accept are replaced.
  nlohmann::json upload(Session& session, const Globals& globals, const nlohmann::json& arguments) const {
    const std::vector<std::byte> bytes = bytes_of_file(path_);
    std::string name = std::filesystem::path(path_).filename().string();
    for (char& c : name) {
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '-') c = '_';
    }
    Progress progress(session.io, globals);
    return upload_command(session, globals, bytes, name, arguments,
                          [&](double now) { progress.show(0, "sending and loading", now); });
  }

  static void print(Session& session, const Globals& globals, const nlohmann::json& answer, const Loaded& loaded) {
    Printer printer = make_printer(session.io, globals);
    Record record = record_of(loaded);
    record.pop_back();  // not_kept
    place_of(record, "version")->name = "world";
    if (loaded.covers.empty()) record.back().value = Value();
    tell_not_kept(session, answer, record);
    printer.set_usual_fields({"scene", "parts", "triangles", "objects", "refused", "warnings", "world"});
    if (!printer.human()) return printer.record(record);
    if (globals.quiet) return;
    const auto seconds = std::chrono::duration<double>(loaded.seconds);
    printer.line(fmt::format("loaded '{}' in {}  world {}", printable(loaded.scene),
                             format_duration(std::chrono::duration_cast<std::chrono::nanoseconds>(seconds)),
                             loaded.version));
    printer.line(fmt::format("  {}, {}, {}", counted(loaded.parts, "part"), counted(loaded.triangles, "triangle"),
                             counted(loaded.objects, "object")));
    const auto lines = [&](const char* label, const std::vector<std::string>& texts) {
      for (const std::string& text : texts) printer.line(fmt::format("  {:<9}{}", label, printable(text)));
    };
    lines("placed", loaded.placed);
    lines("note", loaded.notes);
    lines("mended", loaded.mended);
    lines("refused", loaded.refused);
    lines("warning", loaded.warnings);
  }

  std::string path_;
  std::string unit_;
  std::vector<std::string> covers_;
  SolidFlag solid_;
  LoadOptions options_;
  bool upload_ = false;
  bool durable_ = false;
};

class ClearCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "scene NAME", scene_, "Only this scene (all)");
    app.add_flag("--moving", moving_, "Only moving objects; with a scene: those too");
    declare_durable(app, durable_);
  }

  Exit run(Session& session, const Globals& globals) override {
    const bool objects_too = scene_.empty() || moving_;
    const bool scenes_too = !scene_.empty() || !moving_;
    const Undo undo =
        objects_too ? undo_of(session, globals, {.moving_only = moving_, .scenes_too = scenes_too, .scene = scene_})
                    : Undo{};
    const Undo scenes = scenes_too ? undo_of_scenes(session, globals, scene_) : Undo{};
    const nlohmann::json answer = server_command(session, globals, wire::kClear,
                                                 with_durable({{"scene", scene_}, {"moving", moving_}}, durable_));
    const auto [removed, kept, ended, version, not_kept] = answer_in<Cleared>(answer);
    std::string line =
        fmt::format("removed {}, ended {} (world {})", counted(removed, "object"), counted(ended, "contact"), version);
    if (kept > 0) line += fmt::format("; {} belong to publishers that live and stay", format_count(kept));
    print_done(session, globals, answer, {{"removed", removed}, {"kept", kept}, {"ended", ended}, {"world", version}},
               line);
    print_undo(session, globals, undo);
    print_undo(session, globals, scenes);
    return removed > 0 ? Exit::yes : Exit::no;
  }

 private:
  std::string scene_;
  bool moving_ = false;
  bool durable_ = false;
};

class AcceptLossCommand : public Command {
 public:
  void declare(CLI::App& app) override { app.add_flag("--show", show_, "Only say what is missing"); }

  Exit run(Session& session, const Globals& globals) override {
    const nlohmann::json answer = server_command(session, globals, wire::kAcceptLoss, {{"show", show_}});
    const std::vector<std::string> losses = texts_of(answer, "losses");
    std::string lines;
    for (const std::string& loss : losses) lines += "missing: " + printable(loss) + "\n";
    lines += losses.empty() ? "nothing is missing"
             : show_        ? "until that is accepted nothing is called free: collide accept-loss"
                            : "accepted: the world counts as whole without it";
    print_done(session, globals, answer, {{"losses", raw_json(losses)}, {"accepted", flag_of(answer, "accepted")}},
               lines);
    return losses.empty() ? Exit::no : Exit::yes;
  }

 private:
  bool show_ = false;
};

}  // namespace

std::unique_ptr<Command> make_add() { return std::make_unique<AddCommand>(); }
std::unique_ptr<Command> make_move() { return std::make_unique<MoveCommand>(); }
std::unique_ptr<Command> make_rm() { return std::make_unique<RemoveCommand>(); }
std::unique_ptr<Command> make_load() { return std::make_unique<LoadCommand>(); }
std::unique_ptr<Command> make_clear() { return std::make_unique<ClearCommand>(); }
std::unique_ptr<Command> make_accept_loss() { return std::make_unique<AcceptLossCommand>(); }

}  // namespace collided::cli
