#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace collided::etcd {

struct EtcdEndpoint {
  std::string host;  // name or address, without brackets
  std::string port;
};

/// Where a cluster of etcd is, and below which key what is kept there stands.
struct EtcdAddress {
  std::vector<EtcdEndpoint> endpoints;
  std::string key;  // empty: none is named
};

/// Reads etcd://HOST:PORT[,HOST:PORT...][/KEY]: at most 16 members, and a key of letters, digits and _ . - / that does
/// not begin or end with '/'. Nothing: it is not like that.
std::optional<EtcdAddress> parse_etcd_address(std::string_view text);

}  // namespace collided::etcd
