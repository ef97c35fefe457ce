#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <string_view>

#include "server/intake/import/assimp_scene.hpp"
#include "server/intake/scene_file.hpp"

// collided-import INPUT OUTPUT [--name NAME] [--max-triangles N] [--unit-m METRES] [--strict]
//
// Turns a file in any format that Assimp reads into a .cscene file. A process of its own, because Assimp is large,
// works in single precision and has been broken by crafted files: whatever happens to it here, the server lives on.

namespace {

constexpr rlim_t kMemoryBytes = rlim_t{8} << 30;
constexpr rlim_t kProcessorSeconds = 600;
constexpr rlim_t kOutputBytes = rlim_t{2} << 30;

void limit(int resource, rlim_t amount) {
  const rlimit both{amount, amount};
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

void limit_ourselves() {
#ifndef __SANITIZE_ADDRESS__  // which maps terabytes that it never touches
  limit(RLIMIT_AS, kMemoryBytes);
#endif
  limit(RLIMIT_CPU, kProcessorSeconds);
  limit(RLIMIT_FSIZE, kOutputBytes);
  limit(RLIMIT_CORE, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
}

struct Arguments {
  std::string input;
  std::string output;
  collided::LoadOptions options;
};

template <class Number>
bool parse(std::string_view text, Number& number) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && stop == text.data() + text.size();
}

bool parse(int argument_count, char** arguments, Arguments& parsed) {
  if (argument_count < 3) {
    return false;
  }
  parsed.input = arguments[1];
  parsed.output = arguments[2];
  for (int i = 3; i < argument_count; ++i) {
    const std::string_view option = arguments[i];
    const std::string_view value = i + 1 < argument_count ? arguments[i + 1] : "";
    if (option == "--strict") {
      parsed.options.strict = true;
      continue;
    }
    ++i;
    if (option == "--name") {
      parsed.options.name = value;
    } else if (option == "--max-triangles" ? !parse(value, parsed.options.max_triangles)
                                           : option != "--unit-m" || !parse(value, parsed.options.unit_m)) {
      return false;
    }
  }
  return true;
}

void print(const char* head, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    std::printf("%s: %s\n", head, line.c_str());
  }
}

}  // namespace

int main(int argument_count, char** arguments) {
  limit_ourselves();
  Arguments parsed;
  if (!parse(argument_count, arguments, parsed)) {
    std::fputs("collided-import INPUT OUTPUT [--name NAME] [--max-triangles N] [--unit-m METRES] [--strict]\n", stderr);
    return 2;
  }
  try {
    collided::LoadReport report;
    collided::save_scene(parsed.output, collided::read_with_assimp(parsed.input, parsed.options, report));
    print("mended", report.mended);
    print("refused", report.refused);
    print("warning", report.warnings);
    return 0;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "it needs more than %llu GiB of memory\n",
                 static_cast<unsigned long long>(kMemoryBytes >> 30));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return 1;
}
