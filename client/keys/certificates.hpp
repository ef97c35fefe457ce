#pragma once

#include <cstdint>
#include <set>
#include <string>

/// Keys, certificates and signatures as text in PEM. All keys are on the curve P-256. Throws KeyError if OpenSSL fails.
namespace collided::keys {

struct KeyPair {
  std::string certificate;
  std::string key;
};

/// An authority: its certificate is signed by its own key.
KeyPair make_authority(const std::string& common_name, std::int64_t until_s);
/// A key, and a certificate for it, signed by the authority.
KeyPair make_member(const KeyPair& authority, const std::string& common_name, std::int64_t until_s);
/// The document with the authority's signature (S/MIME).
std::string signed_document(const KeyPair& authority, const std::string& text);
/// The authority's list of revoked certificates.
///
/// serials  in hexadecimal
std::string revoked_list(const KeyPair& authority, const std::set<std::string>& serials, std::int64_t until_s);

}  // namespace collided::keys
