#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "idl/etcd/etcd_address.hpp"

namespace collided::etcd {

/// Why a request came to nothing, in a few words.
struct HttpError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct HttpAnswer {
  long status = 0;
  std::string body;
};

/// No answer that is longer is read.
inline constexpr std::size_t kMostHttpBodyBytes = 65'536;

/// Posts JSON by HTTP (libcurl), over a connection of its own. Returns within patience_ns, whatever the other side does.
///
/// errors   HttpError
/// threads  any
HttpAnswer http_post(const EtcdEndpoint& to, const std::string& target, const std::string& body,
                     std::int64_t patience_ns);

}  // namespace collided::etcd
