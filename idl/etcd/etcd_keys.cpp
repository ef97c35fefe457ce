#include "idl/etcd/etcd_keys.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "idl/etcd/lease_store.hpp"

namespace collided::etcd {
namespace {

/// The path of a file that is there, else empty.
std::string file_in(const std::filesystem::path& folder, const char* name) {
  std::error_code fault;
  const std::filesystem::path path = folder / name;
  return std::filesystem::exists(path, fault) ? path.string() : std::string();
}

/// A file's text without the end of its line; empty if the file does not exist.
std::string text_of(const std::string& path) {
  if (path.empty()) return {};
  constexpr std::size_t kMost = 4'096;
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  while (text.ends_with('\n') || text.ends_with('\r')) text.pop_back();
  if (!file || text.empty() || text.size() > kMost)
    throw StoreRefused(path + ": cannot be read, or is not a text of 1 to 4096 letters; etcd was not asked");
  return text;
}

}  // namespace

EtcdKeys read_etcd_keys(const EtcdAddress& address) {
  const std::string& folder = address.keys_folder;
  if (folder.empty()) return {};
  if (!address.has_tls) throw StoreRefused(folder + ": keys for etcd need an address etcds://; etcd was not asked");
  std::error_code fault;
  if (!std::filesystem::is_directory(folder, fault))
    throw StoreRefused(folder + ": there is no such folder of keys for etcd; etcd was not asked");
  EtcdKeys keys{.files = {.trusted = file_in(folder, "ca.crt"),
                          .certificate = file_in(folder, "tls.crt"),
                          .key = file_in(folder, "tls.key")},
                .user = text_of(file_in(folder, "username")),
                .password = text_of(file_in(folder, "password"))};
  if (keys.files.certificate.empty() != keys.files.key.empty())
    throw StoreRefused(folder + ": tls.crt and tls.key belong together, and one is missing; etcd was not asked");
  if (keys.user.empty() != keys.password.empty())
    throw StoreRefused(folder + ": username and password belong together, and one is missing; etcd was not asked");
  return keys;
}

}  // namespace collided::etcd
