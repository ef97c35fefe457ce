#include "server/intake/file_bytes.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace collided::engine {
namespace {

std::size_t page_bytes() { return static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)); }

}  // namespace

void refuse_file(const std::string& name, const std::string& what) {
  throw LoadError(fmt::format("{}: {}. Nothing was loaded.", name, what));
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

FileBytes::FileBytes(const std::string& path, Access access, const LoadOptions& options) : name_(file_name(path)) {
  // Non-blocking: opening a pipe without a writer would wait for ever.
  file_.number = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat state {};
  if (file_.number < 0 || ::fstat(file_.number, &state) != 0) {
    refuse_file(path, fmt::format("cannot be opened: {}", std::strerror(errno)));
  }
  if (!S_ISREG(state.st_mode)) {
    refuse_file(path, S_ISDIR(state.st_mode) ? "is a directory, a file is needed" : "is not a regular file");
  }
  byte_count_ = static_cast<std::size_t>(state.st_size);
  if (byte_count_ > options.max_file_bytes && access != Access::mapped_as_read) {
    refuse_file(name_, fmt::format("{} bytes, limit {}", byte_count_, options.max_file_bytes));
  }
  if (byte_count_ == 0) { refuse_file(name_, "the file is empty"); }
  if (access == Access::mapped || access == Access::mapped_as_read) {
    map(access == Access::mapped);
    return;
  }
  reserve();
  // The first page is always needed, to detect the format.
  if (access == Access::copied_as_asked) fetch_before(1);
  else copy_all(options);
}

void FileBytes::map(bool at_once) {
  may_drop_pages_ = !at_once;
  map_ = ::mmap(nullptr, byte_count_, PROT_READ, MAP_PRIVATE | (at_once ? MAP_POPULATE : 0), file_.number, 0);
  if (map_ == MAP_FAILED) {
    map_ = nullptr;
    refuse_file(name_, fmt::format("cannot be mapped: {}", std::strerror(errno)));
  }
  data_ = static_cast<const char*>(map_);
  file_.close();
}

/// Reserves addresses for the whole file. They must not be read until fetch_before() has copied the file's bytes to
/// them.
void FileBytes::reserve() {
  void* const memory = ::mmap(nullptr, byte_count_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) {
    refuse_file(name_, fmt::format("no memory for its {} bytes: {}", byte_count_, std::strerror(errno)));
  }
  copy_ = {static_cast<char*>(memory), Unmap{byte_count_}};
  data_ = copy_.get();
}

void FileBytes::copy_all(const LoadOptions& options) {
  constexpr std::size_t kPieceBytes = std::size_t{32} << 20;
  ::madvise(copy_.get(), byte_count_, MADV_HUGEPAGE);
  while (fetched_bytes_ < byte_count_) {
    if (options.cancelled && options.cancelled()) refuse_file(name_, "cancelled while reading");
    fetch_before(fetched_bytes_ + kPieceBytes);
  }
}

/// Copies whole pages, so that no page is copied in two pieces.
void FileBytes::fetch_before(std::size_t byte) {
  const std::size_t end = std::min((byte + page_bytes() - 1) / page_bytes() * page_bytes(), byte_count_);
  if (!copy_ || end <= fetched_bytes_) return;
  if (::mprotect(copy_.get() + fetched_bytes_, end - fetched_bytes_, PROT_READ | PROT_WRITE) != 0) {
    refuse_file(name_, fmt::format("no memory for its {} bytes: {}", byte_count_, std::strerror(errno)));
  }
  for (std::size_t done = fetched_bytes_; done < end;) {
    const ssize_t got = ::read(file_.number, copy_.get() + done, end - done);
    if (got < 0 && errno == EINTR) { continue; }
    if (got <= 0) {
      refuse_file(name_, got < 0 ? fmt::format("cannot be read: {}", std::strerror(errno))
                                 : fmt::format("ended at byte {} of {} while it was read", done, byte_count_));
    }
    done += static_cast<std::size_t>(got);
  }
  fetched_bytes_ = end;
  if (fetched_bytes_ == byte_count_) file_.close();
}

void FileBytes::OpenFile::close() {
  if (number >= 0) ::close(number);
  number = -1;
}

void FileBytes::Unmap::operator()(char* memory) const { ::munmap(memory, byte_count); }

void FileBytes::give_back(std::span<const char> piece) const {
  if (!copy_ && !may_drop_pages_) return;
  char* const memory = copy_ ? copy_.get() : static_cast<char*>(map_);
  const std::size_t page = page_bytes();
  const auto first =
      static_cast<std::size_t>(piece.data() - memory + static_cast<std::ptrdiff_t>(page) - 1) / page * page;
  const std::size_t end = static_cast<std::size_t>(piece.data() + piece.size() - memory) / page * page;
  if (first < end) ::madvise(memory + first, end - first, MADV_DONTNEED);
}

void FileBytes::forget_before(std::size_t byte) {
  const std::size_t forgotten = byte / page_bytes() * page_bytes();
  if (map_ == nullptr || forgotten <= forgotten_bytes_) { return; }
  ::munmap(static_cast<char*>(map_) + forgotten_bytes_, forgotten - forgotten_bytes_);
  forgotten_bytes_ = forgotten;
}

FileBytes::~FileBytes() {
  if (map_ != nullptr && forgotten_bytes_ < byte_count_) {
    ::munmap(static_cast<char*>(map_) + forgotten_bytes_, byte_count_ - forgotten_bytes_);
  }
}

}  // namespace collided::engine
