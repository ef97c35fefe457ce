#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "server/intake/files/check.hpp"
#include "server/intake/files/convert.hpp"

// collided-files check FILE [--json] ... | convert IN OUT ...
//
// What `collide check` and `collide convert` run: the readers belong to the server, whose code the client does not hold.

namespace {

void declare_reading(CLI::App& verb, collided::files::FileOptions& file) {
  verb.add_option("file", file.path, "File to read")->required();
  verb.add_option("--unit", file.unit, "Of the file: m, mm, cm, km, um, in, ft, or metres a unit (m)");
  verb.add_option("--up", file.up, "Axis of the file that points up: y or z (z)")->check(CLI::IsMember({"y", "z"}));
  verb.add_option("--name", file.name, "Name of the scene (the file's stem)");
  verb.add_flag("--strict", file.strict, "Refuse what would be mended");
}

}  // namespace

int main(int argument_count, char** arguments) {
  CLI::App app("Scene files without a server", "collide");
  app.require_subcommand(1);
  collided::files::FileOptions checked;
  bool as_json = false;
  CLI::App* check = app.add_subcommand("check", "What a file holds and what is wrong with it");
  declare_reading(*check, checked);
  check->add_flag("--json", as_json, "One JSON object");
  collided::files::CheckTables tables;
  check->add_flag("--volumes", tables.volumes, "Bounding volumes too: size, volume, time")->excludes("--json");
  check->add_flag("--encodings", tables.encodings, "Bytes as lists, fans, strips and as a mesh too")->excludes("--json");
  collided::files::ConvertOptions converted;
  CLI::App* convert = app.add_subcommand("convert", "Read a file, write a .cscene file");
  declare_reading(*convert, converted.file);
  convert->add_option("output", converted.output, "File to write: .cscene")->required();
  convert->add_flag("--center", converted.center, "The middle, in whole metres, becomes 0 0 0");
  convert->add_option("--origin", converted.origin, "This point X,Y,Z becomes 0 0 0");
  convert->add_option("--index", converted.index, "How the saved index is built: fast, or best for faster questions (fast)")
      ->check(CLI::IsMember({"fast", "best"}));
  convert->add_option("--to", converted.to, "Simplify to so many triangles, or to so many per cent: 5000 or 10%");
  convert->add_flag("--levels", converted.levels, "Save how to simplify it, so that distances asked --within an error are cheaper");
  convert->add_option("--cost", converted.cost, "What simplification goes by: quadric or length (quadric)")
      ->check(CLI::IsMember({"quadric", "length"}));
  convert->add_flag("--no-index", converted.no_index, "Save no index; loading builds it");
  try {
    app.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  }
  try {
    return check->parsed() ? collided::files::check(checked, as_json, tables) : collided::files::convert(converted);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  }
}
