// The module collided-keys.so, which links OpenSSL for all programs that read folders of keys.
#include "idl/keys/key_module.hpp"

#include <openssl/bn.h>
#include <openssl/pem.h>
#include <openssl/sha.h>
#include <openssl/x509_vfy.h>
#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <filesystem>

#include "idl/keys/key_folder.hpp"
#include "idl/keys/openssl_owners.hpp"

namespace collided::keys::by_openssl {

// Forward declarations: these functions use each other.
std::string signed_text(const std::string& document, const std::string& authority_pem);

namespace {

namespace fs = std::filesystem;
using Store = std::unique_ptr<X509_STORE, FreeBy<X509_STORE_free>>;
using StoreContext = std::unique_ptr<X509_STORE_CTX, FreeBy<X509_STORE_CTX_free>>;

std::int64_t seconds_of(const ASN1_TIME* time) {
  std::tm parts{};
  return time != nullptr && ASN1_TIME_to_tm(time, &parts) == 1 ? static_cast<std::int64_t>(timegm(&parts)) : 0;
}

std::string serial_text(const ASN1_INTEGER* serial) {
  const std::unique_ptr<BIGNUM, FreeBy<BN_free>> number(ASN1_INTEGER_to_BN(serial, nullptr));
  char* const digits = BN_bn2hex(number.get());
  std::string text = digits == nullptr ? "" : digits;
  OPENSSL_free(digits);
  return text;
}

std::string common_name(const X509_NAME* name) {
  char text[256] = {};
  const int length = X509_NAME_get_text_by_NID(name, NID_commonName, text, sizeof text);
  return length > 0 ? std::string(text, static_cast<std::size_t>(length)) : std::string();
}

Certificate read_certificate(const std::string& path) {
  Certificate certificate = certificate_of(read_key_file(path));
  if (!certificate) throw KeyError(path + ": no certificate in PEM; copy the folder again from `collide keys`");
  return certificate;
}

/// The private key grants all rights, so only its owner may read it.
void refuse_open_key(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) == 0 && (about.st_mode & 077) != 0)
    throw KeyError(path + ": others may read it; chmod 600 " + path);
}

/// Checks that the authority signed the certificate, and that it is valid today.
void check_certificate(X509& certificate, X509& authority, const std::string& path, const std::string& name) {
  const Store store(X509_STORE_new());
  X509_STORE_add_cert(store.get(), &authority);
  const StoreContext context(X509_STORE_CTX_new());
  X509_STORE_CTX_init(context.get(), store.get(), &certificate, nullptr);
  if (X509_verify_cert(context.get()) == 1) return;
  const int problem = X509_STORE_CTX_get_error(context.get());
  if (problem == X509_V_ERR_CERT_HAS_EXPIRED && X509_STORE_CTX_get_error_depth(context.get()) == 0) {
    throw KeyError(path + ": expired on " + date_text(seconds_of(X509_get0_notAfter(&certificate))) +
                   "; where the authority is: collide keys add " + name + " ..., then copy the folder again");
  }
  throw KeyError(path + ": " + X509_verify_cert_error_string(problem) + "; " + kIdentityAuthority +
                 " beside it must be of the authority that made it");
}

std::string signed_file(const std::string& folder, const char* name) {
  const std::string path = folder + '/' + name;
  const std::string authority = read_key_file(folder + '/' + kPermissionsAuthority);
  const std::string text = signed_text(read_key_file(path), authority);
  if (text.empty())
    throw KeyError(path + ": not signed by " + kPermissionsAuthority + " beside it; copy the folder again");
  return text;
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t first = text.find(begin);
  const std::size_t last = text.find(end, first == std::string::npos ? 0 : first);
  if (first == std::string::npos || last == std::string::npos) return {};
  return text.substr(first + begin.size(), last - first - begin.size());
}

/// Returns the end of validity of the permissions; throws if they belong to another holder or have expired.
std::int64_t check_permissions(const std::string& folder, const std::string& name) {
  const std::string text = signed_file(folder, kPermissions);
  const std::string path = folder + '/' + kPermissions;
  const std::string subject = between(text, "<subject_name>", "</subject_name>");
  if (subject != "CN=" + name)
    throw KeyError(path + ": for '" + subject + "', and the certificate beside it is for 'CN=" + name + "'");
  std::tm parts{};
  if (strptime(between(text, "<not_after>", "</not_after>").c_str(), "%Y-%m-%dT%H:%M:%S", &parts) == nullptr)
    throw KeyError(path + ": does not say until when it is good");
  const std::int64_t until_s = timegm(&parts);
  if (until_s < std::time(nullptr))
    throw KeyError(path + ": expired on " + date_text(until_s) + "; where the authority is: collide keys add " + name +
                   " ..., then copy the folder again");
  return until_s;
}

}  // namespace

std::string signed_text(const std::string& document, const std::string& authority_pem) {
  const Certificate authority = certificate_of(authority_pem);
  BIO* parts = nullptr;
  const SignedDocument parsed(SMIME_read_PKCS7(bio_of(document).get(), &parts));
  const Bio content(parts);
  if (!parsed || !authority) return {};
  const Store store(X509_STORE_new());
  X509_STORE_add_cert(store.get(), authority.get());
  const Bio text = empty_bio();
  const bool is_signed = PKCS7_verify(parsed.get(), nullptr, store.get(), content.get(), text.get(), PKCS7_TEXT) == 1;
  return is_signed ? text_of(*text) : std::string();
}

std::set<std::string> revoked_serials(const std::string& list_pem, const std::string& authority_pem,
                                      const std::string& where) {
  const Certificate authority = certificate_of(authority_pem);
  const RevokedList list(PEM_read_bio_X509_CRL(bio_of(list_pem).get(), nullptr, nullptr, nullptr));
  if (!list || !authority || X509_CRL_verify(list.get(), X509_get0_pubkey(authority.get())) != 1)
    throw KeyError(where + ": no list of revoked certificates signed by " + kIdentityAuthority + " beside it");
  std::set<std::string> serials;
  STACK_OF(X509_REVOKED)* const revoked = X509_CRL_get_REVOKED(list.get());
  for (int i = 0; i < sk_X509_REVOKED_num(revoked); ++i)
    serials.insert(serial_text(X509_REVOKED_get0_serialNumber(sk_X509_REVOKED_value(revoked, i))));
  return serials;
}

CertificateFacts facts_of(const std::string& certificate_pem, const std::string& where) {
  const Certificate certificate = certificate_of(certificate_pem);
  if (!certificate) throw KeyError(where + ": no certificate in PEM");
  const X509_NAME* const subject = X509_get_subject_name(certificate.get());
  CertificateFacts facts{.common_name = common_name(subject),
                         .serial = serial_text(X509_get0_serialNumber(certificate.get())),
                         .guid_beginning = {},
                         .until_s = seconds_of(X509_get0_notAfter(certificate.get()))};
  const unsigned char* der = nullptr;
  std::size_t der_bytes = 0;
  X509_NAME_get0_der(subject, &der, &der_bytes);
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
  SHA256(der, der_bytes, digest.data());
  // A set bit, then the first 47 bits of the subject's digest (DDS Security 1.1, 9.3.3).
  std::uint8_t carried = 0x80;
  for (std::size_t i = 0; i < facts.guid_beginning.size(); ++i) {
    facts.guid_beginning[i] = static_cast<std::uint8_t>(carried | (digest[i] >> 1));
    carried = static_cast<std::uint8_t>(digest[i] << 7);
  }
  return facts;
}

KeyHolder check_keys(const std::string& folder) {
  if (!fs::is_directory(folder))
    throw KeyError("keys: '" + folder + "' is no folder; `collide keys add NAME` makes one");
  for (const char* name : kFiles) read_key_file(folder + '/' + name);
  const std::string key_path = folder + '/' + kPrivateKey;
  refuse_open_key(key_path);
  const std::string certificate_path = folder + '/' + kCertificate;
  const Certificate certificate = read_certificate(certificate_path);
  const Certificate authority = read_certificate(folder + '/' + kIdentityAuthority);
  const std::string certificate_text = read_key_file(certificate_path);
  const CertificateFacts facts = facts_of(certificate_text, certificate_path);
  check_certificate(*certificate, *authority, certificate_path, facts.common_name);
  const PrivateKey key = private_key_of(read_key_file(key_path));
  if (!key) throw KeyError(key_path + ": no private key in PEM without a password; copy the folder again");
  if (X509_check_private_key(certificate.get(), key.get()) != 1)
    throw KeyError(key_path + ": does not belong to " + kCertificate + " beside it; copy the folder again");
  const std::string revoked_path = folder + '/' + kRevoked;
  const std::string authority_text = read_key_file(folder + '/' + kIdentityAuthority);
  if (revoked_serials(read_key_file(revoked_path), authority_text, revoked_path).contains(facts.serial))
    throw KeyError(certificate_path + ": revoked; where the authority is: collide keys add " + facts.common_name +
                   " ...");
  signed_file(folder, kGovernance);
  return {.name = facts.common_name, .until_s = std::min(facts.until_s, check_permissions(folder, facts.common_name))};
}

}  // namespace collided::keys::by_openssl

extern "C" __attribute__((visibility("default"))) const collided::keys::KeyModule& collided_key_module() {
  using namespace collided::keys;
  static constexpr KeyModule kModule{.check_keys = by_openssl::check_keys,
                                     .signed_text = by_openssl::signed_text,
                                     .revoked_serials = by_openssl::revoked_serials,
                                     .facts_of = by_openssl::facts_of};
  return kModule;
}
