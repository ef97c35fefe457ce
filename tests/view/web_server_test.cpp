#include "client/view/web_server.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <random>
#include <thread>

#include "tests/oracle/seed.hpp"
#include "tests/view/loud_client.hpp"

namespace collided::view {
namespace {

using namespace std::chrono_literals;
using test::LoudClient;

class WebServerTest : public testing::Test {
 protected:
  void start(const WebLimits& limits = {}, const RequestRules& rules = {}) {
    WebServer::Handlers handlers;
    handlers.page = [](std::string_view target) -> std::optional<WebPage> {
      if (target == "/") return WebPage{"text/html", make_bytes("a page")};
      if (target == "/large") return WebPage{"text/plain", make_bytes(std::string(32 << 20, 'x'))};
      return std::nullopt;
    };
    handlers.protocol = [](std::string_view target,
                           const std::vector<std::string>& offered) -> std::optional<std::string> {
      if (target != "/live") return std::nullopt;
      return offered.empty() ? std::string() : offered.front();
    };
    handlers.opened = [this](WebServer::Connection connection, const std::string&) {
      note([&] { open[connection] = ""; });
    };
    handlers.said = [this](WebServer::Connection connection, std::string_view message, bool) {
      note([&] { open[connection] += message; });
    };
    handlers.closed = [this](WebServer::Connection connection) {
      note([&] {
        open.erase(connection);
        ++closed;
      });
    };
    handlers.upload_target = "/recording";
    handlers.uploaded = [this](const std::string& path) -> UploadAnswer {
      note([&] { is_reading = true; });
      std::unique_lock lock(mutex);
      changed.wait_for(lock, LoudClient::kPatience, [&] { return !is_reading_held; });
      std::ifstream in(path, std::ios::binary);
      const std::string bytes((std::istreambuf_iterator<char>(in)), {});
      if (bytes.starts_with("bad")) return {.is_taken = false, .page = {"text/plain", make_bytes("it is bad")}};
      return {.is_taken = true,
              .page = {"application/json", make_bytes("{\"bytes\":" + std::to_string(bytes.size()) + "}")}};
    };
    server.emplace(WebAddress{}, rules, limits, std::move(handlers));
    server->start();
    host = "127.0.0.1:" + std::to_string(server->port());
  }
  LoudClient client() const { return LoudClient(server->port()); }
  LoudClient socket(const std::string& headers = {}) const {
    LoudClient client(server->port());
    EXPECT_TRUE(client.send(LoudClient::upgrade("/live", host, headers)));
    EXPECT_NE(client.read_until("\r\n\r\n").find("101 Switching"), std::string::npos);
    return client;
  }
  std::string asked(const std::string& request) const {
    const LoudClient one = client();
    one.send(request);
    return one.read_until("\r\n\r\n").substr(0, 12);
  }
  /// A request that uploads so many bytes, of which only the given ones follow.
  std::string upload(std::size_t bytes, const std::string& body, const std::string& headers = {}) const {
    return "POST /recording HTTP/1.1\r\nHost: " + host + "\r\n" + headers + "Content-Length: " + std::to_string(bytes) +
           "\r\n\r\n" + body;
  }
  std::string uploaded(const std::string& body, const std::string& headers = {}) const {
    const LoudClient one = client();
    one.send(upload(body.size(), body, headers));
    // The connection ends with the answer, so all of it is read.
    return one.read_until("no answer has this text");
  }
  template <class Change>
  void note(Change&& change) {
    const std::lock_guard lock(mutex);
    change();
    changed.notify_all();
  }
  template <class Condition>
  bool eventually(Condition&& condition, std::chrono::milliseconds most = LoudClient::kPatience) {
    std::unique_lock lock(mutex);
    const auto until = std::chrono::steady_clock::now() + most;
    // Counts change without a word.
    while (!condition() && std::chrono::steady_clock::now() < until) changed.wait_for(lock, 10ms);
    return condition();
  }

  std::mutex mutex;
  std::condition_variable changed;
  std::map<WebServer::Connection, std::string> open;
  std::size_t closed = 0;
  bool is_reading_held = false;  // uploaded files are read once it is false
  bool is_reading = false;       // an uploaded file was taken
  std::string host;
  std::optional<WebServer> server;
};

TEST_F(WebServerTest, ServesItsPagesAndNothingElse) {
  start();
  const LoudClient one = client();
  one.send(LoudClient::get("/", host));
  const std::string page = one.read_until("a page");
  EXPECT_EQ(page.substr(0, 15), "HTTP/1.1 200 OK");
  EXPECT_NE(page.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
  EXPECT_NE(page.find("X-Content-Type-Options: nosniff"), std::string::npos);
  one.send(LoudClient::get("/../../etc/passwd", host));
  EXPECT_EQ(one.read_until("no such page").substr(0, 12), "HTTP/1.1 404") << "on the same connection";
  EXPECT_EQ(asked("HEAD / HTTP/1.1\r\nHost: " + host + "\r\n\r\n"), "HTTP/1.1 200");
  EXPECT_EQ(asked("DELETE / HTTP/1.1\r\nHost: " + host + "\r\n\r\n"), "HTTP/1.1 405");
}

TEST_F(WebServerTest, AnotherNameOrOriginIsForbidden) {
  start({}, {.hosts = {"robot.example"}, .origins = {"https://app.example"}});
  EXPECT_EQ(asked(LoudClient::get("/", "evil.example:8765")), "HTTP/1.1 403");
  EXPECT_EQ(asked(LoudClient::get("/", "")), "HTTP/1.1 403");
  EXPECT_EQ(asked("GET / HTTP/1.1\r\n\r\n"), "HTTP/1.1 403");
  EXPECT_EQ(asked(LoudClient::get("/", "robot.example")), "HTTP/1.1 200");
  EXPECT_EQ(asked(LoudClient::get("/", "localhost:1")), "HTTP/1.1 200");
  EXPECT_EQ(asked(LoudClient::upgrade("/live", host, "Origin: http://evil.example\r\n")), "HTTP/1.1 403");
  EXPECT_EQ(asked(LoudClient::upgrade("/live", host, "Origin: null\r\n")), "HTTP/1.1 403");
  EXPECT_EQ(asked(LoudClient::upgrade("/live", host, "Origin: http://" + host + "\r\n")), "HTTP/1.1 101");
  EXPECT_EQ(asked(LoudClient::upgrade("/live", host, "Origin: https://app.example\r\n")), "HTTP/1.1 101");
  EXPECT_EQ(server->counts().forbidden, 5U);
}

// Every page, every socket: by the address that was printed, or by the cookie that its page has set.
TEST_F(WebServerTest, WithATokenNobodyIsLetInWithoutIt) {
  const std::string token = new_token();
  start({}, {.token = token});
  const std::string name = "collided_view_" + std::to_string(server->port());
  const auto cookie = [&](const std::string& value) { return "Cookie: theme=dark; " + name + '=' + value + "\r\n"; };
  const std::string kForbidden = "HTTP/1.1 403";
  std::string last_wrong = token;
  last_wrong.back() = token.back() == '0' ? '1' : '0';
  for (const std::string& wrong : {std::string(), std::string("0"), last_wrong, token + "0", token.substr(1)}) {
    EXPECT_EQ(asked(LoudClient::get("/?token=" + wrong, host)), kForbidden) << wrong;
    EXPECT_EQ(asked(LoudClient::get("/", host, cookie(wrong))), kForbidden) << wrong;
    EXPECT_EQ(asked(LoudClient::upgrade("/live?token=" + wrong, host)), kForbidden) << wrong;
    EXPECT_EQ(asked(LoudClient::upgrade("/live", host, cookie(wrong))), kForbidden) << wrong;
  }
  for (const char* path : {"/", "/large", "/nowhere", "/?x=1", "/?nottoken="})
    EXPECT_EQ(asked(LoudClient::get(path, host)), kForbidden) << path;
  EXPECT_EQ(asked(LoudClient::get("/", host, "Cookie: other=" + token + "\r\n")), kForbidden);
  EXPECT_EQ(asked("HEAD / HTTP/1.1\r\nHost: " + host + "\r\n\r\n"), kForbidden);
  EXPECT_EQ(asked(LoudClient::upgrade("/live", host)), kForbidden);
  EXPECT_EQ(server->counts().forbidden, 28U);
  EXPECT_TRUE(open.empty());

  const LoudClient one = client();
  one.send(LoudClient::get("/?x=1&token=" + token, host));
  EXPECT_EQ(one.read_until("\r\n\r\n").substr(0, 12), "HTTP/1.1 404") << "the page handler sees /?x=1";
  const LoudClient other = client();
  other.send(LoudClient::get("/?token=" + token, host));
  const std::string page = other.read_until("a page");
  EXPECT_EQ(page.substr(0, 15), "HTTP/1.1 200 OK");
  EXPECT_NE(page.find("Set-Cookie: " + name + '=' + token + "; Path=/; HttpOnly; SameSite=Strict\r\n"),
            std::string::npos)
      << page;
  EXPECT_EQ(asked(LoudClient::get("/", host, cookie(token))), "HTTP/1.1 200");
  EXPECT_EQ(asked(LoudClient::upgrade("/live", host, cookie(token))), "HTTP/1.1 101");
  EXPECT_EQ(asked(LoudClient::upgrade("/live?token=" + token, host)), "HTTP/1.1 101");
  EXPECT_EQ(asked(LoudClient::upgrade("/live?token=" + token, host, "Origin: http://evil.example\r\n")), kForbidden);
}

TEST_F(WebServerTest, TokensDifferAndAreLong) {
  EXPECT_EQ(new_token().size(), 32U);
  EXPECT_NE(new_token(), new_token());
  EXPECT_TRUE(is_loopback({.address = "127.0.0.1"}));
  EXPECT_TRUE(is_loopback({.address = "::1"}));
  for (const char* reachable : {"0.0.0.0", "::", "10.0.0.1", "nowhere", "::ffff:127.0.0.1"})
    EXPECT_FALSE(is_loopback({.address = reachable})) << reachable;
}

TEST_F(WebServerTest, WhatIsNoRequestIsRefusedAndCounted) {
  start();
  EXPECT_EQ(asked("\x16\x03\x01 this is TLS\r\n\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(asked(LoudClient::get("/", host, "X: " + std::string(100'000, 'y') + "\r\n")), "HTTP/1.1 400");
  EXPECT_EQ(asked("POST / HTTP/1.1\r\nHost: " + host + "\r\nContent-Length: 1000000000000\r\n\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(asked(LoudClient::get("/", host, "Host: evil.example\r\n")), "HTTP/1.1 400") << "two names";
  EXPECT_EQ(server->counts().malformed, 4U);
}

TEST_F(WebServerTest, AnUploadedFileIsAnswered) {
  start();
  // Several pieces, and a last one that is not full.
  const std::string answer = uploaded(std::string(1'000'001, 'x'), "Origin: http://" + host + "\r\n");
  EXPECT_EQ(answer.substr(0, 15), "HTTP/1.1 200 OK");
  EXPECT_TRUE(answer.ends_with("{\"bytes\":1000001}")) << answer;
  EXPECT_TRUE(uploaded(std::string(2 << 18, 'x')).ends_with("{\"bytes\":524288}")) << "whole pieces";
  const std::string refused = uploaded("bad");
  EXPECT_EQ(refused.substr(0, 12), "HTTP/1.1 422");
  EXPECT_TRUE(refused.ends_with("it is bad")) << refused;
  const std::string chunks = "POST /recording HTTP/1.1\r\nHost: " + host + "\r\nTransfer-Encoding: chunked\r\n\r\n" +
                             "3\r\nabc\r\n2\r\nde\r\n0\r\n\r\n";
  const LoudClient one = client();
  one.send(chunks);
  EXPECT_NE(one.read_until("{\"bytes\":5}").find("{\"bytes\":5}"), std::string::npos);
  EXPECT_EQ(asked("POST /recording HTTP/1.1\r\nHost: " + host + "\r\nContent-Length: 0\r\n\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(asked(LoudClient::get("/recording", host)), "HTTP/1.1 404");
  EXPECT_EQ(server->counts().faults, 0U);
}

// A page of another origin may be allowed to watch; it may not send files.
TEST_F(WebServerTest, OnlyItsOwnPagesUpload) {
  const std::string token = new_token();
  start({}, {.origins = {"https://app.example"}, .token = token});
  const std::string cookie = "Cookie: collided_view_" + std::to_string(server->port()) + "=" + token + "\r\n";
  EXPECT_EQ(asked(upload(3, "abc")), "HTTP/1.1 403") << "without the token";
  EXPECT_EQ(asked(upload(3, "abc", cookie + "Origin: https://app.example\r\n")), "HTTP/1.1 403");
  EXPECT_EQ(asked(upload(3, "abc", cookie + "Origin: http://evil.example\r\n")), "HTTP/1.1 403");
  EXPECT_EQ(asked(upload(3, "abc", cookie + "Origin: http://" + host + "\r\n")), "HTTP/1.1 200");
}

TEST_F(WebServerTest, AnUploadHasASizeAndATimeAndIsTheOnlyOne) {
  start({.upload_bytes = 1 << 20, .stall = 1s});
  EXPECT_EQ(asked(upload((1 << 20) + 1, "x")), "HTTP/1.1 413") << "by its announced size";
  const std::string hidden = "POST /recording HTTP/1.1\r\nHost: " + host + "\r\nTransfer-Encoding: chunked\r\n\r\n" +
                             "200000\r\n" + std::string(2 << 20, 'x') + "\r\n0\r\n\r\n";
  EXPECT_EQ(asked(hidden), "HTTP/1.1 413") << "by its bytes";
  {
    const LoudClient broken = client();
    broken.send(upload(1'000, "cut off"));
  }
  EXPECT_TRUE(eventually([&] { return server->counts().open == 0; })) << "no place is kept by what was cut off";
  note([&] { is_reading_held = true; });
  const LoudClient first = client();
  first.send(upload(3, "abc"));
  ASSERT_TRUE(eventually([&] { return is_reading; }));
  EXPECT_EQ(asked(upload(3, "def")), "HTTP/1.1 503") << "one is read at a time";
  EXPECT_EQ(asked(LoudClient::get("/", host)), "HTTP/1.1 200") << "pages are served meanwhile";
  note([&] { is_reading_held = false; });
  EXPECT_NE(first.read_until("{\"bytes\":3}").find("200 OK"), std::string::npos);
  const LoudClient slow = client();
  slow.send(upload(1'000, "and no more"));
  EXPECT_TRUE(slow.ends());
  EXPECT_TRUE(eventually([&] { return server->counts().slow == 1; }));
  EXPECT_EQ(asked(upload(3, "abc")), "HTTP/1.1 200") << "its place is free again";
}

TEST_F(WebServerTest, AMessageGoesBothWaysInOrder) {
  start();
  std::optional<LoudClient> one(socket());
  one->send(LoudClient::frame("hello"));
  ASSERT_TRUE(eventually([&] { return open.size() == 1 && open.begin()->second == "hello"; }));
  const WebServer::Connection number = open.begin()->first;
  for (const char* word : {"one", "two", "three"}) server->send(number, {make_bytes(word), true, 0});
  const std::string heard = one->read_until("three");
  EXPECT_LT(heard.find("one"), heard.find("two"));
  EXPECT_LT(heard.find("two"), heard.find("three"));
  one->send(LoudClient::frame("", 0x88));
  one.reset();
  EXPECT_TRUE(eventually([&] { return open.empty() && closed == 1; }));
}

// Of a client that does not read, nothing piles up: frames are superseded, and with too much of the rest it is dropped.
TEST_F(WebServerTest, ASlowReaderIsDroppedAndKeepsNothing) {
  start({.waiting_messages = 8, .waiting_bytes = 1 << 20});
  const LoudClient one = socket();
  ASSERT_TRUE(eventually([&] { return open.size() == 1; }));
  const WebServer::Connection number = open.begin()->first;
  const Bytes frame = make_bytes(std::string(8 << 20, 'f'));  // more than sockets keep
  for (int i = 0; i < 100; ++i) server->send(number, {frame, false, 1});
  EXPECT_TRUE(eventually([&] { return server->counts().superseded >= 98; }));
  EXPECT_EQ(server->counts().slow, 0U) << "frames alone drop nobody";
  EXPECT_LE(frame.use_count(), 3);
  for (int i = 0; i < 20; ++i) server->send(number, {make_bytes("event"), true, 0});
  EXPECT_TRUE(eventually([&] { return server->counts().slow == 1 && open.empty(); }));
  EXPECT_TRUE(eventually([&] { return frame.use_count() == 1; }));
}

// What is being sent does not wait, however large, nor does a message with a lane count: a scene may be larger than the limit.
TEST_F(WebServerTest, ALargeMessageLeavesRoomForOthers) {
  start({.waiting_messages = 8, .waiting_bytes = 1 << 20});
  const LoudClient one = socket();
  ASSERT_TRUE(eventually([&] { return open.size() == 1; }));
  const WebServer::Connection number = open.begin()->first;
  const Bytes scene = make_bytes(std::string(8 << 20, 's'));
  server->send(number, {scene, false, 0});
  server->send(number, {scene, false, 1});
  for (int i = 0; i < 8; ++i) server->send(number, {make_bytes("event " + std::to_string(i) + ";"), true, 0});
  const std::string heard = one.read_until("event 7;");
  EXPECT_GE(heard.size(), 2 * scene->size());
  for (int i = 0; i < 8; ++i) EXPECT_NE(heard.find("event " + std::to_string(i) + ";"), std::string::npos) << i;
  EXPECT_EQ(server->counts().slow, 0U);
}

// A client has as long as a stall may last for each piece of a message, not for the whole.
TEST_F(WebServerTest, WhoTakesALargeMessageSlowlyGetsAllOfIt) {
  start({.stall = 6s});
  const LoudClient one = socket();
  ASSERT_TRUE(eventually([&] { return open.size() == 1; }));
  constexpr std::size_t kBytes = 64 << 20;
  server->send(open.begin()->first, {make_bytes(std::string(kBytes, 's')), false, 1});
  for (std::size_t taken = 0, pieces = 0; taken < kBytes; ++pieces) {
    const std::string piece = one.read_until("s");
    ASSERT_FALSE(piece.empty()) << "dropped after " << taken << " bytes";
    taken += piece.size();
    if (pieces % 32 != 0) continue;
    std::this_thread::sleep_for(300ms);
    one.send(LoudClient::frame("still here"));
  }
}

TEST_F(WebServerTest, WhoTakesNothingForTooLongIsDropped) {
  start({.stall = 1s});
  const LoudClient one = socket();
  ASSERT_TRUE(eventually([&] { return open.size() == 1; }));
  server->send(open.begin()->first, {make_bytes(std::string(32 << 20, 'f')), false, 1});
  EXPECT_TRUE(eventually([&] { return open.empty(); }));
}

TEST_F(WebServerTest, FloodsAndGiantsAreDropped) {
  start({.message_bytes = 1'000, .messages_a_second = 20});
  const LoudClient flood = socket();
  std::string many;
  for (int i = 0; i < 200; ++i) many += LoudClient::frame("x");
  flood.send(many);
  EXPECT_TRUE(flood.ends());
  EXPECT_EQ(server->counts().flooding, 1U);
  const LoudClient giant = socket();
  giant.send(LoudClient::frame(std::string(2'000, 'y')));
  EXPECT_TRUE(giant.ends());
  EXPECT_TRUE(eventually([&] { return server->counts().malformed == 1; }));
  // A length that nobody has room for, announced only.
  const LoudClient liar = socket();
  liar.send(std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff", 10) + std::string(4, '\0'));
  EXPECT_TRUE(liar.ends());
}

// Half requests, sent again as soon as they were dropped, held all places: nobody got a page.
TEST_F(WebServerTest, HalfRequestsKeepNobodyOut) {
  start({.connections = 16, .requests = 32, .first_request = 1s});
  std::vector<LoudClient> crowd;
  for (int i = 0; i < 1'000; ++i) {
    crowd.push_back(client());
    if (i % 2 == 0) crowd.back().send("GET / HTTP/1.1\r\nHost: 127");
  }
  EXPECT_EQ(asked(LoudClient::get("/", host)), "HTTP/1.1 200") << "beside all of them";
  EXPECT_TRUE(eventually([&] { return server->counts().connections == 1'001; }));
  EXPECT_GE(server->counts().full, 1'000U - 32U) << "the oldest gave way";
  EXPECT_TRUE(crowd.front().ends());
  EXPECT_TRUE(crowd.back().ends()) << "those inside are given a second";
}

TEST_F(WebServerTest, HoweverManyWatchAPageFindsAPlace) {
  start({.connections = 16});
  std::vector<LoudClient> watchers;
  for (int i = 0; i < 12; ++i) watchers.push_back(socket());
  ASSERT_TRUE(eventually([&] { return open.size() == 12; }));
  EXPECT_EQ(asked(LoudClient::upgrade("/live", host)), "HTTP/1.1 503");
  EXPECT_EQ(asked(LoudClient::get("/", host)), "HTTP/1.1 200");
  watchers.pop_back();
  ASSERT_TRUE(eventually([&] { return open.size() == 11; }));
  EXPECT_EQ(asked(LoudClient::upgrade("/live", host)), "HTTP/1.1 101");
}

// Bytes of any kind on a WebSocket and before it: none of them ends the server.
TEST_F(WebServerTest, RandomBytesDoNotEndIt) {
  start({.connections = 8, .request = 1s});
  std::mt19937_64 random = oracle::seeded(23);
  const auto noise = [&](std::size_t most) {
    std::string bytes(random() % most, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    return bytes;
  };
  for (int i = 0; i < 300; ++i) {
    const LoudClient one = client();
    std::string bytes = i % 2 == 0 ? LoudClient::upgrade("/live", host) + noise(300) : LoudClient::get("/", host);
    for (int flips = 0; i % 2 == 1 && flips < 3; ++flips) bytes[random() % bytes.size()] = static_cast<char>(random());
    one.send(bytes);
    if (i % 8 == 0) one.read_until("\r\n\r\n", 50ms);
  }
  EXPECT_TRUE(eventually([&] { return server->counts().open == 0; }));
  EXPECT_EQ(asked(LoudClient::get("/", host)), "HTTP/1.1 200");
  EXPECT_EQ(server->counts().faults, 0U);
}

TEST_F(WebServerTest, AnAddressInUseIsSaidSo) {
  start();
  try {
    const WebServer second({.address = "127.0.0.1", .port = server->port()}, {}, {}, {});
    FAIL() << "two servers on one port";
  } catch (const std::runtime_error& failed) {
    EXPECT_EQ(failed.what(), "port " + std::to_string(server->port()) + " of 127.0.0.1: Address already in use");
  }
  EXPECT_THROW(WebServer({.address = "nowhere", .port = 0}, {}, {}, {}), std::runtime_error);
}

TEST(RequestRules, HostsAreTakenApart) {
  const RequestRules rules{.hosts = {"robot.example"}, .origins = {}};
  for (const char* good : {"127.0.0.1", "127.0.0.1:8765", "LOCALHOST:1", "robot.EXAMPLE:80"})
    EXPECT_TRUE(may_be_called(good, "127.0.0.1", true, rules)) << good;
  for (const char* bad : {"", ":80", "evil.example", "127.0.0.1.evil.example", "127.0.0.1:80:80", "127.0.0.1:x",
                          "localhost@evil", "[127.0.0.1", "127.0.0.2"}) {
    EXPECT_FALSE(may_be_called(bad, "127.0.0.1", true, rules)) << bad;
  }
  EXPECT_TRUE(may_be_called("[::1]:8765", "::1", true, rules));
  EXPECT_FALSE(may_be_called("[::1]x", "::1", true, rules));
  EXPECT_FALSE(may_be_called("localhost", "192.0.2.7", false, rules)) << "only a loopback address is localhost";
}

}  // namespace
}  // namespace collided::view
