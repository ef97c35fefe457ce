// Who shows keys that are not good for this world does not get in, whatever he lets himself do.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "client/keys/certificates.hpp"
#include "tests/keys/everything.hpp"
#include "tests/keys/key_folders.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using keys::KeyRole;
using test::Everything;

void write(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::trunc);
  file << text;
}

class Refusals : public testing::Test {
 protected:
  /// Whether a pose written with these keys reaches a server, and whether an event of the server reaches their holder.
  std::pair<bool, bool> gets_in(const std::string& keys) {
    Everything server(folders_.of("brain", {KeyRole::server}), 0);
    Everything member(keys, 2);
    const bool is_heard = test::passes(member, server, {"pose_v2"}, 2s).contains("pose_v2");
    const bool hears = test::passes(server, member, {"event_v3"}, 500ms).contains("event_v3");
    return {is_heard, hears};
  }
  static constexpr std::pair<bool, bool> kNothing{false, false};

  test::KeyFolders folders_;
};

TEST_F(Refusals, GoodKeysGetIn) { EXPECT_EQ(gets_in(folders_.of("boss", {KeyRole::admin})), std::pair(true, true)); }

TEST_F(Refusals, WithoutKeysNobodyGetsIn) { EXPECT_EQ(gets_in(""), kNothing); }

TEST_F(Refusals, KeysOfAnotherAuthorityAreNoGood) {
  const test::KeyFolders others;
  EXPECT_EQ(gets_in(others.of("boss", {KeyRole::admin})), kNothing);
}

// A watcher with a good certificate makes himself an admin: he signs permissions with an authority of his own.
TEST_F(Refusals, PermissionsThatTheirHolderSignedAreNoGood) {
  const std::string folder = folders_.of("mallory", {KeyRole::watcher});
  const keys::KeyPair own = keys::make_authority("collided permissions authority", std::time(nullptr) + 86'400);
  write(folder + '/' + keys::kPermissionsAuthority, own.certificate);
  write(folder + '/' + keys::kGovernance, keys::signed_document(own, keys::governance_xml(keys::Protection::encrypt)));
  write(folder + '/' + keys::kPermissions,
        keys::signed_document(own, keys::permissions_xml({.name = "mallory",
                                                          .roles = {KeyRole::admin},
                                                          .objects = {},
                                                          .from_s = std::time(nullptr) - 60,
                                                          .until_s = std::time(nullptr) + 86'400})));
  ASSERT_NO_THROW(keys::check_keys(folder)) << "to himself the folder is good";
  EXPECT_EQ(gets_in(folder), kNothing);
}

// The server has the new list; whose keys are revoked has kept the old one.
TEST_F(Refusals, RevokedKeysAreNoGood) {
  const std::string folder = folders_.of("mallory", {KeyRole::admin});
  const std::string kept = folder + "_kept";
  std::filesystem::copy(folder, kept);
  folders_.authority().revoke("mallory");
  EXPECT_EQ(gets_in(kept), kNothing);
}

}  // namespace
}  // namespace collided
