#include "client/cli/output/event_poster.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "idl/module.hpp"

namespace collided::cli {
namespace {

constexpr long kOk = 200, kNotOk = 300, kTimedOut = 408, kTooMany = 429, kServersFault = 500;

const http::HttpModule& module_for_posts() {
  try {
    return http::http_module("--post");
  } catch (const ModuleMissing& missing) { throw bad_use(missing.what()); }
}

}  // namespace

EventPoster::EventPoster(const std::string& url, const PostLimits& limits)
    : http_(module_for_posts()), url_(url), limits_(limits) {
  if (!http_.is_web_address(url))
    throw bad_use(fmt::format("'{}' is no web address", url), "such as http://127.0.0.1:8080/contacts");
  thread_ = std::thread([this] { run(); });
}

EventPoster::~EventPoster() { finish(std::chrono::milliseconds(0)); }

void EventPoster::post(std::string json) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(json));
  if (waiting_.size() > limits_.waiting && waiting_.size() > under_way_) {
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(under_way_));
    ++counts_.dropped;
  }
  changed_.notify_all();
}

EventPoster::PostCounts EventPoster::finish(std::chrono::milliseconds wait) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, wait, [&] { return waiting_.empty() || is_over_; });
  is_over_ = true;
  changed_.notify_all();
  lock.unlock();
  if (thread_.joinable()) thread_.join();
  lock.lock();
  counts_.dropped += waiting_.size();
  waiting_.clear();
  return counts_;
}

bool EventPoster::is_over() {
  const std::lock_guard lock(mutex_);
  return is_over_;
}

void EventPoster::run() {
  std::chrono::milliseconds pause = limits_.first_pause;
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return !waiting_.empty() || is_over_; });
    if (is_over_) return;
    under_way_ = std::min(waiting_.size(), limits_.in_a_post);
    std::string body = "[";
    for (std::size_t i = 0; i < under_way_; ++i) body += (i == 0 ? "" : ",") + waiting_[i];
    body += "]";
    lock.unlock();
    const Delivery outcome = deliver(body);
    lock.lock();
    if (outcome == Delivery::failed) {
      ++counts_.failed_tries;
      changed_.wait_for(lock, pause, [&] { return is_over_; });
      pause = std::min(2 * pause, limits_.longest_pause);
      continue;
    }
    pause = limits_.first_pause;
    (outcome == Delivery::done ? counts_.posted : counts_.refused) += under_way_;
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(std::exchange(under_way_, 0)));
    changed_.notify_all();
  }
}

EventPoster::Delivery EventPoster::deliver(const std::string& body) {
  // A connection for each body: there are about ten posts a second, and a replaced receiver is found again.
  const http::HttpAnswer answer = http_.connect()->post({.url = url_,
                                                         .body = body,
                                                         .patience_ns = std::chrono::nanoseconds(limits_.a_try).count(),
                                                         .is_web = true,
                                                         .is_over = [this] { return is_over(); }});
  const bool is_answered = answer.problem.empty();
  if (is_answered && answer.status >= kOk && answer.status < kNotOk) return Delivery::done;
  const std::lock_guard lock(mutex_);
  counts_.last_failure = is_answered ? fmt::format("answered {}", answer.status) : answer.problem;
  const bool is_passing =
      !is_answered || answer.status >= kServersFault || answer.status == kTimedOut || answer.status == kTooMany;
  return is_passing ? Delivery::failed : Delivery::refused;
}

}  // namespace collided::cli
