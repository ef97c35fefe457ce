// Posts to a receiver of the test's own, which answers by plain sockets.

#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "client/cli/output/event_poster.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided::cli {
namespace {

using namespace std::chrono_literals;

/// Takes one request a connection and answers with what `status_of` says of its number.
class Receiver {
 public:
  explicit Receiver(std::function<int(int number)> status_of) : status_of_(std::move(status_of)) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(listener_, 8), 0);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~Receiver() {
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_) + "/contacts"; }
  std::vector<std::string> bodies() {
    const std::lock_guard lock(mutex_);
    return bodies_;
  }
  std::vector<std::string> heads() {
    const std::lock_guard lock(mutex_);
    return heads_;
  }

 private:
  void serve() {
    for (int number = 0;; ++number) {
      const int connection = ::accept(listener_, nullptr, nullptr);
      if (connection < 0) return;
      answer(connection, number);
      ::close(connection);
    }
  }
  void answer(int connection, int number) {
    std::string text;
    std::size_t body = std::string::npos, wanted = 0;
    char buffer[4096];
    while (body == std::string::npos || text.size() < body + wanted) {
      const ssize_t got = ::recv(connection, buffer, sizeof buffer, 0);
      if (got <= 0) return;
      text.append(buffer, static_cast<std::size_t>(got));
      if (body != std::string::npos) continue;
      const std::size_t end = text.find("\r\n\r\n");
      if (end == std::string::npos) continue;
      body = end + 4;
      wanted = std::stoul(text.substr(text.find("Content-Length: ") + 16));
      if (text.find("Expect: 100-continue") != std::string::npos) put(connection, "HTTP/1.1 100 Continue\r\n\r\n");
    }
    const int status = status_of_(number);
    if (status == 200) {
      const std::lock_guard lock(mutex_);
      bodies_.push_back(text.substr(body, wanted));
      heads_.push_back(text.substr(0, body));
    }
    put(connection, "HTTP/1.1 " + std::to_string(status) + " X\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
  }
  static void put(int connection, const std::string& text) {
    static_cast<void>(::send(connection, text.data(), text.size(), MSG_NOSIGNAL));
  }

  std::function<int(int)> status_of_;
  int listener_ = -1;
  int port_ = 0;
  std::mutex mutex_;
  std::vector<std::string> bodies_, heads_;
  std::thread thread_;
};

/// The numbers that arrived, in their order.
std::vector<int> numbers_in(const std::vector<std::string>& bodies) {
  std::vector<int> all;
  for (const std::string& body : bodies) {
    const nlohmann::json parsed = nlohmann::json::parse(body);
    for (const auto& event : parsed) all.push_back(event["n"].get<int>());
  }
  return all;
}
std::string event(int number) { return "{\"n\":" + std::to_string(number) + "}"; }
std::vector<int> up_to(int count) {
  std::vector<int> all;
  for (int i = 0; i < count; ++i) all.push_back(i);
  return all;
}

TEST(EventPoster, EachArrivesOnceAndInOrder) {
  Receiver receiver([](int) { return 200; });
  EventPoster poster(receiver.url());
  for (int i = 0; i < 2'500; ++i) poster.post(event(i));
  const EventPoster::PostCounts counts = poster.finish(20s);
  EXPECT_EQ(counts.posted, 2'500U);
  EXPECT_EQ(counts.dropped + counts.refused + counts.failed_tries, 0U);
  EXPECT_EQ(numbers_in(receiver.bodies()), up_to(2'500));
  EXPECT_LT(receiver.bodies().size(), 1'000U) << "what waits goes together";
  EXPECT_NE(receiver.heads().front().find("POST /contacts HTTP/1.1\r\n"), std::string::npos);
  EXPECT_NE(receiver.heads().front().find("Content-Type: application/json\r\n"), std::string::npos);
}

TEST(EventPoster, WhatFailsIsTriedAgainAndNothingIsLost) {
  Receiver receiver([](int number) { return number % 3 == 0 ? 503 : number % 3 == 1 ? 429 : 200; });
  EventPoster poster(receiver.url(), {.in_a_post = 50, .first_pause = 1ms});
  for (int i = 0; i < 500; ++i) poster.post(event(i));
  const EventPoster::PostCounts counts = poster.finish(20s);
  EXPECT_EQ(counts.posted, 500U);
  EXPECT_GE(counts.failed_tries, 20U);
  EXPECT_TRUE(counts.last_failure == "answered 503" || counts.last_failure == "answered 429") << counts.last_failure;
  EXPECT_EQ(numbers_in(receiver.bodies()), up_to(500));
}

TEST(EventPoster, ARefusalIsCountedAndTheRestGoesOn) {
  Receiver receiver([](int number) { return number == 0 ? 404 : 200; });
  EventPoster poster(receiver.url(), {.in_a_post = 1});
  for (int i = 0; i < 10; ++i) poster.post(event(i));
  const EventPoster::PostCounts counts = poster.finish(20s);
  EXPECT_EQ(counts.refused, 1U);
  EXPECT_EQ(counts.posted, 9U);
  EXPECT_EQ(counts.last_failure, "answered 404");
}

TEST(EventPoster, WithoutAReceiverTheNewestAreKeptAndTheRestCounted) {
  int port_of_nobody = 0;
  {
    Receiver gone([](int) { return 200; });
    port_of_nobody = std::stoi(gone.url().substr(17));
  }
  EventPoster poster("http://127.0.0.1:" + std::to_string(port_of_nobody) + "/",
                     {.waiting = 20, .in_a_post = 5, .first_pause = 1ms});
  for (int i = 0; i < 100; ++i) poster.post(event(i));
  const auto began = std::chrono::steady_clock::now();
  const EventPoster::PostCounts counts = poster.finish(200ms);
  EXPECT_LT(std::chrono::steady_clock::now() - began, 5s);
  EXPECT_EQ(counts.posted, 0U);
  EXPECT_EQ(counts.dropped, 100U) << "those without room, and those that waited to the end";
  EXPECT_GE(counts.failed_tries, 1U);
  EXPECT_FALSE(counts.last_failure.empty());
}

TEST(EventPoster, AReceiverThatNeverAnswersHoldsUpNobody) {
  const int silent = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(::bind(silent, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(::listen(silent, 1), 0);
  ::getsockname(silent, reinterpret_cast<sockaddr*>(&address), &size);
  EventPoster poster("http://127.0.0.1:" + std::to_string(ntohs(address.sin_port)) + "/", {.a_try = 60s});
  const auto began = std::chrono::steady_clock::now();
  for (int i = 0; i < 1'000; ++i) poster.post(event(i));
  const EventPoster::PostCounts counts = poster.finish(100ms);
  EXPECT_LT(std::chrono::steady_clock::now() - began, 10s) << "the end cuts a try short";
  EXPECT_EQ(counts.dropped, 1'000U);
  ::close(silent);
}

TEST(EventPoster, OnlyWebAddressesAreTaken) {
  for (const char* url : {"", "file:///etc/passwd", "ftp://127.0.0.1/", "http://", "127.0.0.1:80", "http://a b/"}) {
    const Ran ran = collide(std::string("watch -n 1 --post '") + url + "'");
    EXPECT_EQ(ran.code, 2) << url;
    EXPECT_NE(ran.err.find("is no web address"), std::string::npos) << ran.err;
  }
}

TEST(EventPoster, AWatchPostsWhatItPrints) {
  fake::reset();
  Event began;
  began.a = "drone \"2\"";
  began.b = "pallet";
  began.sequence = began.episode = 7;
  began.depth_m = 0.25;
  fake::server().events = {began};
  Receiver receiver([](int) { return 200; });
  const Ran ran = collide("watch -n 1 --json --post " + receiver.url());
  EXPECT_EQ(ran.code, 0);
  ASSERT_EQ(receiver.bodies().size(), 1U);
  const nlohmann::json posted = nlohmann::json::parse(receiver.bodies().front());
  ASSERT_EQ(posted.size(), 1U);
  EXPECT_EQ(posted[0], nlohmann::json::parse(ran.out));
  fake::server().events = {began};
  EXPECT_NE(at_terminal("watch -n 1 --post " + receiver.url()).err.find("1 posted, 0 dropped, 0 refused"),
            std::string::npos);
}

// 0 of 958 were posted, and the watch ended like any other.
TEST(EventPoster, AWatchWhoseEventsWereNotDeliveredSaysSo) {
  Event began;
  began.a = "drone";
  began.b = "pallet";
  const auto watch = [&](const std::string& url, int count) {
    fake::reset();
    for (int i = 1; i <= count; ++i) {
      began.sequence = began.episode = static_cast<std::uint64_t>(i);
      fake::server().events.push_back(began);
    }
    return collide("watch -q -n " + std::to_string(count) + " --json --post " + url);
  };
  Receiver refusing([](int) { return 404; });
  const Ran refused = watch(refusing.url(), 3);
  EXPECT_EQ(refused.code, 5);
  EXPECT_NE(refused.err.find("0 posted, 0 dropped, 3 refused; last failure: answered 404"), std::string::npos)
      << refused.err;
  Receiver flaky([](int post) { return post == 0 ? 404 : 200; });
  const Ran partly = watch(flaky.url(), 250);
  EXPECT_EQ(partly.code, 6) << partly.err;
}

}  // namespace
}  // namespace collided::cli
