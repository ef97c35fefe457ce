#include "idl/mcap/output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace collided::mcap {

FileOutput::FileOutput(const std::string& path)
    : path_(path), file_(::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644)) {
  if (file_ < 0) throw std::runtime_error(path + ": " + std::strerror(errno));
}

FileOutput::~FileOutput() { ::close(file_); }

bool FileOutput::append(std::span<const std::byte> bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = ::write(file_, bytes.data() + written, bytes.size() - written);
    if (count > 0) {
      written += static_cast<std::size_t>(count);
    } else if (count == 0 || errno != EINTR) {
      problem_ = path_ + ": " + (count == 0 ? "takes no more" : std::strerror(errno));
      // Devices and pipes cannot be truncated: an incomplete piece stays there, and readers stop before it.
      if (::ftruncate(file_, static_cast<off_t>(size_)) == 0) ::lseek(file_, static_cast<off_t>(size_), SEEK_SET);
      return false;
    }
  }
  size_ += bytes.size();
  return true;
}

}  // namespace collided::mcap
