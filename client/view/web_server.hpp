#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/view/request_rules.hpp"

namespace collided::view {

/// Bytes that many connections send, and nobody changes.
using Bytes = std::shared_ptr<const std::string>;

inline Bytes make_bytes(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

struct WebAddress {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0: any that is free
};

struct WebLimits {
  std::size_t connections = 64;           // of all kinds together; whoever comes then is told so and sent away
  std::uint32_t header_bytes = 8 * 1024;  // of a request; a body is refused
  std::size_t message_bytes = 16 * 1024;  // that a WebSocket client may send at once
  std::uint32_t messages_a_second = 100;  // the same; a client that sends more is dropped
  std::size_t waiting_messages = 256;     // for a client that does not take them; with more it is dropped
  std::size_t waiting_bytes = 4 << 20;    // the same
  std::chrono::seconds request{10};       // until a request is there; also until the next one on a kept connection
  std::chrono::seconds response{60};      // until a page is sent
  std::chrono::seconds stall{20};         // a message that a client has not taken by then drops it; so does its silence
};

/// What is told a client: whole, or superseded by a newer one of its lane if it still waits.
struct WebMessage {
  Bytes bytes;
  bool is_text = false;
  std::uint8_t lane = 0;  // 0: none, every message is sent
};

struct WebPage {
  std::string_view type;  // of constant life
  Bytes body;
};

/// Counted since the start.
struct WebCounts {
  std::atomic<std::uint64_t> connections{0};
  std::atomic<std::uint64_t> open{0};        // now
  std::atomic<std::uint64_t> full{0};        // sent away since there were too many
  std::atomic<std::uint64_t> forbidden{0};   // by the rules about hosts and origins
  std::atomic<std::uint64_t> malformed{0};   // requests and messages that are none, or too long
  std::atomic<std::uint64_t> slow{0};        // dropped since they did not take what they were told
  std::atomic<std::uint64_t> flooding{0};    // dropped since they sent too much
  std::atomic<std::uint64_t> superseded{0};  // messages
  std::atomic<std::uint64_t> faults{0};      // exceptions on the server's thread, such as memory; it goes on
};

/// HTTP and WebSocket on one port, on a thread of its own. Everything that clients may make it keep is bounded.
class WebServer {
 public:
  using Connection = std::uint64_t;  // a WebSocket; numbers are never used again

  /// Called on the server's thread; none may wait.
  struct Handlers {
    /// The page of a path with its query, or nothing: 404.
    std::function<std::optional<WebPage>(std::string_view target)> page;
    /// The subprotocol to speak of those offered, "" for none of them; nothing: refused.
    std::function<std::optional<std::string>(std::string_view target, const std::vector<std::string>& offered)>
        protocol;
    std::function<void(Connection, const std::string& protocol)> opened;
    std::function<void(Connection, std::string_view message, bool is_text)> said;
    std::function<void(Connection)> closed;
  };

  /// Listens; answers once start() was called. Throws std::runtime_error with a sentence where the address cannot be had.
  WebServer(const WebAddress& address, const RequestRules& rules, const WebLimits& limits, Handlers handlers);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// Once: the handlers may be called from now on.
  void start();
  std::uint16_t port() const;
  const WebCounts& counts() const;
  /// Any thread; one that is gone takes nothing.
  void send(Connection to, WebMessage message);
  void send(const std::vector<Connection>& to, const WebMessage& message);

 private:
  class Running;
  std::unique_ptr<Running> running_;
};

}  // namespace collided::view
