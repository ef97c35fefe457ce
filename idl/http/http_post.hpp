#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

/// JSON by HTTP, through libcurl, which is in a module of its own.
namespace collided::http {

struct HttpPost {
  std::string url;
  const std::string& body;  // JSON
  std::int64_t patience_ns = 0;
  bool is_web = false;                 // HTTPS and the environment's proxies as well; the answer's body is not read
  std::function<bool()> is_over = {};  // asked about once a second; true ends it early
};

struct HttpAnswer {
  long status = 0;
  std::string body = {};     // at most kMostHttpBodyBytes; a longer one is a problem
  std::string problem = {};  // why the request came to nothing, in a few words; empty: it was answered
};
inline constexpr std::size_t kMostHttpBodyBytes = 65'536;

/// The functions of the module, as kHttpModule returns them.
struct HttpModule {
  bool (*is_web_address)(const std::string& url);  // http:// or https://
  /// Posts over a connection of its own. Returns within the patience, whatever the other side does.
  void (*post)(const HttpPost& what, HttpAnswer& answer);
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
