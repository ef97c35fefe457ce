#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "client/view/page_feed.hpp"

namespace collided::view {

/// Writes the messages of a live page, with their times, in the format that the page plays: JSON {begin, end, notes
/// [texts], messages [{t, kind, data}], surfaces}. Data are text, or bytes compressed by zlib, in base64.
///
/// threads  any
class RunWriter {
 public:
  using Now = std::function<double()>;  // seconds since the run's beginning; any thread

  /// most_bytes  compressed; later messages are left out
  RunWriter(std::size_t most_bytes, Now now);

  Observer& observer() { return feed_; }
  /// Adds a message that does not come from an Observer.
  void add(std::string message) { keep("text", std::move(message)); }
  bool is_full() const;
  std::size_t frame_count() const;
  std::string finish(double seconds, const std::vector<std::string>& notes) const;

 private:
  struct SavedMessage {
    double at_s = 0;
    const char* kind = "text";
    std::string data;
  };

  void hear(const WebMessage& message);
  void keep(const char* kind, std::string data);
  void keep_table(const ShownObjects& shown);

  PageFeed feed_;
  const std::size_t most_bytes_;
  const Now now_;
  mutable std::mutex mutex_;
  std::size_t bytes_ = 0;
  std::vector<SavedMessage> messages_;
  std::map<std::string, std::string> surfaces_;  // by epoch and number
};

}  // namespace collided::view
