#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <string_view>

#include "server/intake/scene_file/scene_file.hpp"
#include "server/programs/import/assimp_scene.hpp"
#include "server/programs/import/sandbox.hpp"

// collided-import INPUT OUTPUT [--name NAME] [--max-triangles N] [--unit-m METRES] [--up y|z] [--radius-m R] [--mend-m
// WIDTH]
//                 [--strict]
//
// Turns a file that nobody vouches for into a .cscene file: one in a format that is read here, or in any other that
// Assimp reads. This is a process of its own that may do nothing else (sandbox.hpp), so whatever such a file does to
// it, the server lives on.

namespace {

struct ImportArguments {
  std::string input;
  std::string output;
  collided::engine::LoadOptions options;
};

template <class Number>
bool parse(std::string_view text, Number& number) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && stop == text.data() + text.size();
}

bool parse_option(std::string_view option, std::string_view value, collided::engine::LoadOptions& options) {
  if (option == "--name") {
    options.name = value;
    return true;
  }
  if (option == "--max-triangles") return parse(value, options.max_triangles);
  if (option == "--unit-m") return parse(value, options.unit_m);
  if (option == "--radius-m") return parse(value, options.radius_m);
  if (option == "--mend-m") return parse(value, options.mend_m.emplace());
  options.up = value.empty() ? '\0' : value[0];
  return option == "--up" && (value == "y" || value == "z");
}

bool parse(int argument_count, char** arguments, ImportArguments& parsed) {
  if (argument_count < 3) return false;
  parsed.input = arguments[1];
  parsed.output = arguments[2];
  for (int i = 3; i < argument_count; ++i) {
    const std::string_view option = arguments[i];
    if (option == "--strict") {
      parsed.options.strict = true;
    } else if (++i == argument_count || !parse_option(option, arguments[i], parsed.options)) {
      return false;
    }
  }
  return true;
}

void print(const char* head, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) { std::printf("%s: %s\n", head, line.c_str()); }
}

collided::engine::Scene read(const ImportArguments& arguments, collided::engine::LoadReport& report) {
  if (collided::engine::is_read_here(arguments.input))
    return collided::engine::load_scene(arguments.input, arguments.options, report);
  return collided::engine::read_with_assimp(arguments.input, arguments.options, report);
}

int convert(const ImportArguments& arguments, int output) {
  try {
    collided::engine::LoadReport report;
    collided::engine::save_scene(output, "scene.cscene", read(arguments, report));
    print("placed", report.placed);
    print("note", report.notes);
    print("mended", report.mended);
    print("refused", report.refused);
    print("warning", report.warnings);
    return std::fflush(stdout) == 0 ? 0 : 1;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "it needs more than %llu MiB of memory\n", collided::engine::sandbox_memory_bytes() >> 20);
  } catch (const std::exception& error) { std::fprintf(stderr, "%s\n", error.what()); }
  return 1;
}

}  // namespace

int main(int argument_count, char** argument_list) {
  ImportArguments arguments;
  if (!parse(argument_count, argument_list, arguments)) {
    std::fputs(
        "collided-import INPUT OUTPUT [--name NAME] [--max-triangles N] [--unit-m METRES] [--up y|z] [--radius-m R] "
        "[--mend-m WIDTH] [--strict]\n",
        stderr);
    return 2;
  }
  // Opened before the sandbox, in which no file can be opened for writing.
  const int output = ::open(arguments.output.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (output < 0) {
    std::fprintf(stderr, "%s: %s\n", arguments.output.c_str(), std::strerror(errno));
    return 1;
  }
  // A file may name others, in its own folder.
  const std::string folder = std::filesystem::absolute(arguments.input).parent_path().string();
  // Packages of robots in other folders cannot be opened from here.
  for (const char* variable : {"ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"}) ::unsetenv(variable);
  if (const std::string why = collided::engine::enter_sandbox(output, {arguments.input, folder}); !why.empty()) {
    std::fprintf(stderr, "%s\n", why.c_str());
    return 1;
  }
  return convert(arguments, output);
}
