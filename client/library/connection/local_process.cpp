#include "client/library/connection/local_process.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

namespace collided::client {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

}  // namespace

bool runs_here(std::uint32_t pid, const char* program) {
  if (pid == 0) return false;
  const File file(std::fopen(("/proc/" + std::to_string(pid) + "/stat").c_str(), "re"));
  if (!file) return false;
  char text[256];
  const std::string stat(text, std::fread(text, 1, sizeof text, file.get()));
  // "4711 (collided) S ...": the name may contain brackets, so its end is the last one.
  const std::size_t open = stat.find('('), close = stat.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close + 2 >= stat.size()) return false;
  const char state = stat[close + 2];
  return stat.substr(open + 1, close - open - 1) == program && (state == 'R' || state == 'S' || state == 'D');
}

bool is_machine_crowded() {
  constexpr unsigned kOfEach = 3;
  const File file(std::fopen("/proc/loadavg", "re"));
  unsigned runnable = 0;
  // "0.20 0.18 0.12 3/412 11206": 3 of 412 threads are runnable.
  return file && std::fscanf(file.get(), "%*s %*s %*s %u/", &runnable) == 1 &&
         runnable >= kOfEach * std::max(1U, std::thread::hardware_concurrency());
}

}  // namespace collided::client
