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
#include "client/cli/output/progress.hpp"
#include "client/cli/server_command.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/verbs/undo.hpp"
#include "idl/commands.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

namespace wire = wire_contract::command;

/// Warns where what the server did is lost with a crash, and adds that to the record. Of a server that keeps nothing at
/// all `status` and `plan` say so: a warning with every command would be read by nobody.
void tell_not_kept(Session& session, const nlohmann::json& answer, Record& record) {
  const std::string why = text_of(answer, "not_kept");
  if (why.empty()) return;
  record.push_back({"not_kept", why});
  if (flag_of(answer, "keeps_nothing")) return;
  print_warning(session.io, "done, not kept: " + printable(why) + ". A crash of the server undoes it");
}

/// Prints a command's answer: as a record for machines, or as one line for people.
void print_done(Session& session, const Globals& globals, const nlohmann::json& answer, Record record,
                const std::string& line) {
  tell_not_kept(session, answer, record);
  Printer printer = make_printer(session.io, globals);
  // For people the line is no data, so -q leaves it out.
  if (!printer.human()) printer.record(record);
  else if (!globals.quiet) printer.line(line);
  printer.finish();
}

nlohmann::json with_durable(nlohmann::json arguments, bool durable) {
  if (durable) arguments["durable"] = true;
  return arguments;
}

void declare_durable(CLI::App& app, bool& durable) {
  app.add_flag("--durable", durable, "Refuse it where it would not outlive a crash of the server");
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

RawJson names_json(const std::vector<std::string>& names) {
  return {nlohmann::json(names).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
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
    const std::uint64_t version = count_of(answer, "version");
    const std::string warning = text_of(answer, "warning");
    if (!warning.empty())
      print_warning(session.io, printable(warning) + (solid_.is_by_winding() && warning.starts_with("solid by")
                                                          ? ""
                                                          : ": inside is where the mesh goes around a point"));
    print_done(session, globals, answer,
               {{"added", std::string(name)}, {"id", count_of(answer, "id")}, {"world", version}},
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
    const std::vector<std::string> began = texts_of(answer, "began");
    const std::vector<std::string> ended = texts_of(answer, "ended");
    std::string line =
        fmt::format("moved {} {}", printable(name), readable_length(number_of(answer, "moved_m"), 0, Digits::rounded));
    if (!began.empty()) line += "; began to touch " + joined(began);
    if (!ended.empty()) line += "; stopped touching " + joined(ended);
    print_done(session, globals, answer,
               {{"moved", std::string(name)},
                {"distance", number_of(answer, "moved_m")},
                {"began", names_json(began)},
                {"ended", names_json(ended)},
                {"world", count_of(answer, "version")}},
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
    const std::vector<std::string> removed = texts_of(answer, "removed");
    const std::uint64_t ended = count_of(answer, "ended");
    const std::uint64_t version = count_of(answer, "version");
    std::string line = removed.empty() ? fmt::format("nothing is named '{}'", printable(name))
                                       : fmt::format("removed {} (world {})", joined(removed), version);
    if (ended > 0) line += fmt::format("; it had {}, ended (removed)", counted(ended, "open contact"));
    print_done(session, globals, answer, {{"removed", names_json(removed)}, {"ended", ended}, {"world", version}},
               line);
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
    option(app, "--name NAME", name_, "Name of the scene (the file's stem)");
    option(app, "--unit UNIT", unit_, "Of the file: m, mm, in, ... or metres a unit (m)");
    option(app, "--up AXIS", up_, "Axis of the file that points up: y or z (as the format says, else z)")
        ->check(CLI::IsMember({"y", "z"}));
    option(app, "--radius", Measure::length, radius_m_, "Of the balls about the points of an .xyz or .pcd file (0)");
    app.add_flag("--strict", strict_, "Refuse what would be mended");
    app.add_flag("--mend", mend_, "Cut edges at T-vertices and close cracks");
    option(app, "--crack", Measure::length, crack_m_, "Widest crack (a ten-thousandth of the diagonal)");
    option(app, "--srdf FILE", srdf_, "Of a .urdf robot: the file that says which links may touch");
    option(app, "--package NAME=DIR", packages_, "Of a .urdf robot: NAME=DIR, where a package that it names lies")
        ->allow_extra_args(false);
    app.add_flag("--replace", replace_, "Replace the scene of that name");
    app.add_flag("--moving", moving_, "Its objects take poses: of `move`, or of a publisher that claims them");
    solid_.declare(app,
                   "Its meshes with what they enclose; those that do not close stay surfaces; =winding: they are by "
                   "winding number");
    option(app, "--solid-only GLOB", solid_only_, "The same for parts and objects whose name matches this glob");
    option(app, "--covers BOX", covers_,
           "Box X0,Y0,Z0:X1,Y1,Z1 in which it is complete; outside of all such nothing is called free")
        ->allow_extra_args(false);
    declare_durable(app, durable_);
  }

  Exit run(Session& session, const Globals& globals) override {
    if (path_.empty()) throw bad_use("which file?", "collide load FILE");
    nlohmann::json arguments{
        {"name", name_},
        {"unit_m", unit_in_metres()},
        {"up", up_},
        {"radius_m", radius_m_},
        {"strict", strict_},
        {"mend", mend_},
        {"crack_m", crack_m_},
        {"srdf", srdf_.empty() ? "" : std::filesystem::absolute(srdf_).lexically_normal().string()},
        {"replace", replace_}};
    arguments = with_durable(std::move(arguments), durable_);
    if (moving_) arguments["moving"] = true;
    for (const std::string& package : packages_) arguments["packages"].push_back(absolute_package(package));
    const bool is_by_winding = solid_.is_by_winding();
    if (solid_.is_given() && !is_by_winding && !solid_only_.empty())
      throw bad_use("--solid and --solid-only exclude each other");
    if (solid_.is_given() || !solid_only_.empty()) arguments["solid"] = solid_only_.empty() ? "*" : solid_only_;
    if (is_by_winding) arguments["solid_by"] = "winding";
    for (const std::string& box : covers_) arguments["covers"].push_back(box_json(box));
    if (upload_ && !srdf_.empty()) throw bad_use("--srdf names a file of the server's; an uploaded file comes alone");
    const bool is_embedded = path_ == "embedded:";
    if (!upload_)
      arguments["path"] = is_embedded ? path_ : std::filesystem::absolute(path_).lexically_normal().string();
    const nlohmann::json answer = upload_ ? upload(session, globals, arguments) : load(session, globals, arguments);
    print(session, globals, answer);
    return texts_of(answer, "refused").empty() ? Exit::yes : Exit::partly_refused;
  }

 private:
  double unit_in_metres() const {
    if (unit_.empty()) return 1;
    const double metres =
        is_number_text(unit_) ? parse_finite(unit_, Measure::length) : parse_finite("1" + unit_, Measure::length);
    if (!(metres > 0)) throw bad_use(fmt::format("--unit {} must be above 0", unit_));
    return metres;
  }

  static nlohmann::json box_json(const std::string& text) {
    const std::size_t colon = text.find(':');
    const std::vector<double> low = parse_numbers({text.substr(0, colon)}, Measure::length);
    const std::vector<double> high =
        colon == std::string::npos ? std::vector<double>() : parse_numbers({text.substr(colon + 1)}, Measure::length);
    if (low.size() != 3 || high.size() != 3)
      throw bad_use(fmt::format("--covers {}: two corners are needed, X0,Y0,Z0:X1,Y1,Z1", text));
    nlohmann::json box;
    for (const std::vector<double>* corner : {&low, &high}) {
      for (const double x : *corner)
        box.push_back(std::isinf(x) ? nlohmann::json(x > 0 ? "inf" : "-inf") : nlohmann::json(x));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (low[axis] > high[axis]) throw bad_use(fmt::format("--covers {}: the lower corner comes first", text));
    }
    return box;
  }

  /// Loads a file, with a progress bar. A server that is another user, or has folders of its own such as a service's
  /// /tmp, may not see what this side sees.
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

  static Value covers_of(const nlohmann::json& answer) {
    const auto covers = answer.find("covers");
    if (covers == answer.end() || covers->empty()) return {};
    return RawJson{covers->dump()};
  }

  static void print(Session& session, const Globals& globals, const nlohmann::json& answer) {
    Printer printer = make_printer(session.io, globals);
    Record record{{"scene", text_of(answer, "scene")},
                  {"triangles", count_of(answer, "triangles")},
                  {"parts", count_of(answer, "parts")},
                  {"objects", count_of(answer, "objects")},
                  {"seconds", number_of(answer, "seconds")},
                  {"notes", names_json(texts_of(answer, "notes"))},
                  {"mended", names_json(texts_of(answer, "mended"))},
                  {"refused", names_json(texts_of(answer, "refused"))},
                  {"warnings", names_json(texts_of(answer, "warnings"))},
                  {"left_out", names_json(texts_of(answer, "left_out"))},
                  {"world", count_of(answer, "version")},
                  {"placed", names_json(texts_of(answer, "placed"))},
                  {"covers", covers_of(answer)}};
    tell_not_kept(session, answer, record);
    printer.set_usual_fields({"scene", "parts", "triangles", "objects", "refused", "warnings", "world"});
    if (!printer.human()) return printer.record(record);
    if (globals.quiet) return;
    const auto seconds = std::chrono::duration<double>(number_of(answer, "seconds"));
    printer.line(fmt::format("loaded '{}' in {}  world {}", printable(text_of(answer, "scene")),
                             format_duration(std::chrono::duration_cast<std::chrono::nanoseconds>(seconds)),
                             count_of(answer, "version")));
    printer.line(fmt::format("  {}, {}, {}", counted(count_of(answer, "parts"), "part"),
                             counted(count_of(answer, "triangles"), "triangle"),
                             counted(count_of(answer, "objects"), "object")));
    const auto lines = [&](const char* label, const char* key) {
      for (const std::string& text : texts_of(answer, key))
        printer.line(fmt::format("  {:<9}{}", label, printable(text)));
    };
    lines("placed", "placed");
    lines("note", "notes");
    lines("mended", "mended");
    lines("refused", "refused");
    lines("warning", "warnings");
  }

  std::string path_;
  std::string name_;
  std::string unit_;
  std::string up_;
  double radius_m_ = 0;
  double crack_m_ = 0;
  std::string srdf_;
  std::vector<std::string> packages_;
  std::vector<std::string> covers_;
  std::string solid_only_;
  SolidFlag solid_;
  bool strict_ = false;
  bool mend_ = false;
  bool upload_ = false;
  bool replace_ = false;
  bool moving_ = false;
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
    const std::uint64_t removed = count_of(answer, "removed");
    const std::uint64_t ended = count_of(answer, "ended");
    const std::uint64_t kept = count_of(answer, "kept");
    std::string line = fmt::format("removed {}, ended {} (world {})", counted(removed, "object"),
                                   counted(ended, "contact"), count_of(answer, "version"));
    if (kept > 0) line += fmt::format("; {} belong to publishers that live and stay", format_count(kept));
    print_done(session, globals, answer,
               {{"removed", removed}, {"kept", kept}, {"ended", ended}, {"world", count_of(answer, "version")}}, line);
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
    print_done(session, globals, answer, {{"losses", names_json(losses)}, {"accepted", flag_of(answer, "accepted")}},
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
