#pragma once

#include <set>
#include <string>

#include "idl/keys/key_folder.hpp"

namespace collided::keys {

/// The functions of key_folder.hpp that need OpenSSL, provided by the module collided-keys.so through its function
/// kKeyModule.
struct KeyModule {
  KeyHolder (*check_keys)(const std::string& folder);
  std::string (*signed_text)(const std::string& document, const std::string& authority_pem);
  std::set<std::string> (*revoked_serials)(const std::string& list_pem, const std::string& authority_pem,
                                           const std::string& where);
  CertificateFacts (*facts_of)(const std::string& certificate_pem, const std::string& where);
};
using KeyModuleFunction = const KeyModule& (*)();
inline constexpr const char* kKeyModule = "collided_key_module";

}  // namespace collided::keys
