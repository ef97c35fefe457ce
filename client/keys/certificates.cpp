#include "client/keys/certificates.hpp"

#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <ctime>

#include "idl/keys/key_folder.hpp"
#include "idl/keys/openssl_owners.hpp"

namespace collided::keys {
namespace {

using Number = std::unique_ptr<BIGNUM, FreeBy<BN_free>>;
using Asn1Number = std::unique_ptr<ASN1_INTEGER, FreeBy<ASN1_INTEGER_free>>;
using Asn1Time = std::unique_ptr<ASN1_TIME, FreeBy<ASN1_TIME_free>>;

void check(bool worked, const char* what) {
  if (worked) return;
  char reason[256] = {};
  ERR_error_string_n(ERR_get_error(), reason, sizeof reason);
  throw KeyError(std::string("keys: ") + what + ": " + reason);
}

/// Clocks of several machines differ; a certificate is valid everywhere at once.
constexpr std::int64_t kClockSlackS = 3'600;

void add_extension(X509& certificate, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, &certificate, &certificate, nullptr, nullptr, 0);
  const std::unique_ptr<X509_EXTENSION, FreeBy<X509_EXTENSION_free>> extension(
      X509V3_EXT_conf_nid(nullptr, &context, kind, value));
  check(extension && X509_add_ext(&certificate, extension.get(), -1) == 1, "add extension");
}

void set_random_serial(X509& certificate) {
  const Number number(BN_new());
  // 127 bits, so that it is positive; the next one cannot be guessed.
  check(BN_rand(number.get(), 127, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1, "random number");
  check(BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(&certificate)) != nullptr, "serial number");
}

/// A certificate that lacks its issuer and signature.
Certificate unsigned_certificate(EVP_PKEY& key, const std::string& common_name, std::int64_t until_s) {
  Certificate certificate(X509_new());
  check(certificate && X509_set_version(certificate.get(), X509_VERSION_3) == 1, "make certificate");
  set_random_serial(*certificate);
  const std::int64_t now_s = std::time(nullptr);
  check(ASN1_TIME_set(X509_getm_notBefore(certificate.get()), now_s - kClockSlackS) != nullptr, "set time");
  check(ASN1_TIME_set(X509_getm_notAfter(certificate.get()), until_s) != nullptr, "set time");
  X509_NAME* const subject = X509_get_subject_name(certificate.get());
  check(X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8,
                                   reinterpret_cast<const unsigned char*>(common_name.c_str()), -1, -1, 0) == 1,
        "set name");
  check(X509_set_pubkey(certificate.get(), &key) == 1, "set key");
  return certificate;
}

KeyPair as_text(X509& certificate, EVP_PKEY& key) {
  const Bio certificate_text = empty_bio();
  const Bio key_text = empty_bio();
  check(PEM_write_bio_X509(certificate_text.get(), &certificate) == 1, "write certificate");
  check(PEM_write_bio_PrivateKey(key_text.get(), &key, nullptr, nullptr, 0, nullptr, nullptr) == 1, "write key");
  return {.certificate = text_of(*certificate_text), .key = text_of(*key_text)};
}

PrivateKey make_key() {
  PrivateKey key(EVP_EC_gen("P-256"));
  check(static_cast<bool>(key), "make key");
  return key;
}

/// The authority's own key and certificate.
struct Signer {
  explicit Signer(const KeyPair& pair) : certificate(certificate_of(pair.certificate)), key(private_key_of(pair.key)) {
    check(certificate && key, "read the authority");
  }
  Certificate certificate;
  PrivateKey key;
};

}  // namespace

KeyPair make_authority(const std::string& common_name, std::int64_t until_s) {
  const PrivateKey key = make_key();
  const Certificate certificate = unsigned_certificate(*key, common_name, until_s);
  check(X509_set_issuer_name(certificate.get(), X509_get_subject_name(certificate.get())) == 1, "set issuer");
  add_extension(*certificate, NID_basic_constraints, "critical,CA:TRUE,pathlen:0");
  add_extension(*certificate, NID_key_usage, "critical,digitalSignature,keyCertSign,cRLSign");
  check(X509_sign(certificate.get(), key.get(), EVP_sha256()) > 0, "sign certificate");
  return as_text(*certificate, *key);
}

KeyPair make_member(const KeyPair& authority, const std::string& common_name, std::int64_t until_s) {
  const Signer signer(authority);
  const PrivateKey key = make_key();
  const Certificate certificate = unsigned_certificate(*key, common_name, until_s);
  check(X509_set_issuer_name(certificate.get(), X509_get_subject_name(signer.certificate.get())) == 1, "set issuer");
  add_extension(*certificate, NID_basic_constraints, "critical,CA:FALSE");
  add_extension(*certificate, NID_key_usage, "critical,digitalSignature,keyAgreement");
  check(X509_sign(certificate.get(), signer.key.get(), EVP_sha256()) > 0, "sign certificate");
  return as_text(*certificate, *key);
}

std::string signed_document(const KeyPair& authority, const std::string& text) {
  const Signer signer(authority);
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED;
  const Bio content = bio_of(text);
  const SignedDocument document(PKCS7_sign(signer.certificate.get(), signer.key.get(), nullptr, content.get(), kFlags));
  check(static_cast<bool>(document), "sign document");
  const Bio out = empty_bio();
  // Signing has read the content to its end.
  check(BIO_reset(content.get()) == 1, "read document again");
  check(SMIME_write_PKCS7(out.get(), document.get(), content.get(), kFlags) == 1, "write document");
  return text_of(*out);
}

std::string revoked_list(const KeyPair& authority, const std::set<std::string>& serials, std::int64_t until_s) {
  const Signer signer(authority);
  const RevokedList list(X509_CRL_new());
  check(list && X509_CRL_set_version(list.get(), X509_CRL_VERSION_2) == 1, "make list");
  check(X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(signer.certificate.get())) == 1, "set issuer");
  const Asn1Time now(ASN1_TIME_set(nullptr, std::time(nullptr) - kClockSlackS));
  const Asn1Time until(ASN1_TIME_set(nullptr, until_s));
  check(X509_CRL_set1_lastUpdate(list.get(), now.get()) == 1, "set time");
  check(X509_CRL_set1_nextUpdate(list.get(), until.get()) == 1, "set time");
  for (const std::string& serial : serials) {
    BIGNUM* digits = nullptr;
    check(BN_hex2bn(&digits, serial.c_str()) > 0, "read serial number");
    const Number number(digits);
    const Asn1Number as_asn1(BN_to_ASN1_INTEGER(number.get(), nullptr));
    std::unique_ptr<X509_REVOKED, FreeBy<X509_REVOKED_free>> revoked(X509_REVOKED_new());
    check(X509_REVOKED_set_serialNumber(revoked.get(), as_asn1.get()) == 1, "set serial number");
    check(X509_REVOKED_set_revocationDate(revoked.get(), now.get()) == 1, "set time");
    check(X509_CRL_add0_revoked(list.get(), revoked.get()) == 1, "add to list");
    static_cast<void>(revoked.release());
  }
  check(X509_CRL_sort(list.get()) == 1 && X509_CRL_sign(list.get(), signer.key.get(), EVP_sha256()) > 0, "sign list");
  const Bio out = empty_bio();
  check(PEM_write_bio_X509_CRL(out.get(), list.get()) == 1, "write list");
  return text_of(*out);
}

}  // namespace collided::keys
