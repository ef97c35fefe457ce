#include "client/cli/output/event_poster.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <curl/curl.h>
#include <fmt/format.h>

#include "client/cli/failure.hpp"

namespace collided::cli {
namespace {

constexpr long kOk = 200, kNotOk = 300, kTimedOut = 408, kTooMany = 429, kServersFault = 500;

/// The answer's body is of no use.
std::size_t ignore(char*, std::size_t size, std::size_t count, void*) { return size * count; }

/// Set up once in a process, before its threads.
void set_up_once() {
  static const CURLcode set_up = curl_global_init(CURL_GLOBAL_DEFAULT);
  static_cast<void>(set_up);
}

}  // namespace

EventPoster::EventPoster(const std::string& url, const PostLimits& limits) : url_(url), limits_(limits) {
  const std::unique_ptr<CURLU, decltype(&curl_url_cleanup)> parts(curl_url(), curl_url_cleanup);
  const bool is_web = (url.starts_with("http://") || url.starts_with("https://")) &&
                      curl_url_set(parts.get(), CURLUPART_URL, url.c_str(), 0) == CURLUE_OK;
  if (!is_web) throw bad_use(fmt::format("'{}' is no web address", url), "such as http://127.0.0.1:8080/contacts");
  set_up_once();
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
  // A connection of its own for each body: posts are some ten a second, and a receiver that was replaced is found again.
  const std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> request(curl_easy_init(), curl_easy_cleanup);
  curl_slist* headers = curl_slist_append(nullptr, "Content-Type: application/json");
  const std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> held(headers, curl_slist_free_all);
  const auto stops = [](void* self, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
    return static_cast<EventPoster*>(self)->is_over() ? 1 : 0;
  };
  curl_easy_setopt(request.get(), CURLOPT_URL, url_.c_str());
  curl_easy_setopt(request.get(), CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(request.get(), CURLOPT_HTTPHEADER, headers);
  curl_easy_setopt(request.get(), CURLOPT_POSTFIELDS, body.data());
  curl_easy_setopt(request.get(), CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(body.size()));
  curl_easy_setopt(request.get(), CURLOPT_WRITEFUNCTION, ignore);
  curl_easy_setopt(request.get(), CURLOPT_TIMEOUT_MS, static_cast<long>(limits_.a_try.count()));
  curl_easy_setopt(request.get(), CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(request.get(), CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(request.get(), CURLOPT_XFERINFOFUNCTION,
                   static_cast<int (*)(void*, curl_off_t, curl_off_t, curl_off_t, curl_off_t)>(stops));
  curl_easy_setopt(request.get(), CURLOPT_XFERINFODATA, this);
  const CURLcode code = curl_easy_perform(request.get());
  long status = 0;
  curl_easy_getinfo(request.get(), CURLINFO_RESPONSE_CODE, &status);
  if (code == CURLE_OK && status >= kOk && status < kNotOk) return Delivery::done;
  const std::lock_guard lock(mutex_);
  counts_.last_failure = code == CURLE_OK ? fmt::format("answered {}", status) : curl_easy_strerror(code);
  const bool is_passing = code != CURLE_OK || status >= kServersFault || status == kTimedOut || status == kTooMany;
  return is_passing ? Delivery::failed : Delivery::refused;
}

}  // namespace collided::cli
