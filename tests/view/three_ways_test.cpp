#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <thread>

#include <nlohmann/json.hpp>
#include <zlib.h>

#include "collided/client.hpp"
#include "idl/base64.hpp"
#include "tests/service/child_process.hpp"
#include "tests/view/loud_client.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using test::LoudClient;

constexpr auto kWait = 60s;  // for programs on a busy machine

std::string unpacked(const std::string& base64) {
  const std::string packed = decode_base64(base64).value_or("");
  for (uLongf size = 16 * packed.size() + 1024;; size *= 4) {
    std::string bytes(size, '\0');
    const int failed = ::uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                                    reinterpret_cast<const Bytef*>(packed.data()), packed.size());
    if (failed == Z_BUF_ERROR) continue;
    bytes.resize(failed == Z_OK ? size : 0);
    return bytes;
  }
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number number{};
  if (at + sizeof(number) <= bytes.size()) std::memcpy(&number, bytes.data() + at, sizeof(number));
  return number;
}

/// The state that a page shows at last, by the messages that it gets, without the numbers that differ from run to run.
struct ShownAtLast {
  json objects, standing;
  std::map<std::string, std::string> contained;  // by pair, what holds
  std::string poses;

  void hear(const json& message) {
    const std::string type = message.value("type", "");
    if (type == "standing") standing = message["standing"];
    if (type == "contacts") contained.clear();
    for (const char* list : {"contacts", "events"}) {
      const json listed = message.value(list, json::array());
      if (!listed.is_array()) continue;  // a status counts them
      for (const json& event : listed) {
        const std::string pair = event.value("a", "") + " " + event.value("b", "");
        if (event.value("what", "") == "ended") contained.erase(pair);
        else contained[pair] = event.value("contained", "");
      }
    }
  }
  /// The objects by name; of surfaces how many triangles they show, since their numbers differ.
  json by_name() const {
    std::map<std::uint32_t, json> placed;
    const std::size_t count = number_at<std::uint32_t>(poses, 4);
    for (std::size_t i = 0; i < count; ++i) {
      json pose = json::array();
      for (std::size_t k = 0; k < 7; ++k) {
        const double origin = k < 3 ? number_at<double>(poses, 32 + 8 * k) : 0;
        pose.push_back(origin + static_cast<double>(number_at<float>(poses, 56 + 28 * i + 4 * k)));
      }
      placed[number_at<std::uint32_t>(poses, 56 + 28 * count + 4 * i)] = pose;
    }
    json named = json::object();
    for (json object : objects["objects"]) {
      std::uint64_t triangles = 0;
      for (const json& run : object["runs"]) triangles += run[2].get<std::uint64_t>();
      object["runs"] = triangles;
      const auto moved = placed.find(object["slot"].get<std::uint32_t>());
      if (moved != placed.end()) object["pose"] = moved->second;
      object.erase("slot");
      named[object["name"].get<std::string>()] = object;
    }
    return named;
  }
};

ShownAtLast at_end_of(const json& run) {
  ShownAtLast shown;
  for (const json& message : run["messages"]) {
    const std::string kind = message["kind"];
    const std::string data = message["data"];
    if (kind == "text") shown.hear(json::parse(data));
    else if (kind == "objects") shown.objects = json::parse(unpacked(data));
    else shown.poses = unpacked(data);
  }
  return shown;
}

/// The messages of a WebSocket stream, without the one that is not whole yet: whether each is text, and its bytes.
std::vector<std::pair<bool, std::string>> messages_in(const std::string& stream) {
  std::vector<std::pair<bool, std::string>> messages;
  std::size_t at = stream.find("\r\n\r\n");
  at = at == std::string::npos ? stream.size() : at + 4;
  bool begins = true;
  while (at + 2 <= stream.size()) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(i < stream.size() ? stream[i] : 0); };
    const unsigned first = byte(at);
    std::size_t size = byte(at + 1);
    const std::size_t wide = size == 126 ? 2 : size == 127 ? 8 : 0;
    if (wide > 0) size = 0;
    for (std::size_t i = 0; i < wide; ++i) size = size << 8 | byte(at + 2 + i);
    at += 2 + wide;
    if (at + size > stream.size()) break;
    if (begins) messages.emplace_back((first & 0x0f) == 1, "");
    messages.back().second += stream.substr(at, size);
    begins = (first & 0x80) != 0;
    at += size;
  }
  if (!begins) messages.pop_back();
  return messages;
}

class ThreeWays : public testing::Test {
 protected:
  void SetUp() override {
    server.emplace(std::vector<std::string>{COLLIDED_SERVER, "--domain", domain, "--state-dir", folder.path()},
                   folder.path(), "server");
    ASSERT_TRUE(server->says("ready:", kWait)) << server->errors();
    viewer.emplace(std::vector<std::string>{COLLIDED_CLI, "view", "--port", "0", "--plain", "--domain", domain},
                   folder.path(), "viewer");
    ASSERT_TRUE(viewer->says("ws://", kWait)) << viewer->errors();
    const std::string said = viewer->output();
    port = static_cast<std::uint16_t>(std::stoul(said.substr(said.find(':', said.find("ws://") + 5) + 1)));
    host = "127.0.0.1:" + std::to_string(port);
    Result<Client> connected = Client::connect({.domain = testing_support::own_domain(), .wait = kWait});
    ASSERT_TRUE(connected) << connected.error().message;
    client.emplace(std::move(*connected));
  }
  void run(std::vector<std::string> words, int expected = 0) const {
    words.insert(words.begin(), COLLIDED_CLI);
    words.insert(words.end(), {"--domain", domain});
    testing_support::ChildProcess process(words, folder.path(), "command");
    EXPECT_EQ(process.wait(kWait), expected) << words[1] << ": " << process.errors();
  }
  static std::string contents(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// The body of an answer; its connection ends with it.
  std::string body_of(const std::string& request) const {
    const LoudClient one(port);
    EXPECT_TRUE(one.send(request));
    const std::string answer = one.read_until("no answer has this text", kWait);
    EXPECT_EQ(answer.substr(0, 12), "HTTP/1.1 200") << answer.substr(0, 400);
    return answer.substr(answer.find("\r\n\r\n") + 4);
  }
  /// Records from before the changes until a text that they cause is in the file.
  std::string recorded(const std::function<void()>& change, const std::string& last) {
    const std::string path = folder.path() + "/run.mcap";
    testing_support::ChildProcess recorder({COLLIDED_CLI, "record", path, "--for", "10min", "--domain", domain},
                                           folder.path(), "recorder");
    const auto until = std::chrono::steady_clock::now() + kWait;
    const auto is_missing = [&](const std::string& text) {
      return contents(path).find(text) == std::string::npos && std::chrono::steady_clock::now() < until;
    };
    // A recorder misses the first question of a client that it has not met yet.
    for (; is_missing("canary"); std::this_thread::sleep_for(20ms)) static_cast<void>(client->get("canary"));
    change();
    while (is_missing(last)) std::this_thread::sleep_for(20ms);
    recorder.signal(SIGINT);
    recorder.wait(kWait);
    return path;
  }
  ShownAtLast live() const {
    const LoudClient page(port);
    EXPECT_TRUE(page.send(LoudClient::upgrade("/live", host)));
    ShownAtLast shown;
    std::string stream;
    const auto until = std::chrono::steady_clock::now() + kWait;
    while ((shown.poses.empty() || shown.standing.is_null()) && std::chrono::steady_clock::now() < until) {
      stream += page.read_until("\"type\":\"status\"", 1s);
      shown = {};
      for (const auto& [is_text, bytes] : messages_in(stream)) {
        if (!is_text) shown.poses = bytes;
        else shown.hear(json::parse(bytes));
      }
    }
    shown.objects = json::parse(body_of(LoudClient::get("/objects", host, "Connection: close\r\n")));
    return shown;
  }
  json saved_run() const {
    const std::string path = folder.path() + "/run.html";
    run({"view", "--save", path, "--last", "2s"});
    const std::string page = contents(path);
    const std::string begin = "id=\"run\">";
    const std::size_t at = page.find(begin) + begin.size();
    return json::parse(page.substr(at, page.find("</script>", at) - at));
  }
  json opened_run(const std::string& path) const {
    const std::string bytes = contents(path);
    return json::parse(body_of("POST /recording HTTP/1.1\r\nHost: " + host +
                               "\r\nContent-Length: " + std::to_string(bytes.size()) + "\r\n\r\n" + bytes));
  }

  testing_support::ScratchFolder folder;
  const std::string domain = std::to_string(testing_support::own_domain());
  std::optional<testing_support::ChildProcess> server, viewer;
  std::optional<Client> client;
  std::uint16_t port = 0;
  std::string host;
};

Shape tetrahedron() {
  return {
      MeshShape{{{-2, -2, -2}, {4, -2, -2}, {-2, 4, -2}, {-2, -2, 4}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}};
}

TEST_F(ThreeWays, ALivePageASavedRunAndARecordingShowTheSame) {
  const auto ball = [](double radius_m) { return Shape{SphereShape{.radius_m = radius_m}}; };
  const auto put = [&](const std::string& name, const Shape& shape, double x, bool is_solid = false) {
    ObjectOptions object;
    object.name = name;
    object.shape = shape;
    object.pose.position = {x, 0, 50};
    object.solid = is_solid;
    return client->add(object);
  };
  ASSERT_TRUE(put("pod", tetrahedron(), 40, true));
  ASSERT_TRUE(put("pea", ball(0.1), 39));
  run({"fence", "add", "yard", "box", "60", "0", "50", "3", "3", "3", "--keep"});
  const std::string recording = recorded(
      [&] {
        EXPECT_TRUE(put("crate_1", ball(0.2), 50));
        EXPECT_TRUE(put("crate_2", ball(0.2), 52));
        EXPECT_FALSE(put("pea", ball(0.9), 90)) << "the name is not free";
        EXPECT_TRUE(put("scan", {VoxelShape{0.5, {0, 0, 0}, {3, 3, 1}, {0b01001111, 0}}}, 70));
        EXPECT_TRUE(put("lamp", ball(0.3), 54));
        EXPECT_TRUE(client->remove("crate_*"));
        EXPECT_TRUE(client->move("lamp", {.position = {60, 0, 50}}));
      },
      "\"object\":\"lamp\"");  // what the yard holds
  const ShownAtLast now = live();
  const ShownAtLast saved = at_end_of(saved_run());
  const json run = opened_run(recording);
  const ShownAtLast opened = at_end_of(run);
  EXPECT_EQ(run["notes"], json::array());
  const json names = now.by_name();
  for (const char* there : {"pod", "pea", "scan", "lamp"}) EXPECT_TRUE(names.contains(there)) << there;
  for (const char* gone : {"crate_1", "crate_2"}) EXPECT_FALSE(names.contains(gone)) << gone;
  EXPECT_EQ(names["pea"]["parts"][0][4], 0.1) << "the refused one is not there";
  EXPECT_EQ(names["scan"]["parts"].size(), 2U);
  EXPECT_EQ(names["lamp"]["pose"][0], 60);
  EXPECT_EQ(now.contained.size(), 1U);
  EXPECT_EQ(now.standing.size(), 1U);
  EXPECT_FALSE(now.standing[0]["holds"].empty()) << "the lamp is in the yard";
  for (const auto& [way, shown] : {std::pair("saved", &saved), std::pair("recorded", &opened)}) {
    EXPECT_EQ(json::diff(names, shown->by_name()), json::array()) << way;
    EXPECT_EQ(shown->contained, now.contained) << way;
    EXPECT_EQ(json::diff(now.standing, shown->standing), json::array()) << way;
  }
}

}  // namespace
}  // namespace collided
