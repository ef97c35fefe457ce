#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "idl/etcd/etcd_address.hpp"

namespace collided::etcd {

/// Why a request came to nothing, in a few words.
struct HttpError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct HttpAnswer {
  unsigned status = 0;
  std::string body;
};

struct HttpContext;

/// Posts JSON by HTTP/1.1 (Boost.Beast), each request over a connection of its own.
///
/// threads  one
class HttpPoster {
 public:
  /// No answer that is longer is read.
  static constexpr std::size_t kMostBodyBytes = 65'536;

  HttpPoster();
  /// Waits for the name that is being looked up, if one is.
  ~HttpPoster();
  HttpPoster(const HttpPoster&) = delete;
  HttpPoster& operator=(const HttpPoster&) = delete;

  /// Returns within patience_ns, whatever the other side does. Throws HttpError.
  HttpAnswer post(const EtcdEndpoint& to, const std::string& target, std::string body, std::int64_t patience_ns);

 private:
  std::unique_ptr<HttpContext> context_;
};

}  // namespace collided::etcd
