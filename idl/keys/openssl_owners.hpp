#pragma once

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include <memory>
#include <string>

/// Owners of objects made by OpenSSL's C interface.
namespace collided::keys {

template <auto kFree>
struct FreeBy {
  template <class T>
  void operator()(T* made) const {
    kFree(made);
  }
};
using Bio = std::unique_ptr<BIO, FreeBy<BIO_free_all>>;
using PrivateKey = std::unique_ptr<EVP_PKEY, FreeBy<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, FreeBy<X509_free>>;
using RevokedList = std::unique_ptr<X509_CRL, FreeBy<X509_CRL_free>>;
using SignedDocument = std::unique_ptr<PKCS7, FreeBy<PKCS7_free>>;

/// Reads from the text, which must outlive it.
Bio bio_of(const std::string& text);
/// Memory for OpenSSL to write to.
Bio empty_bio();
std::string text_of(BIO& bio);

/// Null if the text is not a certificate.
Certificate certificate_of(const std::string& pem);
/// Null if the text is not a private key, or needs a password; it never prompts for one.
PrivateKey private_key_of(const std::string& pem);

}  // namespace collided::keys
