#include "client/cli/input/line_reader.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/io.hpp"

namespace collided::cli {
namespace {

constexpr int kInterruptCheckMs = 100;

}  // namespace

const char* LineReader::line_end() const {
  return static_cast<const char*>(std::memchr(buffer_.data() + begin_, '\n', end_ - begin_));
}

/// Reads more if something arrives within wait_ms. False if nothing does.
bool LineReader::fill(int wait_ms) {
  if (ended_) return false;
  pollfd waiter{.fd = file_, .events = POLLIN, .revents = 0};
  const int ready_count = ::poll(&waiter, 1, wait_ms);
  if (ready_count <= 0) return false;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(std::min(buffer_.size() * 2, kLongestLine + kBufferBytes));
  const ssize_t got = ::read(file_, buffer_.data() + end_, buffer_.size() - end_);
  if (got < 0 && (errno == EINTR || errno == EAGAIN)) return false;
  if (got < 0) failed_ = true;
  if (got <= 0) {
    ended_ = true;
    return false;
  }
  end_ += static_cast<std::size_t>(got);
  return true;
}

bool LineReader::ready() {
  if (ended_ || line_end() != nullptr) return true;
  // The line may not have ended yet; then reading it would wait.
  while (fill(0)) {
    if (line_end() != nullptr) return true;
    if (end_ - begin_ >= kLongestLine) return true;
  }
  return ended_;
}

bool LineReader::next(std::string& line) {
  cut_ = false;
  while (line_end() == nullptr && !ended_) {
    if (stop_requested) return false;
    if (!fill(kInterruptCheckMs) && while_waiting_) while_waiting_();
    if (end_ - begin_ > kLongestLine && line_end() == nullptr) {
      cut_ = true;
      begin_ = end_ - 1;  // one byte is kept, so that the line still counts as begun
    }
  }
  if (begin_ == end_) return false;
  const char* end = line_end();
  const std::size_t length = (end == nullptr ? buffer_.data() + end_ : end) - (buffer_.data() + begin_);
  line.assign(buffer_.data() + begin_, length);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  begin_ += length + (end == nullptr ? 0 : 1);
  ++line_number_;
  return true;
}

InputFile::InputFile(const std::string& path, int in)
    : file_(in), owned_(path != "-"), name_(path == "-" ? "stdin" : path) {
  if (!owned_ && in < 0) throw bad_use("'-' has no meaning here: the verbs are read from stdin");
  if (!owned_) return;
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) throw bad_use(fmt::format("{}: {}", path, std::strerror(errno)));
  struct stat info {};
  if (::fstat(file_, &info) == 0 && S_ISDIR(info.st_mode)) {
    ::close(file_);
    throw bad_use(fmt::format("{} is a folder", path));
  }
}

InputFile::~InputFile() {
  if (owned_) ::close(file_);
}

}  // namespace collided::cli
