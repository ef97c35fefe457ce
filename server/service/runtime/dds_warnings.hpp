#pragma once

#include <spdlog/logger.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>

namespace collided::engine::service {

/// Puts what DDS warns of into the server's log, for as long as it exists; there may be one at a time. Samples that DDS
/// cannot read, since the program that wrote them has types of another layout, are counted and said in a sentence: the first
/// one, the second, the fourth and so on.
///
/// threads  DDS calls it from its own
class DdsWarnings {
 public:
  explicit DdsWarnings(std::shared_ptr<spdlog::logger> log);
  ~DdsWarnings();
  DdsWarnings(const DdsWarnings&) = delete;
  DdsWarnings& operator=(const DdsWarnings&) = delete;

  void take(std::string_view message);

 private:
  std::shared_ptr<spdlog::logger> log_;
  std::atomic<std::uint64_t> unreadable_ = 0;
};

}  // namespace collided::engine::service
