#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "client/keys/authority.hpp"
#include "idl/keys/key_folder.hpp"

namespace collided::test {

/// An authority in a folder of its own, which goes with it.
class KeyFolders {
 public:
  explicit KeyFolders(keys::Protection protection = keys::Protection::encrypt)
      : folder_(std::filesystem::temp_directory_path() /
                ("collided_keys_" + std::to_string(getpid()) + '_' + std::to_string(++count()))) {
    std::filesystem::remove_all(folder_);
    keys::Authority::init(folder_.string(), protection);
  }
  ~KeyFolders() { std::filesystem::remove_all(folder_); }

  std::string path() const { return folder_.string(); }
  keys::Authority authority() const { return keys::Authority(folder_.string()); }
  /// The folder of a name with these roles.
  std::string of(const std::string& name, const std::vector<keys::KeyRole>& roles,
                 const std::vector<std::string>& objects = {}) const {
    return authority().add(name, roles, objects, 90);
  }

 private:
  static int& count() {
    static int made = 0;
    return made;
  }
  std::filesystem::path folder_;
};

}  // namespace collided::test
