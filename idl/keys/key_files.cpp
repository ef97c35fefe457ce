// The part without OpenSSL, linked into the module and its users.
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <sstream>

#include "idl/keys/key_folder.hpp"

namespace collided::keys {

std::string date_text(std::int64_t since_1970_s) {
  const std::time_t time = since_1970_s;
  std::tm parts{};
  gmtime_r(&time, &parts);
  char text[32] = {};
  return {text, std::strftime(text, sizeof text, "%Y-%m-%d", &parts)};
}

std::string read_key_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  if (file) bytes << file.rdbuf();
  if (!file) {
    throw KeyError(path + ": " + std::strerror(errno) + "; a folder of keys is made by `collide keys add` and has " +
                   std::to_string(kFiles.size()) + " files");
  }
  return bytes.str();
}

}  // namespace collided::keys
