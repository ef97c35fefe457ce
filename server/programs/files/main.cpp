#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <sstream>

#include "server/programs/files/check.hpp"
#include "server/programs/files/convert.hpp"
#include "server/programs/files/implicit.hpp"
#include "server/programs/files/interrupt.hpp"
#include "server/programs/files/points.hpp"
#include "server/programs/files/triangles.hpp"

// collided-files check FILE [--json] ... | convert IN OUT ... | implicit POLYNOMIAL NUMBERS ... | triangles FILE |
// points FILE
//
// The program behind `collide check`, `collide convert`, `collide implicit`, the shapes mesh FILE and hull FILE, and
// scans that become voxels: the readers and the exact tests belong to the server, and the client does not contain the
// server's code.

namespace {

constexpr int kInterrupted = 130;

/// The parser's help with descriptions that fit a terminal.
class NarrowHelp : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override {
    const std::size_t width = kColumns - get_column_width();
    std::string text;
    std::size_t used = 0;
    std::istringstream words(option->get_description());
    for (std::string word; words >> word; used += word.size()) {
      const bool fits = used + 1 + word.size() <= width;
      if (used > 0) text += fits ? ' ' : '\n';
      used = used > 0 && fits ? used + 1 : 0;
      text += word;
    }
    return text;
  }

 private:
  static constexpr std::size_t kColumns = 78;
};

void declare_reading(CLI::App& verb, collided::engine::files::FileOptions& file) {
  verb.add_option("file", file.path, "File to read")->required();
  verb.add_option("--unit", file.unit, "Of the file: m, mm, cm, km, um, in, ft, or metres a unit (m)");
  verb.add_option("--up", file.up, "Axis of the file that points up: y or z (as the format says, else z)")
      ->check(CLI::IsMember({"y", "z"}));
  verb.add_option("--name", file.name, "Name of the scene (the file's stem)");
  verb.add_flag("--strict", file.strict, "Refuse what would be mended");
  verb.add_flag("--mend", file.mend, "Cut edges at T-vertices and close cracks");
  verb.add_option("--crack", file.crack, "Widest crack, as 0.1mm (a ten-thousandth of the diagonal)");
  verb.add_option("--radius", file.radius, "Of the balls about the points of an .xyz or .pcd file (0)");
  verb.add_option("--srdf", file.srdf, "Of a .urdf robot: the file that says which links may touch");
  verb.add_option("--package", file.packages, "Of a .urdf robot: NAME=DIR, where a package that it names lies")
      ->allow_extra_args(false);
}

/// The command line's words in reverse order, as the parser needs them. In `implicit` a polynomial or a number may
/// begin with a minus sign; a blank in front keeps the parser from taking it for an option.
std::vector<std::string> words_of(int argument_count, char** arguments) {
  std::vector<std::string> words;
  const bool shields = argument_count > 1 && std::string_view(arguments[1]) == "implicit";
  for (int i = argument_count - 1; i > 0; --i) {
    const std::string word = arguments[i];
    const bool is_value = word.starts_with("-") && !word.starts_with("--") && word != "-h" && word != "-";
    words.push_back(shields && is_value ? " " + word : word);
  }
  return words;
}

std::string without_blanks(std::string word) {
  word.erase(0, word.find_first_not_of(' '));
  return word;
}

/// The verb's option with the longest common beginning, such as "--unit" for "--uni"; empty if there is none.
std::string nearest_option(const CLI::App& verb, std::string_view word) {
  constexpr std::size_t kLeastShared = 3;  // the dashes and a letter
  std::string nearest;
  std::size_t most = kLeastShared - 1;
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      const std::string full = "--" + name;
      const auto same = std::mismatch(word.begin(), word.end(), full.begin(), full.end()).first - word.begin();
      if (static_cast<std::size_t>(same) <= most) continue;
      most = static_cast<std::size_t>(same);
      nearest = full;
    }
  }
  return nearest;
}

/// The error in words that the parser rejected, and how the verb is written.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  if (verbs.empty()) return error.what();
  const CLI::App& verb = *verbs.front();
  std::string what = error.what();
  if (const std::vector<std::string> left = verb.remaining(); !left.empty()) {
    const auto unknown = std::find_if(left.begin(), left.end(), [](const std::string& word) { return word[0] == '-'; });
    what = fmt::format("'{}' has no meaning here", left.front());
    if (unknown != left.end()) {
      const std::string nearest = nearest_option(verb, *unknown);
      what = fmt::format("unknown option '{}'{}", *unknown,
                         nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest));
    }
  } else if (const std::size_t end = what.find(" is required"); end != std::string::npos) {
    what = fmt::format("which {}?", what.substr(0, end));
  }
  return fmt::format("{}: {}\n       collide help {}", verb.get_name(), what, verb.get_name());
}

void declare_implicit(CLI::App& verb, collided::engine::files::ImplicitOptions& options) {
  verb.add_option("surface", options.surface,
                  "Polynomial in x, y, z, 0 on the surface: 'x^2+y^2+z^2-1 in 0 -1 -1 1 1 1'; or, with --file, a name")
      ->required();
  verb.add_option("numbers", options.numbers, "A ray X Y Z DX DY DZ, a point X Y Z, or - for many, one a line")
      ->required()
      ->transform(without_blanks);
  verb.add_option("--file", options.file,
                  "A .surfaces file that has a line: NAME implicit POLYNOMIAL [in X Y Z X Y Z]");
  verb.add_option("--length", options.length, "Of rays (no end)");
  verb.add_option("--within", options.within, "Error of distances that is good enough, as 0.1mm");
  verb.add_flag("--json", options.as_json, "One JSON object an answer");
}

void declare_check(CLI::App& verb, collided::engine::files::CheckOptions& options) {
  verb.add_flag("--json", options.as_json, "One JSON object");
  verb.add_flag("-q,--quiet", options.quiet, "No hint at what more there is to see");
  verb.add_flag("-v,--verbose", options.full, "Every finding's places, with full names and digits");
  verb.add_option("--crease", options.crease_deg,
                  "Angle between two triangles above which their edge is a crease, degrees (30)")
      ->check(CLI::Range(0.0, 180.0));
  verb.add_option("--eye", options.eye, "Count the silhouette edges seen from this point X,Y,Z");
  verb.add_flag("--volumes", options.volumes, "Bounding volumes too: size, volume, time")->excludes("--json");
  verb.add_flag("--encodings", options.encodings, "Bytes as lists, fans, strips and as a mesh too")->excludes("--json");
}

void declare_convert(CLI::App& verb, collided::engine::files::ConvertOptions& options) {
  verb.add_option("output", options.output, "File to write: .cscene, with --tiles .ctiles")->required();
  verb.add_flag("--center", options.center, "The middle, in whole metres, becomes 0 0 0");
  verb.add_option("--origin", options.origin, "This point X,Y,Z becomes 0 0 0");
  verb.add_option("--index", options.index, "How the saved index is built: fast, or best for faster questions (fast)")
      ->check(CLI::IsMember({"fast", "best"}));
  verb.add_option("--to", options.to, "Simplify to so many triangles, or to so many per cent: 5000 or 10%");
  verb.add_flag("--levels", options.levels,
                "Save how to simplify it, so that distances asked --within an error are cheaper");
  verb.add_option("--cost", options.cost, "What simplification goes by: quadric or length (quadric)")
      ->check(CLI::IsMember({"quadric", "length"}));
  verb.add_flag("--no-index", options.no_index, "Save no index; loading builds it");
  verb.add_option(
      "--tiles", options.tiles,
      "Cut the mesh into cubes of this size, as 100m, or auto: by triangles. Shards open those of their boxes");
}

}  // namespace

int main(int argument_count, char** arguments) {
  CLI::App app("Scene files without a server", "collide");
  app.require_subcommand(1);
  app.formatter(std::make_shared<NarrowHelp>());
  collided::engine::files::FileOptions checked;
  collided::engine::files::CheckOptions check_options;
  CLI::App* check = app.add_subcommand("check", "What a file holds and what is wrong with it");
  declare_reading(*check, checked);
  declare_check(*check, check_options);
  collided::engine::files::ConvertOptions converted;
  CLI::App* convert = app.add_subcommand("convert", "Read a file, write a .cscene or .ctiles file");
  declare_reading(*convert, converted.file);
  declare_convert(*convert, converted);
  collided::engine::files::FileOptions printed;
  CLI::App* triangles = app.add_subcommand("triangles", "Print a file's triangles, for programs");
  declare_reading(*triangles, printed);
  CLI::App* points = app.add_subcommand("points", "Print the points of a cloud, for programs");
  declare_reading(*points, printed);
  collided::engine::files::ImplicitOptions asked;
  CLI::App* implicit =
      app.add_subcommand("implicit", "Where a ray meets a polynomial surface, on which side a point is");
  declare_implicit(*implicit, asked);
  try {
    app.parse(words_of(argument_count, arguments));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "error: %s\n", complaint(app, error).c_str());
    return 2;
  }
  collided::engine::files::listen_for_interrupt();
  try {
    if (triangles->parsed()) return collided::engine::files::triangles(printed);
    if (points->parsed()) return collided::engine::files::points(printed);
    if (implicit->parsed()) return collided::engine::files::implicit(asked);
    return check->parsed() ? collided::engine::files::check(checked, check_options)
                           : collided::engine::files::convert(converted);
  } catch (const collided::engine::files::Interrupted&) {
    std::fprintf(stderr, "interrupted\n");
    return kInterrupted;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  }
}
