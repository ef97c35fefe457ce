#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "idl/etcd/etcd_address.hpp"

namespace collided::testing_support {

inline std::string http_answer(const std::string& body, const std::string& status = "200 OK") {
  return "HTTP/1.1 " + status + "\r\nContent-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) +
         "\r\n\r\n" + body;
}

/// A server on a free port of this machine that does with each connection as it is told.
class HostileServer {
 public:
  using Treat = std::function<void(int connection, const std::atomic<bool>& is_over)>;
  explicit HostileServer(Treat treat) : treat_(std::move(treat)), listener_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_, 8), 0);
    EXPECT_EQ(getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    endpoint_ = {.host = "127.0.0.1", .port = std::to_string(ntohs(address.sin_port))};
    thread_ = std::thread([this] { run(); });
  }
  ~HostileServer() {
    is_over_.store(true);
    thread_.join();
    close(listener_);
  }
  /// Sends that text to everybody who has asked, and closes.
  static Treat says(const std::string& text) {
    return [text](int connection, const std::atomic<bool>&) { send_all(connection, text); };
  }
  static bool send_all(int connection, const std::string& text) {
    return send(connection, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }
  const etcd::EtcdEndpoint& endpoint() const { return endpoint_; }
  int asked() const { return asked_.load(); }
  /// What each connection asked, as it came.
  std::vector<std::string> questions() const {
    const std::lock_guard lock(mutex_);
    return questions_;
  }

 private:
  void run() {
    while (!is_over_.load()) {
      pollfd waiting{.fd = listener_, .events = POLLIN, .revents = 0};
      if (poll(&waiting, 1, 10) <= 0) continue;
      const int connection = accept(listener_, nullptr, nullptr);
      ++asked_;
      std::string question(65'536, '\0');
      question.resize(
          static_cast<std::size_t>(std::max<ssize_t>(0, recv(connection, question.data(), question.size(), 0))));
      {
        const std::lock_guard lock(mutex_);
        questions_.push_back(std::move(question));
      }
      treat_(connection, is_over_);
      close(connection);
    }
  }

  const Treat treat_;
  const int listener_;
  etcd::EtcdEndpoint endpoint_;
  std::atomic<bool> is_over_{false};
  std::atomic<int> asked_{0};
  mutable std::mutex mutex_;
  std::vector<std::string> questions_;
  std::thread thread_;
};

}  // namespace collided::testing_support
