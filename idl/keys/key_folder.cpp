#include "idl/keys/key_folder.hpp"

#include "idl/keys/key_module.hpp"
#include "idl/module.hpp"

namespace collided::keys {
namespace {

const KeyModule& key_module() {
  try {
    return reinterpret_cast<KeyModuleFunction>(module_function("collided-keys.so", kKeyModule, "a folder of keys"))();
  } catch (const ModuleMissing& missing) { throw KeyError(missing.what()); }
}

}  // namespace

KeyHolder check_keys(const std::string& folder) { return key_module().check_keys(folder); }

std::string signed_text(const std::string& document, const std::string& authority_pem) {
  return key_module().signed_text(document, authority_pem);
}

std::set<std::string> revoked_serials(const std::string& list_pem, const std::string& authority_pem,
                                      const std::string& where) {
  return key_module().revoked_serials(list_pem, authority_pem, where);
}

CertificateFacts facts_of(const std::string& certificate_pem, const std::string& where) {
  return key_module().facts_of(certificate_pem, where);
}

}  // namespace collided::keys
