#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/keys/rights.hpp"

/// The two kinds of document that the permissions authority signs (DDS Security 1.1, 9.4.1).
namespace collided::keys {

/// Protection of network traffic, beyond access control. none: only that. sign: it cannot be changed or forged in
/// transit. encrypt: nor read.
enum class Protection { none, sign, encrypt };
std::string_view name_of(Protection protection);

/// The subject of the permissions and what they allow.
struct Grant {
  std::string name;  // common name of the certificate
  std::vector<KeyRole> roles;
  std::vector<std::string> objects;  // globs of the names that it may publish or change; empty: all
  std::int64_t from_s = 0;           // since 1970
  std::int64_t until_s = 0;
};

/// The same for all participants: none joins without a certificate, and every topic has rights.
std::string governance_xml(Protection protection);
std::string permissions_xml(const Grant& grant);

}  // namespace collided::keys
