#include "server/intake/scene_file/write_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace collided::engine {
namespace {

bool write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) { return false; }
    bytes = bytes.subspan(written < 0 ? 0 : static_cast<std::size_t>(written));
  }
  return true;
}

bool write_pieces(int file, std::span<const std::span<const std::byte>> pieces) {
  for (const std::span<const std::byte> piece : pieces) {
    if (!write_all(file, piece)) { return false; }
  }
  return ::fsync(file) == 0;
}

// A rename is on the disk only once its directory is.
void sync_directory_of(const std::string& path) {
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  const int directory = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory >= 0) {
    ::fsync(directory);
    ::close(directory);
  }
}

}  // namespace

std::string replace_file(const std::string& path, std::span<const std::span<const std::byte>> pieces) {
  static std::atomic<unsigned> file_count = 0;
  const std::string summand = fmt::format("{}.{}.{}.part", path, ::getpid(), file_count.fetch_add(1));
  const int file = ::open(summand.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) { return fmt::format("cannot be created: {}", std::strerror(errno)); }
  const bool written = write_pieces(file, pieces);
  const int write_error = errno;
  const bool closed = ::close(file) == 0;
  if (!written || !closed || std::rename(summand.c_str(), path.c_str()) != 0) {
    const int error = written ? errno : write_error;
    ::unlink(summand.c_str());
    return fmt::format("cannot be written: {}", std::strerror(error));
  }
  sync_directory_of(path);
  return {};
}

std::string write_file(int file, std::span<const std::span<const std::byte>> pieces) {
  return write_pieces(file, pieces) ? std::string() : fmt::format("cannot be written: {}", std::strerror(errno));
}

}  // namespace collided::engine
