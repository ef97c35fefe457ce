#pragma once

#include <spdlog/fwd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "idl/dds.hpp"

namespace collided::engine::service {

/// Writes DDS's warnings into the server's log, as long as it exists; at most one may exist. Any program that reaches
/// the server's ports can make DDS warn, so messages are cut to 400 bytes and thinned out: of each kind, that is, of
/// each place in DDS's sources, the first eight are logged, then the sixteenth and so on. A kind begins again after a
/// minute without a message. Samples that DDS cannot read, because their writer has types of another layout, get a
/// sentence of their own: the first one, the second, the fourth and so on.
///
/// threads  DDS calls it from its own
class DdsWarnings {
 public:
  explicit DdsWarnings(std::shared_ptr<spdlog::logger> log);
  ~DdsWarnings();
  DdsWarnings(const DdsWarnings&) = delete;
  DdsWarnings& operator=(const DdsWarnings&) = delete;

  void take(const dds_log_data_t& data);

 private:
  struct Kind {
    std::uint64_t count = 0;
    std::chrono::steady_clock::time_point last;
  };
  /// Number of messages of this kind so far, including this one.
  std::uint64_t count(const dds_log_data_t& data);

  std::shared_ptr<spdlog::logger> log_;
  std::atomic<std::uint64_t> unreadable_ = 0;
  std::mutex mutex_;
  std::map<std::pair<std::string, std::uint32_t>, Kind>
      kinds_;  // by file and line: one for each place in DDS that warns
};

}  // namespace collided::engine::service
