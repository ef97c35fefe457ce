#pragma once

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace collided::test {

/// A TCP connection to a port of this machine that sends whatever it is told, well-formed or not.
class LoudClient {
 public:
  explicit LoudClient(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_port = htons(port);
    where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_open_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&where), sizeof(where)) == 0;
  }
  ~LoudClient() {
    if (socket_ >= 0) ::close(socket_);
  }
  LoudClient(LoudClient&& other) noexcept : socket_(std::exchange(other.socket_, -1)), is_open_(other.is_open_) {}
  LoudClient& operator=(LoudClient&&) = delete;

  /// How long to wait for what must come; a busy machine is no fault of the other side.
  static constexpr std::chrono::seconds kPatience{60};

  bool is_open() const { return is_open_; }
  bool send(std::string_view bytes) const {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }

  /// What comes until `text` was in it, the other side ends, or the time is over.
  std::string read_until(std::string_view text, std::chrono::milliseconds most = kPatience) const {
    return read([&](const std::string& all) { return all.find(text) != std::string::npos; }, most);
  }
  /// Everything until the other side ends; false where it does not in time.
  bool ends(std::chrono::milliseconds most = kPatience) const {
    const auto until = std::chrono::steady_clock::now() + most;
    read([](const std::string&) { return false; }, most);
    return std::chrono::steady_clock::now() < until;
  }

  /// A request with these header lines ("Name: value\r\n" each) beside Host.
  static std::string get(const std::string& target, const std::string& host, const std::string& headers = {}) {
    return "GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\n" + headers + "\r\n";
  }
  static std::string upgrade(const std::string& target, const std::string& host, const std::string& headers = {}) {
    return get(target, host,
               "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
               "AAAAAAAAAAAAAAAAAAAAAA==\r\n" +
                   headers);
  }
  /// A frame as clients send it, masked with zeroes; `first` is its first byte: 0x81 a text, 0x82 bytes, 0x88 the end.
  static std::string frame(std::string_view payload, unsigned char first = 0x81) {
    std::string bytes(1, static_cast<char>(first));
    if (payload.size() < 126) {
      bytes += static_cast<char>(0x80 | payload.size());
    } else {
      bytes += static_cast<char>(0x80 | 127);
      for (int shift = 56; shift >= 0; shift -= 8) bytes += static_cast<char>(payload.size() >> shift & 0xff);
    }
    return bytes + std::string(4, '\0') + std::string(payload);
  }

 private:
  template <class Enough>
  std::string read(Enough&& enough, std::chrono::milliseconds most) const {
    const auto until = std::chrono::steady_clock::now() + most;
    std::string all;
    char piece[65'536];
    while (!enough(all)) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
      pollfd readable{.fd = socket_, .events = POLLIN, .revents = 0};
      if (left.count() <= 0 || ::poll(&readable, 1, static_cast<int>(left.count())) <= 0) break;
      const ssize_t count = ::recv(socket_, piece, sizeof(piece), 0);
      if (count <= 0) break;
      all.append(piece, static_cast<std::size_t>(count));
    }
    return all;
  }

  int socket_;
  bool is_open_ = false;
};

}  // namespace collided::test
