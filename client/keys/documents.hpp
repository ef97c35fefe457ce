#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/keys/rights.hpp"

/// The two kinds of document that the permissions authority signs (DDS Security 1.1, 9.4.1).
namespace collided::keys {

/// How what goes over the network is protected, beyond who may join. none: only that. sign: it cannot be changed or
/// forged on its way. encrypt: nor read.
enum class Protection { none, sign, encrypt };
std::string_view name_of(Protection protection);

/// Whom the permissions are for and what they allow.
struct Grant {
  std::string name;  // common name of the certificate
  std::vector<KeyRole> roles;
  std::vector<std::string> objects;  // globs of the names that it may publish or change; empty: all
  std::int64_t from_s = 0;           // since 1970
  std::int64_t until_s = 0;
};

/// The same for all participants: nobody joins without a certificate, every topic has rights.
std::string governance_xml(Protection protection);
std::string permissions_xml(const Grant& grant);

}  // namespace collided::keys
