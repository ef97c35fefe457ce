#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>

/// A folder of keys, with which a program joins a domain that admits only holders of certificates of its authority
/// (`collide keys`, DDS Security). Server, client library and command line read the same files.
namespace collided::keys {

/// A folder is unusable. The message names the file, the fault and the remedy.
struct KeyError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline constexpr const char* kIdentityAuthority = "identity_ca.pem";
inline constexpr const char* kPermissionsAuthority = "permissions_ca.pem";
inline constexpr const char* kGovernance = "governance.p7s";
inline constexpr const char* kPermissions = "permissions.p7s";
inline constexpr const char* kCertificate = "certificate.pem";
inline constexpr const char* kRevoked = "revoked.pem";
inline constexpr const char* kPrivateKey = "key.pem";
inline constexpr std::array kFiles{
    kIdentityAuthority, kPermissionsAuthority, kGovernance, kPermissions, kCertificate, kRevoked, kPrivateKey};

/// Data tags in the permissions, which Cyclone ignores and the server reads: globs of the names that the holder may
/// publish or change (none: all), and "high" for the right to ask questions of high importance.
inline constexpr const char* kObjectsTag = "objects";
inline constexpr const char* kImportanceTag = "importance";

/// The holder of a folder and the end of its validity.
struct KeyHolder {
  std::string name;          // the common name of the certificate
  std::int64_t until_s = 0;  // since 1970: the earlier end of certificate and permissions
};

/// Reads every file of the folder and checks that they match and that none has expired.
///
/// throws  KeyError
KeyHolder check_keys(const std::string& folder);

/// The text of a document signed by the authority of `authority_pem` (S/MIME). Only the part that the signature covers
/// is returned. Empty: not signed by it.
std::string signed_text(const std::string& document, const std::string& authority_pem);

/// The serial numbers, in hexadecimal, of a list of revoked certificates. Throws KeyError, with a message that begins
/// with `where`, if the authority did not sign it.
std::set<std::string> revoked_serials(const std::string& list_pem, const std::string& authority_pem,
                                      const std::string& where);

/// Facts about a certificate that do not require its key.
struct CertificateFacts {
  std::string common_name;
  std::string serial;                          // hexadecimal
  std::array<std::uint8_t, 6> guid_beginning;  // of every participant that may show it
  std::int64_t until_s = 0;                    // since 1970
};
/// Throws KeyError, with a message that begins with `where`.
CertificateFacts facts_of(const std::string& certificate_pem, const std::string& where);

/// The file's bytes. Throws KeyError if it cannot be read.
std::string read_key_file(const std::string& path);

/// "2026-02-22" in UTC.
std::string date_text(std::int64_t since_1970_s);

}  // namespace collided::keys
