// The real server with keys, asked by the command line and the library.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <thread>

#include "client/keys/certificates.hpp"
#include "collided/client.hpp"
#include "idl/dds.hpp"
#include "tests/keys/key_folders.hpp"
#include "tests/keys/stranger.hpp"
#include "tests/service/eventually.hpp"
#include "tests/service/server_process.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using keys::KeyRole;
using testing_support::ChildProcess;

class ServerWithKeys : public testing_support::ServerProcess {
 protected:
  ChildProcess& start_with_keys() { return start({"--keys", folders_.of("brain", {KeyRole::server})}); }

  Ended collide(const std::string& keys, const std::vector<std::string>& words,
                const std::vector<std::string>& before = {}) {
    std::vector<std::string> line = before;
    line.insert(line.end(), {COLLIDED_CLI, "--domain", std::to_string(domain_), "--plain"});
    if (!keys.empty()) line.insert(line.end(), {"--keys", keys});
    line.insert(line.end(), words.begin(), words.end());
    ChildProcess process(line, folder_.path(), "collide");
    const int code = process.wait(20s);
    return {code, process.output(), process.errors()};
  }
  Client connect(const std::string& keys) {
    Result<Client> client = Client::connect({.domain = domain_, .wait = 10s, .keys = keys});
    if (!client) throw std::runtime_error(client.error().message);
    return std::move(*client);
  }
  static bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

  test::KeyFolders folders_;
};

TEST_F(ServerWithKeys, EachRoleDoesWhatItMayAndNoMore) {
  start_with_keys();
  const std::string asker = folders_.of("planner", {KeyRole::asker});
  const std::string admin = folders_.of("boss", {KeyRole::admin});
  const std::string watcher = folders_.of("screen", {KeyRole::watcher});
  const std::vector<std::string> ray{"ray", "0", "0", "5", "0", "0", "-1"};
  const std::vector<std::string> add{"add", "crate", "box", "1", "1", "1", "--at", "9", "9", "9"};
  for (const std::string& keys : {asker, admin}) EXPECT_EQ(collide(keys, ray).code, 0);
  for (const std::string& keys : {asker, admin, watcher}) EXPECT_EQ(collide(keys, {"status"}).code, 0);
  const Ended refused = collide(asker, add);
  EXPECT_EQ(refused.code, 5);
  EXPECT_TRUE(says(refused.errors, "give no right to change the world")) << refused.errors;
  EXPECT_EQ(collide(watcher, ray).code, 5);
  EXPECT_EQ(collide(asker, {"watch", "--for", "100ms"}).code, 5);
  EXPECT_EQ(collide(watcher, {"watch", "--for", "100ms"}).code, 1) << "it may, and nothing has touched";
  const Ended added = collide(admin, add);
  EXPECT_EQ(added.code, 0) << added.errors;
  EXPECT_EQ(collide(asker, {"ls"}).code, 0);
}

TEST_F(ServerWithKeys, TheRoleOfAStandbyLetsItFollowAndTakeThePlace) {
  start_with_keys();
  const std::string admin = folders_.of("boss", {KeyRole::admin});
  EXPECT_EQ(collide(admin, {"add", "crate", "box", "1", "1", "1", "--at", "9", "9", "9"}).code, 0);
  const testing_support::ScratchFolder elsewhere;
  ChildProcess standby(
      {COLLIDED_SERVER, "--domain", std::to_string(domain_), "--standby-of", "collided", "--member", "south",
       "--state-dir", elsewhere.path(), "--keys", folders_.of("second", {KeyRole::standby}), "--take-over-after", "3s"},
      elsewhere.path(), "standby");
  ASSERT_TRUE(standby.says("ready: standing by", 20s)) << standby.errors();
  const std::string watcher = folders_.of("screen", {KeyRole::watcher});
  Ended seen;
  EXPECT_TRUE(test::eventually(
      [&] {
        seen = collide(watcher, {"fleet", "--fields", "name,role,state"});
        return says(seen.output, "south\tstandby\tready");
      },
      40s))
      << seen.output << seen.errors << standby.errors();
  servers_.front()->signal(SIGKILL);
  EXPECT_TRUE(test::eventually(
      [&] {
        seen = collide(admin, {"get", "crate", "--fields", "name"});
        return seen.code == 0 && says(seen.output, "crate");
      },
      40s))
      << seen.output << seen.errors << standby.errors();
  EXPECT_TRUE(says(standby.errors(), "this server has taken its place")) << standby.errors();
}

TEST_F(ServerWithKeys, TheRoleOfAStandbyLetsAReplicaAnswerWhoMayAsk) {
  start_with_keys();
  const testing_support::ScratchFolder elsewhere;
  ChildProcess replica({COLLIDED_SERVER, "--domain", std::to_string(domain_), "--replica-of", "collided", "--member",
                        "east", "--state-dir", elsewhere.path(), "--keys", folders_.of("second", {KeyRole::standby})},
                       elsewhere.path(), "replica");
  ASSERT_TRUE(replica.says("ready: replica", 20s)) << replica.errors();
  const std::string asker = folders_.of("planner", {KeyRole::asker});
  const std::string watcher = folders_.of("screen", {KeyRole::watcher});
  const std::vector<std::string> ray{"ray", "0", "0", "5", "0", "0", "-1", "--namespace", "collided/replica_east"};
  Ended seen;
  EXPECT_TRUE(test::eventually(
      [&] {
        seen = collide(asker, ray);
        return seen.code == 0;
      },
      40s))
      << seen.output << seen.errors << replica.errors();
  EXPECT_EQ(collide(watcher, ray).code, 5);
}

/// A client that speaks the wire itself.
class RawClient {
 public:
  RawClient(int domain, const std::string& keys, const std::string& partition)
      : participant_({.domain = domain, .keys = keys}),
        query_topic_(participant_, "collided"),
        reply_topic_(participant_, "collided"),
        reader_(reply_topic_, {.partition = wire_contract::reply_partition(kClient)}),
        writer_(query_topic_, {.partition = partition}) {}

  /// The text of the reply to a request of this kind, or "no reply".
  std::string ask(wire_contract::QuestionKind kind, const std::string& text = {}) {
    dds::Sample<wire::Query> query;
    dds::Sample<wire::Reply> reply;
    query->client = kClient;
    query->request = ++request_;
    query->chunk_count = 1;
    query->kind = static_cast<std::uint8_t>(kind);
    static_cast<void>(dds::set_text(query->text, text));
    std::string said = "no reply";
    test::eventually([&] {
      // Until the server's reader is matched, what is sent is lost.
      if (writer_.matched_readers() > 0 && !writer_.write(*query)) return false;
      std::this_thread::sleep_for(20ms);
      while (reader_.take(reply)) {
        if (!reply.info().valid_data || reply->request != request_) continue;
        const auto bytes = dds::view(reply->text);
        said.assign(bytes.begin(), bytes.end());
      }
      return said != "no reply";
    });
    return said;
  }

 private:
  static constexpr std::uint64_t kClient = 4711;
  std::uint64_t request_ = 0;
  dds::Participant participant_;
  dds::Topic<wire::Query> query_topic_;
  dds::Topic<wire::Reply> reply_topic_;
  dds::Reader<wire::Reply> reader_;
  dds::Writer<wire::Query> writer_;
};

// DDS lets an asker into the partition of askers; what is sent there is up to him.
TEST_F(ServerWithKeys, ACommandInAQuestionsPlaceIsRefused) {
  start_with_keys();
  RawClient client(domain_, folders_.of("planner", {KeyRole::asker}), "ask");
  EXPECT_EQ(client.ask(wire_contract::QuestionKind::hello), "");
  const std::string listed = client.ask(wire_contract::QuestionKind::command, R"({"command":"list"})");
  EXPECT_TRUE(says(listed, "warehouse")) << listed;
  for (const char* command : {R"({"command":"clear"})", R"({"command":"upload","file":"x","bytes":1,"checksum":0})",
                              R"({"command":"recording","last_s":0})", R"({"command":"sampled"})"}) {
    const std::string refused = client.ask(wire_contract::QuestionKind::command, command);
    EXPECT_TRUE(says(refused, "the keys give no right")) << command << ": " << refused;
  }
  EXPECT_TRUE(says(client.ask(wire_contract::QuestionKind::command, R"({"command":"list"})"), "warehouse"));
}

TEST_F(ServerWithKeys, AQuestionInAGreetingsPlaceIsRefused) {
  start_with_keys();
  RawClient client(domain_, folders_.of("screen", {KeyRole::watcher}), "greet");
  EXPECT_EQ(client.ask(wire_contract::QuestionKind::hello), "");
  EXPECT_TRUE(says(client.ask(wire_contract::QuestionKind::ray), "no right to ask questions"));
  EXPECT_TRUE(says(client.ask(wire_contract::QuestionKind::command, R"({"command":"list"})"), "no right to ask"));
}

TEST_F(ServerWithKeys, TheVerbMakesFoldersAndPrintsNoKey) {
  const std::string dir = folder_.path() + "/keys";
  std::string printed;
  const auto keys = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "keys");
    words.insert(words.end(), {"--dir", dir});
    const Ended ended = collide("", words);
    printed += ended.output + ended.errors;
    return ended.code;
  };
  EXPECT_EQ(keys({"add", "brain", "--role", "server"}), 2) << "no authority yet";
  EXPECT_EQ(keys({"init"}), 0);
  EXPECT_EQ(keys({"init"}), 2) << "never over another";
  EXPECT_EQ(keys({"add", "brain", "--role", "server"}), 0);
  EXPECT_EQ(keys({"add", "robot7", "--role", "publisher,watcher", "--objects", "robot7/*", "--days", "7"}), 0);
  EXPECT_EQ(keys({"add", "x", "--role", "king"}), 2);
  EXPECT_EQ(keys({"check"}), 0);
  std::filesystem::remove(dir + "/robot7/key.pem");
  EXPECT_EQ(keys({"check"}), 1);
  EXPECT_EQ(keys({"revoke", "robot7"}), 0);
  EXPECT_EQ(keys({"revoke", "nobody"}), 2);
  EXPECT_FALSE(says(printed, "PRIVATE")) << printed;
  EXPECT_TRUE(says(printed, dir + "/robot7/key.pem: No such file")) << printed;
  start({"--keys", dir + "/brain"});
}

TEST_F(ServerWithKeys, WhoHasNoneFindsNoServer) {
  start_with_keys();
  EXPECT_EQ(collide("", {"status", "--wait", "1s"}).code, 4);
  const test::KeyFolders others;
  EXPECT_EQ(collide(others.of("boss", {KeyRole::admin}), {"status", "--wait", "1s"}).code, 4);
}

/// A server and a client that watches, and a stranger that sends to both.
class AStranger : public ServerWithKeys {
 protected:
  AStranger()
      : server_(start_with_keys()),
        watch_({COLLIDED_CLI, "--domain", std::to_string(domain_), "--keys", folders_.of("screen", {KeyRole::watcher}),
                "watch"},
               folder_.path(), "watch") {
    EXPECT_TRUE(test::eventually([&] { return !test::udp_ports(watch_.pid()).empty(); }, 10s));
    std::vector<int> ports = test::udp_ports(server_.pid());
    for (const int port : test::udp_ports(watch_.pid())) ports.push_back(port);
    stranger_ = std::make_unique<test::Stranger>(domain_, strangers_.of("stranger", {KeyRole::watcher}), ports);
  }
  void expect_all_live() {
    EXPECT_EQ(server_.wait(0ms), -1) << "the server has ended";
    EXPECT_EQ(watch_.wait(0ms), -1) << "the client has ended";
    EXPECT_EQ(collide(folders_.of("planner", {KeyRole::asker}), {"ray", "0", "0", "5", "0", "0", "-1"}).code, 0);
  }

  ChildProcess& server_;
  ChildProcess watch_;
  test::KeyFolders strangers_;
  std::unique_ptr<test::Stranger> stranger_;
};

// Cyclone 0.10 reads the sample of a message that has none.
TEST_F(AStranger, EndsNobodyByAMessageThatIsAKey) {
  ASSERT_EQ(stranger_->met(2).size(), 2U);
  const test::Bytes key_only{0, 1, 0, 0, 0, 0, 0, 0};
  const test::Bytes keyhash{0x70, 0, 16, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 1, 0, 0, 0};
  for (std::uint32_t i = 1; i <= 6; ++i) {
    stranger_->send_from(stranger_->prefix(),
                         test::data_submessage(test::Stranger::kHandshakeReader, test::Stranger::kHandshakeWriter,
                                               1'000 + i, i % 2 == 0 ? 0x03 : 0x09, i % 2 == 0 ? keyhash : key_only));
    std::this_thread::sleep_for(100ms);
  }
  expect_all_live();
}

// A handshake that is asked for before the identity has been looked at, which then is refused, leaves Cyclone without the
// text whose length it takes.
TEST_F(AStranger, EndsNobodyByAHandshakeWithAnIdentityThatIsRefused) {
  const std::set<test::Prefix> others = stranger_->met(2);
  ASSERT_EQ(others.size(), 2U);
  test::Bytes announcement = stranger_->announcement();
  constexpr std::string_view kIdentity = "DDS:Auth:PKI-DH:1.0";
  const auto identity = std::search(announcement.begin(), announcement.end(), kIdentity.begin(), kIdentity.end());
  ASSERT_NE(identity, announcement.end());
  identity[16] = '9';  // version 9.0
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round) {
    test::Prefix prefix = stranger_->prefix();
    std::generate(prefix.begin() + 6, prefix.end(), std::ref(random));
    stranger_->send(test::with_prefix(announcement, stranger_->prefix(), prefix));
    for (std::uint32_t i = 1; i <= 12; ++i) {
      for (const test::Prefix& other : others) stranger_->send_from(prefix, test::handshake_request(prefix, other, i));
      std::this_thread::sleep_for(1ms);
    }
  }
  std::this_thread::sleep_for(1500ms);
  expect_all_live();
}

// An endless lease would keep each of them, and a handshake would begin with each.
TEST_F(AStranger, KeepsNobodyOutByParticipantsThatDoNotExist) {
  constexpr std::uint32_t kEndless[] = {0x7fffffff, 0xffffffff};
  test::Bytes announcement = stranger_->announcement();
  ASSERT_FALSE(announcement.empty());
  constexpr std::uint8_t kLease[] = {2, 0, 8, 0};
  const auto lease = std::search(announcement.begin(), announcement.end(), std::begin(kLease), std::end(kLease));
  ASSERT_NE(lease, announcement.end());
  std::memcpy(&lease[4], kEndless, sizeof kEndless);
  std::mt19937 random(1);
  for (int i = 0; i < 2'000; ++i) {
    test::Prefix prefix = stranger_->prefix();
    std::generate(prefix.begin() + 6, prefix.end(), std::ref(random));
    stranger_->send(test::with_prefix(announcement, stranger_->prefix(), prefix));
    if (i % 10 == 0) std::this_thread::sleep_for(5ms);
  }
  EXPECT_TRUE(test::eventually([&] { return says(server_.errors(), "Announcements ignored so far"); }))
      << server_.errors();
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(collide(folders_.of("planner", {KeyRole::asker}), {"status", "--wait", "18s"}).code, 0);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 18s);
}

/// Speaks for the publisher while others join with keys, which takes them about as long as a silent one has objects.
std::jthread keep_alive(Publisher& publisher) {
  return std::jthread([&publisher](const std::stop_token& stop) {
    for (; !stop.stop_requested(); std::this_thread::sleep_for(50ms)) static_cast<void>(publisher.keep_alive());
  });
}

TEST_F(ServerWithKeys, APublisherPublishesItsOwnNamesOnly) {
  ChildProcess& server = start_with_keys();
  const std::string admin = folders_.of("boss", {KeyRole::admin});
  Client client = connect(folders_.of("robot7", {KeyRole::publisher}, {"robot7/*"}));
  Result<Publisher> publisher = client.publish("arm");
  ASSERT_TRUE(publisher) << publisher.error().message;
  const Shape ball{SphereShape{.radius_m = 0.1}};
  ASSERT_TRUE(publisher->add({.name = "robot7/hand", .shape = ball}));
  ASSERT_TRUE(publisher->add({.name = "robot8/hand", .shape = ball}));
  ASSERT_TRUE(publisher->flush());
  {
    const std::jthread alive = keep_alive(*publisher);
    EXPECT_TRUE(test::eventually([&] { return collide(admin, {"get", "robot7/hand"}).code == 0; }, 10s));
  }
  const Result<void> applied = publisher->wait_applied(10s);
  ASSERT_FALSE(applied);
  EXPECT_EQ(applied.error().message, "object 'robot8/hand' is not in the world: the keys of 'robot7' are for robot7/*");
  EXPECT_NE(collide(admin, {"get", "robot8/hand"}).code, 0);
  EXPECT_TRUE(test::eventually([&] {
    return says(server.errors(), "object 'robot8/hand' of publisher 'arm' refused: the keys of 'robot7'");
  })) << server.errors();
}

TEST_F(ServerWithKeys, CommandsReachTheNamesOfTheirKeysOnly) {
  start_with_keys();
  const std::string boss = folders_.of("boss", {KeyRole::admin});
  const std::string cell = folders_.of("cell", {KeyRole::admin}, {"cell/*"});
  const auto add = [&](const std::string& keys, const std::string& name) {
    return collide(keys, {"add", name, "sphere", "0.1", "--at", "9", "9", "9"});
  };
  EXPECT_EQ(add(cell, "cell/a").code, 0);
  EXPECT_EQ(add(boss, "other").code, 0);
  const Ended refused = add(cell, "b");
  EXPECT_EQ(refused.code, 5);
  EXPECT_TRUE(says(refused.errors, "the keys of 'cell' are for cell/*")) << refused.errors;
  EXPECT_EQ(collide(cell, {"move", "other", "1", "1", "1"}).code, 5);
  EXPECT_EQ(collide(cell, {"rm", "*"}).code, 5);
  EXPECT_EQ(collide(cell, {"clear", "warehouse"}).code, 5);
  EXPECT_EQ(collide(boss, {"get", "other"}).code, 0) << "nothing of all that was done";
  EXPECT_EQ(collide(cell, {"rm", "cell/*"}).code, 0);
}

// What a file brings, and what goes, is looked at name by name; nothing of a refused load or scene is done.
TEST_F(ServerWithKeys, LoadsUploadsAndClearingReachTheNamesOfTheirKeysOnly) {
  start_with_keys();
  const std::string boss = folders_.of("boss", {KeyRole::admin});
  const std::string cell = folders_.of("cell", {KeyRole::admin}, {"cell/*", "arm/*"});
  const std::string file = folder_.write("a.obj", "o floor\nv 50 0 0\nv 51 0 0\nv 50 1 0\nf 1 2 3\n");
  const auto loads = [&](const std::string& keys, const std::string& name, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"load", file, "--name", name});
    return collide(keys, more);
  };
  const auto is_there = [&](const std::string& name) { return collide(boss, {"get", name}).code == 0; };
  const Ended foreign = loads(cell, "hall");
  EXPECT_EQ(foreign.code, 5);
  EXPECT_TRUE(says(foreign.errors, "the keys of 'cell' are not for object 'hall/floor'. Nothing was loaded"))
      << foreign.errors;
  EXPECT_FALSE(is_there("hall/floor"));
  EXPECT_EQ(loads(cell, "cell").code, 0);
  EXPECT_EQ(loads(cell, "arm", {"--upload"}).code, 0);
  EXPECT_EQ(loads(cell, "hall", {"--upload"}).code, 5);
  EXPECT_EQ(loads(cell, "cell", {"--replace"}).code, 0);
  const Ended covering = loads(cell, "cell", {"--replace", "--covers", "-99,-99,-99:99,99,99"});
  EXPECT_TRUE(says(covering.errors, "covers are said of the whole world")) << covering.errors;
  EXPECT_TRUE(is_there("cell/floor"));
  EXPECT_EQ(loads(boss, "hall").code, 0);
  EXPECT_EQ(loads(cell, "hall", {"--replace"}).code, 5);
  EXPECT_TRUE(is_there("hall/floor"));
  EXPECT_EQ(collide(boss, {"add", "other", "sphere", "0.1", "--at", "9", "9", "9"}).code, 0);
  EXPECT_EQ(collide(cell, {"add", "cell/b", "sphere", "0.1", "--at", "9", "9", "8"}).code, 0);
  EXPECT_EQ(collide(cell, {"clear", "hall"}).code, 5);
  EXPECT_EQ(collide(cell, {"clear", "arm"}).code, 0);
  EXPECT_FALSE(is_there("arm/floor"));
  const Ended cleared = collide(cell, {"clear"});
  EXPECT_EQ(cleared.code, 0) << cleared.errors;
  for (const char* kept : {"hall/floor", "other", "warehouse/floor"}) EXPECT_TRUE(is_there(kept)) << kept;
  for (const char* gone : {"cell/floor", "cell/b"}) EXPECT_FALSE(is_there(gone)) << gone;
}

TEST_F(ServerWithKeys, HighImportanceIsARight) {
  start_with_keys();
  const std::vector<std::string> ray{"ray", "0", "0", "5", "0", "0", "-1", "--importance", "high"};
  EXPECT_EQ(collide(folders_.of("boss", {KeyRole::admin}), ray).code, 0);
  const Ended refused = collide(folders_.of("planner", {KeyRole::asker}), ray);
  EXPECT_EQ(refused.code, 5);
  EXPECT_TRUE(says(refused.errors, "high importance")) << refused.errors;
}

TEST_F(ServerWithKeys, RevokingThrowsOutWhoIsThere) {
  ChildProcess& server = start_with_keys();
  const std::string admin = folders_.of("boss", {KeyRole::admin});
  const std::string robot = folders_.of("robot7", {KeyRole::publisher});
  const std::string kept = folder_.path() + "/kept";
  std::filesystem::copy(robot, kept);
  Client client = connect(kept);
  Result<Publisher> publisher = client.publish("arm");
  ASSERT_TRUE(publisher) << publisher.error().message;
  ASSERT_TRUE(publisher->add({.name = "hand", .shape = {SphereShape{.radius_m = 0.1}}}));
  ASSERT_TRUE(publisher->flush());
  {
    const std::jthread alive = keep_alive(*publisher);
    ASSERT_TRUE(test::eventually([&] { return collide(admin, {"get", "hand"}).code == 0; }, 10s));
  }
  folders_.authority().revoke("robot7");
  EXPECT_TRUE(test::eventually(
      [&] {
        static_cast<void>(publisher->keep_alive());
        return says(server.errors(), "publisher 'arm' is lost");
      },
      10s))
      << server.errors();
  // It goes on, and nobody listens: what it left leaves as what any lost publisher left.
  EXPECT_TRUE(test::eventually(
      [&] {
        static_cast<void>(publisher->keep_alive());
        return collide(admin, {"get", "hand"}).code != 0;
      },
      20s))
      << server.errors();
  EXPECT_EQ(collide(kept, {"status", "--wait", "2s"}).code, 4) << "nor can anybody join with them again";
}

TEST_F(ServerWithKeys, ExpiredKeysAreNoGoodEvenWhereTheClockIsWrong) {
  start_with_keys();
  const std::string folder = folders_.of("boss", {KeyRole::admin});
  const std::string secrets = folders_.path() + "/authority/";
  const keys::KeyPair authority{keys::read_key_file(secrets + "identity_ca.pem"),
                                keys::read_key_file(secrets + "identity_key.pem")};
  const auto set_end = [&](std::int64_t from_now_s) {
    const keys::KeyPair made = keys::make_member(authority, "boss", std::time(nullptr) + from_now_s);
    std::filesystem::remove(folder + "/key.pem");
    std::ofstream(folder + "/certificate.pem", std::ios::trunc) << made.certificate;
    std::ofstream(folder + "/key.pem") << made.key;
    std::filesystem::permissions(folder + "/key.pem", std::filesystem::perms::owner_read);
  };
  const std::int64_t back_ns = -1'800'000'000'000;
  std::ofstream(folder_.path() + "/shift", std::ios::binary)
      .write(reinterpret_cast<const char*>(&back_ns), sizeof back_ns);
  const std::vector<std::string> half_an_hour_ago{"/usr/bin/env", "LD_PRELOAD=" COLLIDED_SHIFTED_CLOCK,
                                                  "COLLIDED_CLOCK_SHIFT=" + folder_.path() + "/shift"};
  set_end(600);
  EXPECT_EQ(collide(folder, {"status"}, half_an_hour_ago).code, 0) << "the clock alone does no harm";
  set_end(-600);
  EXPECT_EQ(collide(folder, {"status", "--wait", "2s"}, half_an_hour_ago).code, 4);
  const Ended said = collide(folder, {"status"});
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(says(said.errors, folder + "/certificate.pem: expired on")) << said.errors;
}

TEST_F(ServerWithKeys, AServerThatCannotUseItsKeysSaysWhyAndEnds) {
  const auto ends_with = [&](const std::vector<std::string>& options, const std::string& part) {
    std::vector<std::string> all{"--domain", std::to_string(domain_), "--state-dir", folder_.path()};
    all.insert(all.end(), options.begin(), options.end());
    const Ended ended = run(all);
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(says(ended.errors, part)) << ended.errors;
  };
  ends_with({"--keys", "/nowhere"}, "'/nowhere' is no folder");
  ends_with({"--keys", folders_.of("planner", {KeyRole::asker})}, "do not give the right to it");
  const std::string broken = folders_.of("brain", {KeyRole::server});
  std::filesystem::remove(broken + "/governance.p7s");
  ends_with({"--keys", broken}, broken + "/governance.p7s: No such file");
  // Before it finds that there is no such interface.
  ends_with({"--interface", "nosuch0"}, "interface 'nosuch0' without keys");
}

}  // namespace
}  // namespace collided
