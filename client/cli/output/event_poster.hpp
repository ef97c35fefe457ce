#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>

#include "idl/http/http_post.hpp"

namespace collided::cli {

/// The limits of an EventPoster.
struct PostLimits {
  std::size_t waiting = 10'000;  // events; when there are more, the oldest are dropped and counted
  std::size_t in_a_post = 100;
  std::chrono::milliseconds a_try{5'000};
  std::chrono::milliseconds first_pause{100};  // before a failed post is retried; doubled each time
  std::chrono::milliseconds longest_pause{5'000};
};

/// Sends JSON texts to a web address (HTTP or HTTPS, POST): a body is an array of the waiting ones, oldest first.
/// Bodies that fail, or are answered with 408, 429 or 5xx, are retried; any other answer except 2xx is counted as a
/// refusal.
///
/// threads  calls from one thread; sending has a thread of its own, so that a slow receiver blocks nothing
class EventPoster {
 public:
  struct PostCounts {
    std::uint64_t posted = 0;
    std::uint64_t dropped = 0;  // there was no room, or they were not sent before the end
    std::uint64_t refused = 0;
    std::uint64_t failed_tries = 0;
    std::string last_failure = {};
  };

  /// Throws Failure if the URL is not an http:// or https:// address, or if the module for HTTP is missing.
  explicit EventPoster(const std::string& url, const PostLimits& limits = {});
  /// Stops sending.
  ~EventPoster();
  EventPoster(const EventPoster&) = delete;
  EventPoster& operator=(const EventPoster&) = delete;

  void post(std::string json);
  /// Sends the waiting texts for at most this long; the rest is dropped and counted.
  PostCounts finish(std::chrono::milliseconds wait);

 private:
  enum class Delivery { done, refused, failed };
  void run();
  Delivery deliver(const std::string& body);
  bool is_over();

  const http::HttpModule& http_;
  const std::string url_;
  const PostLimits limits_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> waiting_;  // those being sent stay at its front
  std::size_t under_way_ = 0;
  bool is_over_ = false;
  PostCounts counts_;
  std::thread thread_;
};

}  // namespace collided::cli
