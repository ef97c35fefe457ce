#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

/// JSON by HTTP, through libcurl, which is in a module of its own.
namespace collided::http {

/// Files in PEM; empty: none.
struct HttpTlsFiles {
  std::string trusted;  // certificates that a server's may be signed by; empty: those of the system
  std::string certificate;
  std::string key;  // of the certificate
};

struct HttpPost {
  std::string url;
  const std::string& body;             // JSON
  std::int64_t patience_ns = 0;        // for all of the answer, a stream's too
  std::int64_t connect_ns = 0;         // of the patience, for the connection; 0: all of it
  bool is_web = false;                 // the environment's proxies count; the answer's body is not read
  std::function<bool()> is_over = {};  // asked ten times a second; true ends it early
  std::string authorization = {};      // the header's value; empty: no such header
  HttpTlsFiles tls = {};
  /// Takes each line of a good answer as it comes; such a body is not kept. Empty: the body is one.
  std::function<void(std::string_view line)> take_line = {};
};

/// Why a request came to nothing. A server that is not trusted will not be so at the next try.
enum class HttpFault : std::uint8_t { none, unanswered, closed, not_trusted, unusable_files };

struct HttpAnswer {
  long status = 0;
  std::string body =
      {};  // at most kMostHttpBodyBytes; a longer one is a problem, and so is a longer line than kMostHttpLineBytes
  std::string problem = {};  // why the request came to nothing, in a few words; empty: it was answered
  HttpFault fault = HttpFault::none;
};
inline constexpr std::size_t kMostHttpBodyBytes = 65'536;
inline constexpr std::size_t kMostHttpLineBytes = 4'194'304;

/// Posts one after the other; a connection is kept for the next post to the same server.
///
/// threads  one
class HttpConnection {
 public:
  virtual ~HttpConnection() = default;
  /// Returns within the patience, whatever the other side does.
  virtual HttpAnswer post(const HttpPost& what) = 0;
};

/// The functions of the module, as kHttpModule returns them.
struct HttpModule {
  bool (*is_web_address)(const std::string& url);  // http:// or https://
  std::unique_ptr<HttpConnection> (*connect)();
};
using HttpModuleFunction = const HttpModule& (*)();
inline constexpr const char* kHttpModule = "collided_http_module";

/// The module, loaded at the first call.
///
/// purpose  what needs it, for the message
/// throws   ModuleMissing
/// threads  any
const HttpModule& http_module(const std::string& purpose);

}  // namespace collided::http
