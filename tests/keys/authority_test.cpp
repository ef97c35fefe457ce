// Folders of keys as they are made, and what is said of those that cannot be used.
#include "client/keys/authority.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "client/keys/certificates.hpp"
#include "tests/keys/key_folders.hpp"

namespace collided {
namespace {

namespace fs = std::filesystem;
using keys::KeyError;
using keys::KeyRole;

void write(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::trunc);
  file << text;
}

unsigned mode_of(const std::string& path) {
  struct stat about {};
  EXPECT_EQ(::stat(path.c_str(), &about), 0) << path;
  return about.st_mode & 0777U;
}

class Folder : public testing::Test {
 protected:
  std::string said_of(const std::string& folder) {
    try {
      keys::check_keys(folder);
    } catch (const KeyError& wrong) { return wrong.what(); }
    return "good";
  }
  /// Whether what is said names the file, what is wrong with it and what to do.
  void expect_said(const std::string& folder, const std::string& file, const std::string& wrong,
                   const std::string& remedy) {
    const std::string said = said_of(folder);
    for (const std::string& part : {folder + '/' + file, wrong, remedy})
      EXPECT_NE(said.find(part), std::string::npos) << '\'' << part << "' in: " << said;
  }

  test::KeyFolders folders_;
  const std::string folder_ = folders_.of("robot7", {KeyRole::publisher}, {"robot7/*"});
};

TEST_F(Folder, NewOnesAreGoodForAsLongAsWasAsked) {
  const keys::KeyHolder holder = keys::check_keys(folder_);
  EXPECT_EQ(holder.name, "robot7");
  EXPECT_NEAR(static_cast<double>(holder.until_s - std::time(nullptr)), 90 * 86'400, 60);
}

TEST_F(Folder, OnlyTheOwnerReadsPrivateKeys) {
  EXPECT_EQ(mode_of(folder_ + "/key.pem"), 0600U);
  EXPECT_EQ(mode_of(folder_), 0700U);
  EXPECT_EQ(mode_of(folders_.path() + "/authority"), 0700U);
  for (const char* key : {"/authority/identity_key.pem", "/authority/permissions_key.pem"})
    EXPECT_EQ(mode_of(folders_.path() + key), 0600U);
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_EQ(keys::read_key_file(entry.path().string()).find("PRIVATE KEY") != std::string::npos,
              entry.path().filename() == "key.pem");
}

TEST_F(Folder, EachMissingFileIsNamed) {
  for (const char* name : keys::kFiles) {
    const std::string path = folder_ + '/' + name;
    fs::rename(path, path + ".away");
    expect_said(folder_, name, "No such file", "collide keys add");
    fs::rename(path + ".away", path);
  }
  EXPECT_EQ(said_of(folder_), "good");
}

TEST_F(Folder, AKeyThatOthersMayReadIsRefused) {
  fs::permissions(folder_ + "/key.pem", fs::perms::group_read, fs::perm_options::add);
  expect_said(folder_, "key.pem", "others may read it", "chmod 600");
}

TEST_F(Folder, FilesOfAnotherFolderAreRefused) {
  const std::string other = folders_.of("robot8", {KeyRole::publisher});
  fs::copy_file(other + "/permissions.p7s", folder_ + "/permissions.p7s", fs::copy_options::overwrite_existing);
  expect_said(folder_, "permissions.p7s", "CN=robot8", "CN=robot7");
  folders_.of("robot7", {KeyRole::publisher});
  fs::copy_file(other + "/key.pem", folder_ + "/key.pem", fs::copy_options::overwrite_existing);
  expect_said(folder_, "key.pem", "does not belong to certificate.pem", "copy the folder again");
}

TEST_F(Folder, AChangedDocumentIsRefused) {
  std::string text = keys::read_key_file(folder_ + "/permissions.p7s");
  text.replace(text.find("robot7/*"), 8, "robot8/*");
  write(folder_ + "/permissions.p7s", text);
  expect_said(folder_, "permissions.p7s", "not signed by permissions_ca.pem", "copy the folder again");
}

TEST_F(Folder, AnExpiredCertificateIsRefused) {
  const std::string secrets = folders_.path() + "/authority/";
  const keys::KeyPair authority{keys::read_key_file(secrets + "identity_ca.pem"),
                                keys::read_key_file(secrets + "identity_key.pem")};
  const keys::KeyPair old = keys::make_member(authority, "robot7", std::time(nullptr) - 60);
  write(folder_ + "/certificate.pem", old.certificate);
  expect_said(folder_, "certificate.pem", "expired on", "collide keys add robot7");
}

TEST_F(Folder, RevokedKeysAreRefusedAndNoneOfThatNameIsLeft) {
  const std::string kept = folders_.path() + "/kept";
  const std::string other = folders_.of("robot8", {KeyRole::publisher});
  fs::copy(folder_, kept);
  folders_.of("robot7", {KeyRole::publisher});  // renewed: the first certificate is good all the same
  EXPECT_EQ(folders_.authority().revoke("robot7"), 2U);
  EXPECT_FALSE(fs::exists(folder_));
  EXPECT_EQ(said_of(other), "good");
  fs::copy_file(other + "/revoked.pem", kept + "/revoked.pem", fs::copy_options::overwrite_existing);
  expect_said(kept, "certificate.pem", "revoked", "collide keys add robot7");
  folders_.of("robot7", {KeyRole::publisher});
  EXPECT_EQ(said_of(folder_), "good") << "the name may be used again";
}

TEST_F(Folder, CheckTellsWhatIsWrongAndWhatExpiresSoon) {
  folders_.authority().add("guest", {KeyRole::watcher}, {}, 7);
  fs::remove(folders_.of("robot8", {KeyRole::publisher}) + "/key.pem");
  std::string told;
  for (const keys::KeyFinding& finding : folders_.authority().check())
    told += finding.name + ' ' + std::to_string(static_cast<int>(finding.kind)) + ';';
  EXPECT_EQ(told, "authority 0;guest 1;robot7 0;robot8 2;");
}

TEST_F(Folder, NamesThatCouldMeanSomethingElseAreRefused) {
  keys::Authority authority = folders_.authority();
  for (const char* name : {"", "..", "a/b", "authority", "-x", "a b", "a<b", "\xc3\xa4"})
    EXPECT_THROW(authority.add(name, {KeyRole::asker}, {}, 90), KeyError) << name;
  EXPECT_THROW(authority.add("x", {}, {}, 90), KeyError);
  EXPECT_THROW(authority.add("x", {KeyRole::asker}, {}, 0), KeyError);
  EXPECT_THROW(authority.add("x", {KeyRole::asker}, {"a b"}, 90), KeyError);
  EXPECT_THROW(keys::Authority::init(folders_.path(), keys::Protection::sign), KeyError) << "never made over another";
}

}  // namespace
}  // namespace collided
