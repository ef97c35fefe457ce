// An etcd with TLS and users, as it is installed: it serves a client with the right keys, and each wrong one is a sentence.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "idl/base64.hpp"
#include "idl/etcd/etcd_client.hpp"
#include "idl/etcd/etcd_members.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/etcd_process.hpp"
#include "tests/service/eventually.hpp"
#include "tests/unit/fleet/watch_run.hpp"

namespace collided::etcd {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing_support::EtcdCluster;
namespace fs = std::filesystem;

/// Certificates, keys, and an etcd of which the user `planner` may use the keys from "yard" on.
class EtcdWithTls : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!can_run()) return;
    folder_ = std::make_unique<testing_support::ScratchFolder>();
    // etcd's gateway shows the server's certificate as a client's. It takes none with a common name once it has users.
    make_authority("ca");
    make_authority("other_ca");
    make_certificate("server", "/O=collided", "ca", "IP:127.0.0.1");
    make_certificate("client", "/O=collided", "ca", "DNS:client");
    make_certificate("named", "/CN=planner", "ca", "DNS:client");
    make_certificate("expired", "/O=collided", "ca", "IP:127.0.0.1", "-days -1");
    cluster_ = std::make_unique<EtcdCluster>(1, folder_->path(), server_arguments("server"));
    ASSERT_TRUE(cluster_->is_ready(30s)) << cluster_->member(0).output();
    make_users();
  }
  static void TearDownTestSuite() {
    cluster_.reset();
    folder_.reset();
  }
  void SetUp() override {
    if (!can_run()) GTEST_SKIP() << "etcd or openssl is not installed";
    // Each test has a folder of good keys, and spoils it.
    keys_ = folder_->path() + "/keys";
    fs::remove_all(keys_);
    fs::create_directory(keys_);
    install("ca.crt", "ca.crt");
    install("client.crt", "tls.crt");
    install("client.key", "tls.key");
    write("username", "planner\n");
    write("password", "good\n");
  }

  static bool can_run() { return testing_support::has_etcd() && access("/usr/bin/openssl", X_OK) == 0; }
  static void run(const std::string& command) {
    const std::string in_folder = "cd '" + folder_->path() + "' && /usr/bin/openssl " + command + " 2>openssl.err";
    ASSERT_EQ(std::system(in_folder.c_str()), 0) << command;
  }
  static constexpr const char* kNewKey = " -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout ";
  static void make_authority(const std::string& name) {
    run("req -x509" + (kNewKey + name) + ".key -out " + name + ".crt -days 2 -subj /O=" + name);
  }
  static void make_certificate(const std::string& name, const std::string& subject, const std::string& authority,
                               const std::string& of, const std::string& days = "-days 2") {
    folder_->write(name + ".ext", "subjectAltName=" + of + "\nextendedKeyUsage=serverAuth,clientAuth\n");
    run("req" + (kNewKey + name) + ".key -out " + name + ".csr -subj " + subject);
    run("x509 -req -in " + name + ".csr -CA " + authority + ".crt -CAkey " + authority + ".key -CAcreateserial -out " +
        name + ".crt -extfile " + name + ".ext " + days);
  }
  static std::vector<std::string> server_arguments(const std::string& certificate) {
    const std::string in = folder_->path() + "/";
    return {"--cert-file", in + certificate + ".crt", "--key-file", in + certificate + ".key", "--trusted-ca-file",
            in + "ca.crt", "--client-cert-auth"};
  }
  static void make_users() {
    const std::string root = folder_->path() + "/root";
    fs::create_directory(root);
    for (const auto& [from, to] : {std::pair{"ca.crt", "ca.crt"}, {"client.crt", "tls.crt"}, {"client.key", "tls.key"}})
      fs::copy_file(folder_->path() + "/" + from, root + "/" + to);
    std::ofstream(root + "/username") << "root";
    std::ofstream(root + "/password") << "the root's";
    root_ = std::make_unique<EtcdMembers>(*parse_etcd_address(cluster_->address(), root), 10'000'000'000);
    administer("user/add", {{"name", "root"}, {"password", "the root's"}});
    administer("user/grant", {{"user", "root"}, {"role", "root"}});
    administer("role/add", {{"name", "yard"}});
    administer(
        "role/grant",
        {{"name", "yard"},
         {"perm", {{"permType", "READWRITE"}, {"key", encode_base64("yard")}, {"range_end", encode_base64("yare")}}}});
    administer("user/add", {{"name", "planner"}, {"password", "good"}});
    administer("user/grant", {{"user", "planner"}, {"role", "yard"}});
    administer("enable", json::object());
  }
  static void administer(const std::string& what, const json& how) {
    root_->ask(("/v3/auth/" + what).c_str(), how, [](const json&) {});
  }

  void install(const std::string& from, const std::string& to) {
    fs::copy_file(folder_->path() + "/" + from, keys_ + "/" + to, fs::copy_options::overwrite_existing);
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(keys_ + "/" + name) << text; }

  EtcdClient client(const std::string& address = cluster_->address()) {
    return {*parse_etcd_address(address, keys_), 10'000'000'000};
  }
  /// Writes a key and reads it. Why that came to nothing; empty: it did not.
  static std::string failure(EtcdClient client, const std::string& key = "yard") {
    try {
      const StoreResult result = client.transact({.conditions = {}, .writes = {{key, "map"}}, .reads = {key}});
      EXPECT_EQ(result.values.at(0), "map");
      return {};
    } catch (const StoreError& failed) { return failed.what(); }
  }
  /// The address, as a sentence names it.
  static std::string member() { return cluster_->address().substr(std::string("etcds://").size()); }

  static inline std::unique_ptr<testing_support::ScratchFolder> folder_;
  static inline std::unique_ptr<EtcdCluster> cluster_;
  static inline std::unique_ptr<EtcdMembers> root_;
  std::string keys_;
};

bool says_all(const std::string& text, const std::vector<std::string>& parts) {
  return std::ranges::all_of(parts, [&](const std::string& part) { return text.find(part) != text.npos; });
}

TEST_F(EtcdWithTls, TheRightKeysOpenIt) {
  EXPECT_EQ(failure(client()), "");
  EtcdClient leases = client();
  const std::int64_t lease = leases.grant(5);
  EXPECT_TRUE(leases.renew(lease));
  leases.revoke(lease);
}

TEST_F(EtcdWithTls, EachWrongKeyIsASentenceThatNamesIt) {
  struct Row {
    const char* what;
    std::function<void()> spoil;
    std::vector<std::string> parts;
  };
  const auto drop = [&](const char* name) { return [this, name] { fs::remove(keys_ + "/" + name); }; };
  const Row rows[] = {
      {"no authority",
       drop("ca.crt"),
       {member(), "its certificate is not accepted: ", "local issuer", "the system; --etcd-keys DIR names others"}},
      {"another authority",
       [&] { install("other_ca.crt", "ca.crt"); },
       {member(), "its certificate is not accepted: ", "local issuer", "(trusted: " + keys_ + "/ca.crt)"}},
      {"no certificate",
       [&] { drop("tls.crt")(), drop("tls.key")(); },
       {member(), "it may want a client certificate, and there is none"}},
      {"half a certificate", drop("tls.key"), {keys_, "tls.crt and tls.key belong together", "etcd was not asked"}},
      {"a key of another certificate", [&] { install("server.key", "tls.key"); }, {member(), "private key"}},
      {"an expired certificate",
       [&] { install("expired.crt", "tls.crt"), install("expired.key", "tls.key"); },
       {member(), "it may not take " + keys_ + "/tls.crt"}},
      {"a certificate with a name",
       [&] { install("named.crt", "tls.crt"), install("named.key", "tls.key"); },
       {member(), "takes no client certificate with a common name (CN)"}},
      {"a wrong password",
       [&] { write("password", "bad"); },
       {member(), "user 'planner' is refused with the password in " + keys_}},
      {"a user who is none", [&] { write("username", "stranger"); }, {member(), "user 'stranger' is refused"}},
      {"no password", drop("password"), {keys_, "username and password belong together"}},
      {"an empty password", [&] { write("password", ""); }, {keys_ + "/password: cannot be read"}},
      {"no user",
       [&] { drop("username")(), drop("password")(); },
       {member(), "a user is needed", "--etcd-keys DIR with username and password"}},
      {"no folder", [&] { fs::remove_all(keys_); }, {keys_ + ": there is no such folder"}},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.what);
    SetUp();
    row.spoil();
    const std::string why = failure(client());
    EXPECT_TRUE(says_all(why, row.parts)) << why;
    EXPECT_LT(why.size(), 400U);
  }
}

TEST_F(EtcdWithTls, WhatTheUserMayNotDoIsASentence) {
  EXPECT_EQ(failure(client(), "other"), member() + ": user 'planner' has no permission for these keys");
  EXPECT_THROW(client().transact({.conditions = {}, .writes = {}, .reads = {"other"}}), StoreRefused);
}

TEST_F(EtcdWithTls, AnotherHostNameOrNoTlsIsASentence) {
  const std::string port = member().substr(member().rfind(':') + 1);
  const std::string why = failure(client("etcds://localhost:" + port));
  EXPECT_TRUE(says_all(why, {"localhost:" + port, "its certificate is not accepted", "host name 'localhost'"})) << why;
  const std::string plain = failure({*parse_etcd_address("etcd://" + member()), 10'000'000'000});
  EXPECT_TRUE(says_all(plain, {member(), "it may want etcds://"})) << plain;
  // The password would be readable on the network.
  EXPECT_EQ(failure(client("etcd://" + member())),
            keys_ + ": keys for etcd need an address etcds://; etcd was not asked");
}

TEST_F(EtcdWithTls, AnExpiredCertificateIsASentence) {
  const testing_support::ScratchFolder folder;
  EtcdCluster old(1, folder.path(), server_arguments("expired"));
  ASSERT_TRUE(old.is_ready(30s)) << old.member(0).output();
  const std::string why = failure(client(old.address()));
  EXPECT_TRUE(says_all(why, {"its certificate is not accepted: certificate has expired"})) << why;
}

// A member forgets its tokens with its process; and a changed password ends those that were given for the old one.
TEST_F(EtcdWithTls, ATokenThatIsRefusedIsAskedForAnewWithTheFilesAsTheyAreThen) {
  EtcdClient kept = client();
  const auto can_write = [&] {
    return kept.transact({.conditions = {}, .writes = {{"yard", "1"}}, .reads = {}}).is_done;
  };
  ASSERT_TRUE(can_write());
  cluster_->member(0).signal(SIGKILL);
  cluster_->member(0).wait(5s);
  cluster_->start(0);
  ASSERT_TRUE(cluster_->is_ready(30s));
  EXPECT_TRUE(can_write());
  administer("user/changepw", {{"name", "planner"}, {"password", "better"}});
  EXPECT_THROW(can_write(), StoreRefused);
  write("password", "better");
  EXPECT_TRUE(can_write());
  administer("user/changepw", {{"name", "planner"}, {"password", "good"}});
}

TEST_F(EtcdWithTls, AWatchGoesOnThoughItsTokenWasForgotten) {
  ASSERT_EQ(failure(client(), "yard/watched"), "");
  testing_support::WatchRun run(*parse_etcd_address(cluster_->address(), keys_), {.key = "yard/watched"},
                                2'000'000'000);
  ASSERT_TRUE(test::eventually([&] { return run.texts().size() == 1; }));
  cluster_->member(0).signal(SIGKILL);
  cluster_->member(0).wait(5s);
  cluster_->start(0);
  ASSERT_TRUE(cluster_->is_ready(30s));
  ASSERT_EQ(failure(client(), "yard/watched"), "");
  EXPECT_TRUE(test::eventually([&] { return run.texts().size() == 2; }));
}

TEST_F(EtcdWithTls, WhatMayNotBeWatchedIsAProblem) {
  testing_support::WatchRun run(*parse_etcd_address(cluster_->address(), keys_), {.key = "other"}, 2'000'000'000);
  ASSERT_TRUE(test::eventually([&] { return !run.problems().empty(); }));
  EXPECT_EQ(run.problems().back(), member() + ": user 'planner' has no permission for these keys");
  EXPECT_LT(run.stop(), 1s);
}

}  // namespace
}  // namespace collided::etcd
