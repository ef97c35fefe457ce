#include "server/service/durability/epoch.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace collided::engine::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRunning = "running";
constexpr const char* kStopped = "stopped";

fs::path default_dir(const std::function<const char*(const char*)>& environment) {
  if (const char* state = environment("XDG_STATE_HOME"); state && *state == '/') return fs::path(state) / "collided";
  if (geteuid() == 0) return "/var/lib/collided";
  if (const char* home = environment("HOME"); home && *home == '/') return fs::path(home) / ".local/state/collided";
  return {};
}

std::string file_name(int domain, std::string name_space) {
  std::replace(name_space.begin(), name_space.end(), '/', '-');
  return fmt::format("{}-{}.epoch", domain, name_space);
}

bool sync_to_disk(const fs::path& path, int flags) {
  const int file = open(path.c_str(), flags | O_CLOEXEC);
  if (file < 0) return false;
  const bool done = fsync(file) == 0;
  close(file);
  return done;
}

/// Replaces the file such that a crash leaves the old or the new text. Returns what went wrong, or nothing.
std::string replace_file(const fs::path& path, const std::string& text) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  const fs::path summand = path.string() + fmt::format(".{}", getpid());
  std::ofstream out(summand, std::ios::trunc);
  out << text;
  out.close();
  if (!out || !sync_to_disk(summand, O_RDONLY))
    return fmt::format("{} cannot be written: {}", summand.string(), std::strerror(errno));
  fs::rename(summand, path, error);
  if (error) return fmt::format("{} cannot be replaced: {}", path.string(), error.message());
  // A rename survives a loss of power only once its folder is synced.
  sync_to_disk(path.parent_path(), O_RDONLY | O_DIRECTORY);
  return {};
}

/// Takes the lock and returns 0, or returns the process that holds it (-1: not known). The open file is the lock.
int take_lock(const fs::path& path, std::shared_ptr<void>& lock) {
  std::error_code ignored;
  fs::create_directories(path.parent_path(), ignored);
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file < 0) return 0;  // where nothing can be written, replace_file() reports it
  if (flock(file, LOCK_EX | LOCK_NB) != 0) {
    int holder = 0;
    std::ifstream(path) >> holder;
    close(file);
    return holder > 0 ? holder : -1;
  }
  lock = std::shared_ptr<void>(nullptr, [file](void*) { close(file); });
  const std::string pid = fmt::format("{}\n", getpid());
  static_cast<void>(ftruncate(file, 0) == 0 && pwrite(file, pid.data(), pid.size(), 0) > 0);
  return 0;
}

}  // namespace

void close_epoch(const Epoch& epoch) {
  if (!epoch.kept_in.empty())
    static_cast<void>(replace_file(epoch.kept_in, fmt::format("{} {}\n", epoch.value, kStopped)));
}

Epoch next_epoch(const std::string& state_dir, int domain, const std::string& name_space,
                 const std::function<const char*(const char*)>& environment) {
  const auto clock = std::chrono::system_clock::now().time_since_epoch();
  Epoch epoch;
  epoch.value = static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(clock).count());
  const fs::path dir = state_dir.empty() ? default_dir(environment) : fs::path(state_dir);
  if (dir.empty()) {
    epoch.problem = "no home folder is known";
    return epoch;
  }
  const fs::path path = dir / file_name(domain, name_space);
  epoch.rival_pid = take_lock(path.string() + ".lock", epoch.lock);
  if (epoch.rival_pid != 0) return epoch;
  std::uint64_t last = 0;
  std::string how;
  std::ifstream in(path);
  if (in >> last) epoch.value = std::max(epoch.value, last + 1);
  if (in >> how) epoch.crashed = how == kRunning;
  epoch.problem = replace_file(path, fmt::format("{} {}\n", epoch.value, kRunning));
  if (epoch.problem.empty()) epoch.kept_in = path.string();
  return epoch;
}

}  // namespace collided::engine::service
