#include "client/cli/verbs/undo.hpp"

#include <filesystem>
#include <functional>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/server_command.hpp"
#include "idl/answers/commands.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

namespace wire = wire_contract::command;

std::string joined(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : " ") + format_number(number + 0.0);
  return text;
}

bool all_zero(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double number) { return number == 0; });
}

/// Radius and length of a shape between two points, if these lie on z at the same height above and below the origin;
/// else nothing. `low` comes first in a capsule and a cylinder, last in a cone.
std::string upright_words(const nlohmann::json& shape, const char* low, const char* high) {
  const std::vector<double> a = numbers_of(shape, low);
  const std::vector<double> b = numbers_of(shape, high);
  const bool upright =
      a.size() == 3 && b.size() == 3 && a[0] == 0 && a[1] == 0 && b[0] == 0 && b[1] == 0 && a[2] == -b[2] && b[2] >= 0;
  return upright ? joined({number_of(shape, "radius_m"), 2 * b[2]}) : std::string();
}

/// Full lengths of a box or an ellipsoid, if it is centred at the origin along the axes; else nothing.
std::string straight_words(const nlohmann::json& shape) {
  std::vector<double> size = numbers_of(shape, "half_m");
  const std::vector<double> turn = numbers_of(shape, "rotation");
  const bool straight = turn.empty() || (turn.size() == 4 && turn[0] == 1);
  if (size.size() != 3 || !straight || !all_zero(numbers_of(shape, "center"))) return {};
  for (double& length : size) length *= 2;
  return joined(size);
}

/// The words of `add` for a shape, such as "box 0.4 0.4 0.4"; empty if `add` cannot make it. It can if the shape needs
/// no file and is centred at its own origin.
std::string shape_words(const nlohmann::json& shape) {
  if (!shape.is_array() || shape.size() != 1 || !shape[0].is_object() || shape[0].empty()) return {};
  const std::string kind = shape[0].begin().key();
  const nlohmann::json& part = shape[0].begin().value();
  std::string numbers;
  if (kind == "sphere" && all_zero(numbers_of(part, "center"))) numbers = format_number(number_of(part, "radius_m"));
  if (kind == "box" || kind == "ellipsoid") numbers = straight_words(part);
  if (kind == "capsule" || kind == "cylinder") numbers = upright_words(part, "a", "b");
  if (kind == "cone") numbers = upright_words(part, "base", "apex");
  if (kind == "half_space" && all_zero(numbers_of(part, "point"))) numbers = joined(numbers_of(part, "normal"));
  if (numbers.empty()) return {};
  return (kind == "half_space" ? "plane" : kind) + " " + numbers;
}

std::string add_line(const nlohmann::json& object) {
  const std::string shape = shape_words(object.value("shape", nlohmann::json()));
  const std::vector<double> pose = numbers_of(object, "pose");
  if (shape.empty() || pose.size() != 7) return {};
  std::string line = fmt::format("collide add {} {} --at {}", shell_word(text_of(object, "name")), shape,
                                 joined({pose[0], pose[1], pose[2]}));
  if (pose[3] != 1) line += " --quat " + joined({pose[3], pose[4], pose[5], pose[6]});
  if (count_of(object, "layers") != 1) line += fmt::format(" --layers {:#x}", count_of(object, "layers"));
  if (count_of(object, "mask") != 0xffffffff) line += fmt::format(" --mask {:#x}", count_of(object, "mask"));
  if (count_of(object, "group") != 0) line += fmt::format(" --group {}", count_of(object, "group"));
  const bool is_plane = shape.starts_with("plane");  // it never moves
  if (!flag_of(object, "moving") && !is_plane) line += " --static";
  return line;
}

/// The path as one would type it here: relative if the file lies below this folder.
std::string typed_path(const std::string& path) {
  std::error_code error;
  const std::filesystem::path here = std::filesystem::current_path(error);
  const std::string nearer = error ? path : std::filesystem::path(path).lexically_relative(here).string();
  return nearer.empty() || nearer.starts_with("..") ? path : nearer;
}

/// arguments  those of the command load
std::string load_line(const std::string& scene, const nlohmann::json& arguments) {
  const auto load = answer_in<LoadOptions>(arguments);
  std::string line = "collide load " + shell_word(typed_path(text_of(arguments, "path")));
  if (!load.name.empty()) line += " --name " + shell_word(scene);
  for (const auto& [option, metres, usual] :
       {std::tuple("--unit", load.unit_m, 1.0), {"--radius", load.radius_m, 0.0}, {"--crack", load.crack_m, 0.0}}) {
    if (metres != usual) line += fmt::format(" {} {}", option, format_number(metres));
  }
  if (!load.up.empty()) line += " --up " + load.up;
  if (!load.srdf.empty()) line += " --srdf " + shell_word(load.srdf);
  for (const std::string& package : load.packages) line += " --package " + shell_word(package);
  if (!load.solid.empty() && load.solid != "*") line += " --solid-only " + shell_word(load.solid);
  if (load.solid == "*" && !load.solid_by_winding) line += " --solid";
  if (load.solid_by_winding) line += " --solid=winding";
  for (const auto& [flag, is_set] :
       {std::pair(" --strict", load.strict), {" --mend", load.mend}, {" --moving", load.moving}}) {
    if (is_set) line += flag;
  }
  for (const CoveredBox& box : load.covers) {
    const auto corner = [](const Vec3& at) {
      return fmt::format("{},{},{}", format_number(at.x()), format_number(at.y()), format_number(at.z()));
    };
    line += " --covers=" + corner(box.low) + ":" + corner(box.high);
  }
  return line;
}

/// Adds the lines that load scenes again, and counts scenes without one.
void add_load_lines(Session& session, const Globals& globals, const std::function<bool(const std::string&)>& is_wanted,
                    std::string_view options, Undo& undo) {
  const nlohmann::json answer = server_command(session, globals, wire::kPlan, nlohmann::json::object());
  for (const nlohmann::json& one : answer.value("scenes", nlohmann::json::array())) {
    const std::string name = text_of(one, "scene");
    if (!is_wanted(name)) continue;
    const nlohmann::json load = one.value("load", nlohmann::json());
    if (load.is_object()) undo.lines.push_back(load_line(name, load).append(options));
    else ++undo.left_out;
  }
}

}  // namespace

Undo undo_of(Session& session, const Globals& globals, const Removal& removal) {
  constexpr std::uint64_t kMostListed = 100'000;
  constexpr std::size_t kMostAdded = 100;  // more lines than people would paste, and a question to the server for each
  Undo undo;
  if (globals.quiet) return undo;
  nlohmann::json arguments{{"name", removal.names}, {"limit", kMostListed}};
  if (removal.moving_only) arguments["moving"] = true;
  const auto [objects, count, version] = server_answer<ObjectList>(session, globals, wire::kList, arguments);
  undo.left_out = std::max<std::uint64_t>(count, objects.size()) - objects.size();
  std::set<std::string> scenes;
  for (const ListedObject& object : objects) {
    if (!object.publisher.empty()) continue;
    if (!object.scene.empty()) {
      const bool goes = removal.scenes_too && (removal.scene.empty() || removal.scene == object.scene);
      if (!goes) scenes.insert(object.scene);
      continue;
    }
    const bool shown = undo.lines.size() < kMostAdded;
    const std::string line =
        shown ? add_line(server_command(session, globals, wire::kGet, {{"name", object.name}})) : std::string();
    if (line.empty()) ++undo.left_out;
    else undo.lines.push_back(line);
  }
  if (!scenes.empty())
    add_load_lines(
        session, globals, [&](const std::string& scene) { return scenes.contains(scene); }, " --replace", undo);
  return undo;
}

Undo undo_of_scenes(Session& session, const Globals& globals, const std::string& scene) {
  Undo undo;
  if (globals.quiet) return undo;
  add_load_lines(
      session, globals, [&](const std::string& name) { return scene.empty() || name == scene; }, "", undo);
  return undo;
}

void print_undo(Session& session, const Globals& globals, const Undo& undo) {
  for (const std::string& line : undo.lines) print_hint(session.io, globals, "     undo: " + line);
  if (undo.left_out > 0)
    print_hint(session.io, globals,
               fmt::format("     {} more that no line here brings back", format_count(undo.left_out)));
}

std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '/' || c == '.' || c == ':';
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace collided::cli
