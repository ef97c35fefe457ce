#include "client/view/uploaded_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace collided::view {
namespace {

[[noreturn]] void fail(const std::string& what) { throw std::system_error(errno, std::generic_category(), what); }

}  // namespace

UploadedFile::UploadedFile() {
  std::string name = (std::filesystem::temp_directory_path() / "collide-view-XXXXXX").string();
  file_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) fail("no file can be made in " + std::filesystem::temp_directory_path().string());
  ::unlink(name.c_str());
}

UploadedFile::~UploadedFile() { ::close(file_); }

void UploadedFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("it cannot be kept in " + std::filesystem::temp_directory_path().string());
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace collided::view
