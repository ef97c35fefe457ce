#include "client/library/connection/local_process.hpp"

#include <cstdio>
#include <memory>
#include <string>

namespace collided::client {

bool runs_here(std::uint32_t pid, const char* program) {
  if (pid == 0) return false;
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen(("/proc/" + std::to_string(pid) + "/stat").c_str(), "re"));
  if (!file) return false;
  char text[256];
  const std::string stat(text, std::fread(text, 1, sizeof text, file.get()));
  // "4711 (collided) S ...": the name may hold anything, so its end is the last bracket.
  const std::size_t open = stat.find('('), close = stat.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close + 2 >= stat.size()) return false;
  const char state = stat[close + 2];
  return stat.substr(open + 1, close - open - 1) == program && (state == 'R' || state == 'S' || state == 'D');
}

}  // namespace collided::client
