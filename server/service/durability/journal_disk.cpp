#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "server/service/durability/journal.hpp"

namespace collided::engine::service {
namespace {

/// An open file, closed by the destructor.
class JournalFile {
 public:
  JournalFile(const std::string& path, int flags) : number_(open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
  ~JournalFile() {
    if (number_ >= 0) close(number_);
  }
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  bool is_open() const { return number_ >= 0; }
  int number() const { return number_; }
  bool write_all(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = write(number_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return false;
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return true;
  }

 private:
  int number_;
};

class PosixDisk final : public Disk {
 public:
  explicit PosixDisk(std::string folder) : folder_(std::move(folder)) {}

  std::optional<std::vector<std::byte>> read(const std::string& name) override {
    const JournalFile file(path(name), O_RDONLY);
    struct stat about {};
    if (!file.is_open() || fstat(file.number(), &about) != 0 || !S_ISREG(about.st_mode)) return std::nullopt;
    std::vector<std::byte> bytes(static_cast<std::size_t>(about.st_size));
    std::size_t got = 0;
    while (got < bytes.size()) {
      const ssize_t part = ::read(file.number(), bytes.data() + got, bytes.size() - got);
      if (part < 0 && errno == EINTR) continue;
      if (part <= 0) break;
      got += static_cast<std::size_t>(part);
    }
    bytes.resize(got);
    return bytes;
  }
  bool create(const std::string& name) override {
    return JournalFile(path(name), O_WRONLY | O_CREAT | O_TRUNC).is_open();
  }
  bool append(const std::string& name, std::span<const std::byte> bytes) override {
    const JournalFile file(path(name), O_WRONLY | O_APPEND);
    return file.is_open() && file.write_all(bytes);
  }
  bool overwrite(const std::string& name, std::uint64_t at, std::span<const std::byte> bytes) override {
    const JournalFile file(path(name), O_WRONLY);
    return file.is_open() && lseek(file.number(), static_cast<off_t>(at), SEEK_SET) >= 0 && file.write_all(bytes);
  }
  bool cut(const std::string& name, std::uint64_t bytes) override {
    return truncate(path(name).c_str(), static_cast<off_t>(bytes)) == 0;
  }
  bool sync(const std::string& name) override {
    const JournalFile file(path(name), O_WRONLY);
    return file.is_open() && fsync(file.number()) == 0;
  }
  bool rename(const std::string& from, const std::string& to) override {
    if (::rename(path(from).c_str(), path(to).c_str()) != 0) return false;
    // A rename survives a power loss only once its folder is synced.
    const JournalFile folder(folder_, O_RDONLY | O_DIRECTORY);
    return folder.is_open() && fsync(folder.number()) == 0;
  }
  bool remove(const std::string& name) override { return unlink(path(name).c_str()) == 0 || errno == ENOENT; }
  bool link(const std::string& name, const std::string& second) override {
    return remove(second) && ::link(path(name).c_str(), path(second).c_str()) == 0;
  }
  bool reserve(const std::string& name, std::uint64_t bytes) override {
    const JournalFile file(path(name), O_WRONLY);
    struct stat about {};
    return file.is_open() && fstat(file.number(), &about) == 0 &&
           // If the file system does not support this, the write will report it.
           (fallocate(file.number(), FALLOC_FL_KEEP_SIZE, about.st_size, static_cast<off_t>(bytes)) == 0 ||
            errno == EOPNOTSUPP);
  }

 private:
  std::string path(const std::string& name) const { return (std::filesystem::path(folder_) / name).string(); }

  std::string folder_;
};

}  // namespace

std::unique_ptr<Disk> disk_in(const std::string& folder) { return std::make_unique<PosixDisk>(folder); }

}  // namespace collided::engine::service
