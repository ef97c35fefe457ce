#include "server/intake/scene_file/write_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

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

// A rename is on the disk only once its directory is synced.
void sync_directory_of(const std::string& path) {
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  const int directory = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory >= 0) {
    ::fsync(directory);
    ::close(directory);
  }
}

}  // namespace

FileReplacement::FileReplacement(const std::string& path) : path_(path) {
  static std::atomic<unsigned> file_count = 0;
  beside_ = fmt::format("{}.{}.{}.part", path, ::getpid(), file_count.fetch_add(1));
  file_ = ::open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file_ < 0) failure_ = fmt::format("cannot be created: {}", std::strerror(errno));
}

FileReplacement::~FileReplacement() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(beside_.c_str());
}

std::string FileReplacement::append(std::span<const std::byte> bytes) {
  if (failure_.empty() && !write_all(file_, bytes))
    failure_ = fmt::format("cannot be written: {}", std::strerror(errno));
  return failure_;
}

std::string FileReplacement::put_in_place() {
  if (!failure_.empty()) return failure_;
  if (::fsync(file_) != 0 || std::rename(beside_.c_str(), path_.c_str()) != 0)
    return failure_ = fmt::format("cannot be written: {}", std::strerror(errno));
  ::close(std::exchange(file_, -1));
  sync_directory_of(path_);
  return {};
}

std::string replace_file(const std::string& path, std::span<const std::span<const std::byte>> pieces) {
  FileReplacement file(path);
  for (const std::span<const std::byte> piece : pieces) {
    if (const std::string failure = file.append(piece); !failure.empty()) return failure;
  }
  return file.put_in_place();
}

std::string write_file(int file, std::span<const std::span<const std::byte>> pieces) {
  return write_pieces(file, pieces) ? std::string() : fmt::format("cannot be written: {}", std::strerror(errno));
}

}  // namespace collided::engine
