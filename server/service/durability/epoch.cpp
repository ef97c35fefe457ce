#include "server/service/durability/epoch.hpp"
#include "idl/clocks.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

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

/// Replaces the file so that a crash leaves the old or the new text. Returns what went wrong, or nothing.
std::string replace_file(const fs::path& path, const std::string& text) {
  std::error_code error;
  const fs::path fresh = path.string() + ".new";
  std::ofstream out(fresh, std::ios::trunc);
  out << text;
  out.close();
  if (!out || !sync_to_disk(fresh, O_RDONLY)) {
    const std::string why = fmt::format("{} cannot be written: {}", fresh.string(), std::strerror(errno));
    fs::remove(fresh, error);
    return why;
  }
  fs::rename(fresh, path, error);
  if (error) return fmt::format("{} cannot be replaced: {}", path.string(), error.message());
  // A rename survives a power loss only once its folder is synced.
  sync_to_disk(path.parent_path(), O_RDONLY | O_DIRECTORY);
  return {};
}

std::string copy_of(const std::string& path) { return path + ".copy"; }

std::uint32_t checksum(std::string_view text) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size()));
}

/// Writes both files; a crash between the two leaves one of them unchanged.
std::string write_epoch(const std::string& path, std::uint64_t value, std::string_view how) {
  const std::string said = fmt::format("{} {}", value, how);
  const std::string line = fmt::format("{} {:08x}\n", said, checksum(said));
  const std::string problem = replace_file(path, line);
  return problem.empty() ? replace_file(copy_of(path), line) : problem;
}

/// The content of one of the two files.
struct Read {
  bool is_there = false;
  bool is_whole = false;
  std::uint64_t value = 0;
  PastEnd past = PastEnd::unknown;
};

/// has_copy: false accepts a text without a checksum, as before there were copies.
Read read_epoch(const std::string& path, bool has_copy) {
  Read read;
  std::ifstream in(path, std::ios::binary);
  read.is_there = in.is_open();
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::uint64_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc()) return read;
  const std::string_view rest(end, static_cast<std::size_t>(text.data() + text.size() - end));
  for (const auto& [how, past] : {std::pair(kRunning, PastEnd::running), std::pair(kStopped, PastEnd::stopped)}) {
    const std::string said = fmt::format("{} {}", value, how);
    const bool is_sealed = text == fmt::format("{} {:08x}\n", said, checksum(said));
    if (!is_sealed && (has_copy || rest != fmt::format(" {}\n", how))) continue;
    return {.is_there = true, .is_whole = true, .value = value, .past = past};
  }
  if (!has_copy && rest == "\n") read.value = value;
  return read;
}

/// Combines the two files: the greater value counts, and of two equal ones the one that still runs.
void read_both(Epoch& epoch) {
  std::error_code ignored;
  const bool has_copy = fs::exists(copy_of(epoch.kept_in), ignored);
  const Read first = read_epoch(epoch.kept_in, has_copy);
  const Read second = read_epoch(copy_of(epoch.kept_in), true);
  const bool is_second = second.is_whole && (!first.is_whole || second.value > first.value ||
                                             (second.value == first.value && second.past == PastEnd::running));
  const Read& newest = is_second ? second : first;
  if (newest.value > 0) epoch.value = std::max(epoch.value, newest.value + 1);
  if (newest.is_whole) epoch.past = newest.past;
  for (const auto& [read, path] : {std::pair(&first, epoch.kept_in), std::pair(&second, copy_of(epoch.kept_in))}) {
    if (read->is_there && !read->is_whole && read->value == 0)
      epoch.damage = fmt::format("{} is damaged{}", path, newest.is_whole ? "; its copy says the same" : "");
  }
}

/// Takes the lock and returns 0, or returns the process that holds it (-1: not known). The open file is the lock.
int take_lock(const fs::path& path, std::shared_ptr<void>& lock) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file < 0) return 0;  // if nothing can be written, replace_file() reports it
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

void open_epoch(Epoch& epoch) {
  if (!epoch.kept_in.empty()) epoch.problem = write_epoch(epoch.kept_in, epoch.value, kRunning);
}

std::string raise_epoch(Epoch& epoch, std::uint64_t value) {
  const std::string problem = epoch.kept_in.empty() ? "" : write_epoch(epoch.kept_in, value, kRunning);
  if (problem.empty()) epoch.value = value;
  return problem;
}

void close_epoch(const Epoch& epoch) {
  if (!epoch.kept_in.empty()) static_cast<void>(write_epoch(epoch.kept_in, epoch.value, kStopped));
}

std::uint64_t least_epoch_now() {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::seconds>(wire_contract::since_1970()).count());
}

Epoch next_epoch(const std::string& state_dir, int domain, const std::string& name_space,
                 const std::function<const char*(const char*)>& environment) {
  Epoch epoch;
  epoch.value = least_epoch_now();
  const fs::path dir = state_dir.empty() ? default_dir(environment) : fs::path(state_dir);
  if (dir.empty()) {
    epoch.problem = "no home folder is known";
    return epoch;
  }
  std::error_code error;
  fs::create_directories(dir, error);
  if (std::error_code ignored; !fs::is_directory(dir, ignored)) {
    epoch.problem = fmt::format("{} cannot be made: {}", dir.string(), error.message());
    return epoch;
  }
  const fs::path path = dir / file_name(domain, name_space);
  epoch.rival_pid = take_lock(path.string() + ".lock", epoch.lock);
  if (epoch.rival_pid != 0) return epoch;
  epoch.kept_in = path.string();
  read_both(epoch);
  return epoch;
}

}  // namespace collided::engine::service
