#pragma once

#include <string>

#include "idl/etcd/etcd_address.hpp"
#include "idl/http/http_post.hpp"

namespace collided::etcd {

/// The credentials of a client of etcd, and the certificates that it trusts. They are files in a folder, so that no secret is in an argument or a variable, which other
/// processes may read. Each file may be missing, but tls.crt and tls.key, and username and password, only together.
struct EtcdKeys {
  http::HttpTlsFiles files;  // ca.crt, tls.crt, tls.key
  std::string user;          // empty: none
  std::string password;
};

/// Reads the folder of an address; nothing of an address without one.
///
/// throws  StoreRefused for a folder that cannot be used, or that comes with etcd://, which would show the password to the
///         network
EtcdKeys read_etcd_keys(const EtcdAddress& address);

}  // namespace collided::etcd
