#include "idl/keys/openssl_owners.hpp"

#include <openssl/pem.h>

namespace collided::keys {
namespace {

int no_password(char*, int, int, void*) { return -1; }

}  // namespace

Bio bio_of(const std::string& text) { return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))); }

Bio empty_bio() { return Bio(BIO_new(BIO_s_mem())); }

std::string text_of(BIO& bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(&bio, &data);
  return size > 0 ? std::string(data, static_cast<std::size_t>(size)) : std::string();
}

Certificate certificate_of(const std::string& pem) {
  return Certificate(PEM_read_bio_X509(bio_of(pem).get(), nullptr, no_password, nullptr));
}

PrivateKey private_key_of(const std::string& pem) {
  return PrivateKey(PEM_read_bio_PrivateKey(bio_of(pem).get(), nullptr, no_password, nullptr));
}

}  // namespace collided::keys
