#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>

/// A folder of keys: with it a program joins a domain that admits only whom its authority knows (`collide keys`, DDS
/// Security). Server, client library and command line read the same files.
namespace collided::keys {

/// A folder that cannot be used: which file, what is wrong, what to do.
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

/// Data tags in the permissions, which Cyclone passes over and the server reads: globs of the names that somebody may
/// publish or change (none: all), and "high" for who may ask questions of high importance.
inline constexpr const char* kObjectsTag = "objects";
inline constexpr const char* kImportanceTag = "importance";

/// Whose folder it is and until when it is good.
struct KeyHolder {
  std::string name;          // the common name of the certificate
  std::int64_t until_s = 0;  // since 1970: the earlier end of certificate and permissions
};

/// Reads every file of the folder and checks that each fits the others and that none is out of date.
///
/// throws  KeyError
KeyHolder check_keys(const std::string& folder);

/// The text of a document that the authority of `authority_pem` signed (S/MIME). Only what the signature covers is
/// returned. Empty: it did not sign it.
std::string signed_text(const std::string& document, const std::string& authority_pem);

/// The serial numbers, in hexadecimal, of a list of revoked certificates. Throws KeyError where the authority did not
/// sign it; `where` begins the message.
std::set<std::string> revoked_serials(const std::string& list_pem, const std::string& authority_pem,
                                      const std::string& where);

/// What there is to know of a certificate without its key.
struct CertificateFacts {
  std::string common_name;
  std::string serial;                          // hexadecimal
  std::array<std::uint8_t, 6> guid_beginning;  // of every participant that may show it
  std::int64_t until_s = 0;                    // since 1970
};
/// Throws KeyError; `where` begins the message.
CertificateFacts facts_of(const std::string& certificate_pem, const std::string& where);

/// The file's bytes. Throws KeyError where it cannot be read.
std::string read_key_file(const std::string& path);

/// "2026-02-22" in UTC.
std::string date_text(std::int64_t since_1970_s);

}  // namespace collided::keys
