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

/// Immutable bytes that many connections may send.
using Bytes = std::shared_ptr<const std::string>;

inline Bytes make_bytes(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

/// Where to listen.
struct WebAddress {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0: any that is free
};

/// Whether only programs of this machine reach the address.
bool is_loopback(const WebAddress& address);

/// Upper limits for clients.
struct WebLimits {
  std::size_t connections = 64;  // answered or watching; further ones are refused with a message
  /// Connections without a whole request, which are counted separately. Beyond it, the oldest of the address with the
  /// most is closed, so that half requests take no place from others.
  std::size_t requests = 256;
  std::uint32_t header_bytes = 8 * 1024;                // of a request; a body is refused, except an upload's
  std::uint64_t upload_bytes = std::uint64_t{1} << 30;  // of an uploaded file; one is received at a time
  std::size_t message_bytes = 16 * 1024;                // of one message from a WebSocket client
  std::uint32_t messages_a_second = 100;                // from a WebSocket client; one that sends more is dropped
  // Messages without a lane that wait for a client, behind the one being sent; with more it is dropped.
  std::size_t waiting_messages = 256;
  std::size_t waiting_bytes = 4 << 20;
  std::chrono::seconds first_request{2};  // to receive the first request of a connection
  std::chrono::seconds request{10};       // to receive a later one, including the pause before it
  std::chrono::seconds response{60};      // to send a page
  // A client that has received nothing of a message for this long is dropped, and so is a silent one, and one that has
  // not sent a piece (256 KiB) of its upload in that time.
  std::chrono::seconds stall{20};
};

/// A message to a client. While it waits, a newer one of its lane replaces it. Messages with a lane are not limited, so
/// their makers must limit them.
struct WebMessage {
  Bytes bytes;
  bool is_text = false;
  std::uint8_t lane = 0;  // 0: none, every message is sent
};

/// A page to serve.
struct WebPage {
  std::string_view type;  // for the Content-Type header; must remain valid
  Bytes body;
};

/// The answer to an uploaded file.
struct UploadAnswer {
  bool is_taken = false;  // else the page is a sentence with the reason
  WebPage page;
};

/// Counts since the start, of connections unless stated otherwise.
struct WebCounts {
  std::atomic<std::uint64_t> connections{0};
  std::atomic<std::uint64_t> open{0};        // answered or watching, now
  std::atomic<std::uint64_t> full{0};        // refused, or closed without a whole request, since there were too many
  std::atomic<std::uint64_t> forbidden{0};   // refused by the RequestRules
  std::atomic<std::uint64_t> malformed{0};   // requests and messages that are malformed or too long
  std::atomic<std::uint64_t> slow{0};        // dropped since they did not receive their messages in time
  std::atomic<std::uint64_t> flooding{0};    // dropped since they sent too much
  std::atomic<std::uint64_t> superseded{0};  // messages that a newer one replaced
  std::atomic<std::uint64_t> faults{0};      // exceptions on the server's thread, such as out of memory; it continues
};

/// An HTTP and WebSocket server on one port, on a thread of its own. All memory that clients can make it use is
/// limited.
class WebServer {
 public:
  using Connection = std::uint64_t;  // the number of a WebSocket connection; never reused

  /// Functions that the server calls, on its own thread. Only `uploaded` may wait. Targets come without the rules'
  /// token.
  struct Handlers {
    /// The page for a path with its query; nothing: 404.
    std::function<std::optional<WebPage>(std::string_view target)> page;
    /// The subprotocol to use of those offered, "" for none; nothing: the connection is refused.
    std::function<std::optional<std::string>(std::string_view target, const std::vector<std::string>& offered)>
        protocol;
    std::function<void(Connection, const std::string& protocol)> opened;
    std::function<void(Connection, std::string_view message, bool is_text)> said;
    std::function<void(Connection)> closed;
    /// The target to which this server's own pages may post a file; empty: none.
    std::string upload_target;
    /// Answers a file that was posted there. Called on a thread of its own, one file at a time.
    std::function<UploadAnswer(const std::string& path)> uploaded;
  };

  /// Listens; requests are answered after start(). Throws std::runtime_error with a sentence if it cannot listen at the
  /// address.
  WebServer(const WebAddress& address, const RequestRules& rules, const WebLimits& limits, Handlers handlers);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// Starts to answer: the handlers may be called from now on. Call it once.
  void start();
  std::uint16_t port() const;
  const WebCounts& counts() const;
  /// Sends a message to one or more connections; closed ones are ignored. Any thread.
  void send(Connection to, WebMessage message);
  void send(const std::vector<Connection>& to, const WebMessage& message);

 private:
  class Running;
  std::unique_ptr<Running> running_;
};

}  // namespace collided::view
