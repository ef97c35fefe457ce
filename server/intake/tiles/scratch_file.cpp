#include "server/intake/tiles/scratch_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "server/intake/scene.hpp"

namespace collided::engine {

ScratchFile::ScratchFile(const std::string& beside) : beside_(beside) {
  const std::filesystem::path parent = std::filesystem::path(beside).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  number_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (number_ < 0) {
    // Some file systems do not support unnamed files.
    std::string pattern = folder + "/.collided-scratch-XXXXXX";
    number_ = ::mkostemp(pattern.data(), O_CLOEXEC);
    if (number_ < 0) fail("made");
    ::unlink(pattern.c_str());
  }
}

ScratchFile::~ScratchFile() {
  if (number_ >= 0) ::close(number_);
}

void ScratchFile::fail(const char* what) const {
  throw LoadError(fmt::format("{}: a scratch file beside it cannot be {}: {}. Nothing was written.", beside_, what,
                              std::strerror(errno)));
}

void ScratchFile::write(std::uint64_t first_byte, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(number_, bytes.data(), bytes.size(), static_cast<off_t>(first_byte));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("written");
    first_byte += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void ScratchFile::read(std::uint64_t first_byte, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got = ::pread(number_, bytes.data(), bytes.size(), static_cast<off_t>(first_byte));
    if (got < 0 && errno == EINTR) continue;
    if (got == 0) errno = EIO;
    if (got <= 0) fail("read");
    first_byte += static_cast<std::uint64_t>(got);
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
}

}  // namespace collided::engine
