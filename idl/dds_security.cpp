#include "idl/dds_security.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <string_view>

#include "idl/dds.hpp"
#include "idl/keys/key_folder.hpp"

namespace collided::dds {
namespace {

namespace fs = std::filesystem;

/// Debian puts the plugins into a folder next to libddsc, which the loader does not search. Elsewhere it finds them by
/// name.
std::string plugin(const std::string& name) {
  Dl_info library{};
  if (dladdr(reinterpret_cast<const void*>(&dds_create_participant), &library) != 0 && library.dli_fname != nullptr) {
    const fs::path beside = fs::path(library.dli_fname).parent_path() / "libddsc0debian" / ("lib" + name + ".so");
    std::error_code error;
    if (fs::exists(beside, error)) return beside.string();
  }
  return name;
}

/// The shared library with this code, if it also has the handshake functions; else empty.
std::string own_library() {
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&own_library), &self) == 0 || self.dli_fname == nullptr) return {};
  // The loader's name for the file: a relative path fails after a change of folder.
  void* const loaded = dlopen(self.dli_fname, RTLD_NOW | RTLD_NOLOAD);
  if (loaded == nullptr) return {};  // a program
  const bool holds_handshake = dlsym(loaded, kHandshakeBegin) != nullptr;
  dlclose(loaded);
  return holds_handshake ? self.dli_fname : std::string();
}

/// Checks a path for use in XML in which Cyclone expands environment variables.
const std::string& checked_path(const std::string& path) {
  for (const char c : path) {
    if (static_cast<unsigned char>(c) < ' ' || std::string_view("<>&\"'$,").find(c) != std::string_view::npos)
      throw KeysError("keys '" + path + "': DDS's configuration cannot hold '" + c + "'; move the folder");
  }
  return path;
}

std::string library_element(const std::string& path, const std::string& begin, const std::string& end) {
  return R"(<Library path=")" + checked_path(path) + R"(" initFunction=")" + begin + R"(" finalizeFunction=")" + end +
         R"("/>)";
}

}  // namespace

std::string authentication_library() { return plugin("dds_security_auth"); }
std::string access_control_library() { return plugin("dds_security_ac"); }

std::string security_config(const std::string& keys, const std::string& handshake) {
  if (keys.empty()) return {};
  const std::string folder = checked_path(fs::absolute(keys).lexically_normal().string());
  const auto file = [&](const char* element, const char* name) {
    return std::string("<") + element + ">file:" + folder + '/' + name + "</" + element + '>';
  };
  const std::string first = handshake.empty() ? own_library() : handshake;
  return "<Security><Authentication>" +
         (first.empty() ? library_element(authentication_library(), "init_authentication", "finalize_authentication")
                        : library_element(first, kHandshakeBegin, kHandshakeEnd)) +
         file("IdentityCertificate", keys::kCertificate) + file("IdentityCA", keys::kIdentityAuthority) +
         file("PrivateKey", keys::kPrivateKey) + file("CRL", keys::kRevoked) + "</Authentication><AccessControl>" +
         library_element(access_control_library(), "init_access_control", "finalize_access_control") +
         file("PermissionsCA", keys::kPermissionsAuthority) + file("Governance", keys::kGovernance) +
         file("Permissions", keys::kPermissions) + "</AccessControl><Cryptographic>" +
         library_element(plugin("dds_security_crypto"), "init_crypto", "finalize_crypto") +
         "</Cryptographic></Security>";
}

}  // namespace collided::dds
