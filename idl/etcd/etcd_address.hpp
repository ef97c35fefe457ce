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

/// Address of a cluster of etcd, access to it, and the key below which the data stand.
struct EtcdAddress {
  std::vector<EtcdEndpoint> endpoints;
  std::string key;               // empty: none is named
  bool has_tls = false;          // etcds://
  std::string keys_folder = {};  // see EtcdKeys; empty: none
};

/// Whether a text begins as an address of etcd does, and so names no file.
bool is_in_etcd(std::string_view text);

/// Reads etcd://HOST:PORT[,HOST:PORT...][/KEY], or etcds:// for TLS: at most 16 members, and a key of letters, digits and
/// _ . - / that does not begin or end with '/'. Nothing: it is not like that.
std::optional<EtcdAddress> parse_etcd_address(std::string_view text, const std::string& keys_folder = {});

}  // namespace collided::etcd
