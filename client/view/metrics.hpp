#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "client/view/figures.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// A server's metrics in the format of Prometheus (text format 0.0.4). Counts are since the server's start; durations
/// are histograms with a bucket for each doubling, without a sum, which the server does not keep.
///
/// status   nothing: the server is silent, and only `collided_up` is written
/// figures  its answer to the command `figures`, since its start
std::string metrics_text(const std::optional<ServerStatus>& status, const std::optional<Figures>& figures);

/// The newest text, for the page that serves it. Threads: any.
class Metrics {
 public:
  void set(std::string text) {
    const std::lock_guard lock(mutex_);
    text_ = std::move(text);
  }
  std::string text() const {
    const std::lock_guard lock(mutex_);
    return text_;
  }

 private:
  mutable std::mutex mutex_;
  std::string text_ = metrics_text({}, {});
};

}  // namespace collided::view
