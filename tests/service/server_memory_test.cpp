// What becomes of a server in which a thread finds no memory.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/service/server_fixture.hpp"
#include "tests/service/server_wire_asker.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

#ifdef COLLIDED_NO_MEMORY
class ServerMemory : public testing_support::ServerTest {
 protected:
  void SetUp() override {
    path_ = folder_.write("starved", std::string(16, '\0'));
    const int file = open(path_.c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_GE(file, 0);
    name_ = static_cast<char*>(mmap(nullptr, 16, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0));
    close(file);
    ASSERT_NE(static_cast<void*>(name_), MAP_FAILED);
  }
  void TearDown() override { munmap(name_, 16); }
  std::unique_ptr<testing_support::ChildProcess> start_starvable(const std::vector<std::string>& options = {},
                                                                 std::size_t from_bytes = 0) {
    std::vector<std::string> words{"/usr/bin/env",
                                   "LD_PRELOAD=" COLLIDED_NO_MEMORY,
                                   "COLLIDED_NO_MEMORY=" + path_,
                                   "COLLIDED_NO_MEMORY_FROM=" + std::to_string(from_bytes),
                                   COLLIDED_SERVER,
                                   "--domain",
                                   std::to_string(domain_),
                                   "--state-dir",
                                   folder_.path()};
    words.insert(words.end(), options.begin(), options.end());
    auto server = std::make_unique<testing_support::ChildProcess>(words, folder_.path(), "starvable");
    EXPECT_TRUE(server->says("ready:", 20s)) << server->errors();
    return server;
  }
  /// Threads of that name find no memory; "": all do.
  void starve(const char* name) { std::strncpy(name_, name, 16); }

 private:
  std::string path_;
  char* name_ = nullptr;
};

// A change that is half done cannot be taken back, so the process ends and says why; the next one has what commands had
// added, and calls nothing a miss until its publisher is back.
TEST_F(ServerMemory, WithoutItInTheWorldsThreadTheServerEndsInALineAndTheNextOneRecovers) {
  const std::unique_ptr<testing_support::ChildProcess> server = start_starvable();
  Client client = connect();
  const json crate{{"name", "crate"}, {"pose", {3, 3, 9, 1, 0, 0, 0}}};
  ASSERT_TRUE(client.command("add", crate.dump(), {BoxShape{.half_m = {0.2, 0.2, 0.2}}}));
  Publisher publisher = publish(client, "thrower");
  add_ball(publisher, "ball", at(6, 0, 1));
  ASSERT_TRUE(publisher.wait_applied(20s));
  starve("world");
  const json box{{"name", "box"}, {"pose", {9, 3, 9, 1, 0, 0, 0}}};
  EXPECT_FALSE(client.command("add", box.dump(), {BoxShape{.half_m = {0.2, 0.2, 0.2}}}, 1s));
  EXPECT_EQ(server->wait(5s), 71) << server->errors();
  EXPECT_NE(server->errors().find("error: no memory left for the world's thread; ending"), std::string::npos)
      << server->errors();
  starve("");
  start({}, "next");
  Client other = connect();
  EXPECT_EQ(other.ask(RayQuestion{.origin = {15, 15, 1}, .direction = {0, 0, 1}})->reason, UndecidedReason::recovering);
  const auto until = std::chrono::steady_clock::now() + 15s;
  while (std::chrono::steady_clock::now() < until && !(other.status() && other.status()->state == "ready")) {
    EXPECT_TRUE(publisher.keep_alive());
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_EQ(other.ask(RayQuestion{.origin = {3, 3, 12}, .direction = {0, 0, -1}})->hits.at(0).object, "crate");
  EXPECT_EQ(other.ask(RayQuestion{.origin = {6, 0, 5}, .direction = {0, 0, -1}})->hits.at(0).object, "ball");
  EXPECT_EQ(other.ask(RayQuestion{.origin = {15, 15, 1}, .direction = {0, 0, 1}})->verdict, Verdict::miss);
}

// DDS aborts where it gets none, and says nothing.
TEST_F(ServerMemory, AnAbortIsReportedInALine) {
  testing_support::ChildProcess& server = start();
  server.signal(SIGABRT);
  EXPECT_EQ(server.wait(5s), 128 + SIGABRT);
  EXPECT_NE(server.errors().find("error: ended by abort(), which DDS calls where it gets no memory"), std::string::npos)
      << server.errors();
}

// A file that clients sent is read again after a crash. One that found no memory then is told as a loss, and kept for a
// start that does.
TEST_F(ServerMemory, AnUploadThatFindsNoneAtOneStartIsThereAtTheNext) {
  start({}, "first");
  {
    Client client = connect();
    const std::string_view hall = "v 50 0 0\nv 51 0 0\nv 50 1 0\nf 1 2 3\n";
    ASSERT_TRUE(client.upload(std::as_bytes(std::span(hall)), "hall.obj"));
  }
  servers_.back()->signal(SIGKILL);
  servers_.back()->wait(5s);
  const auto becomes = [](Client& client, const std::string& state) {
    return test::eventually([&] { return client.status() && client.status()->state == state; }, 15s);
  };
  const RayQuestion down{.origin = {50.2, 0.2, 12}, .direction = {0, 0, -1}};
  starve("loads");
  {
    const std::unique_ptr<testing_support::ChildProcess> short_of_it = start_starvable({}, 1 << 16);
    Client client = connect();
    const auto losses = [&] {
      const Result<std::string> answer = client.command("accept_loss", R"({"show": true})");
      return answer ? json::parse(*answer)["losses"] : json::array();
    };
    ASSERT_TRUE(test::eventually([&] { return !losses().empty(); }, 15s)) << short_of_it->errors();
    EXPECT_NE(losses()[0].get<std::string>().find("not enough memory"), std::string::npos) << losses();
    EXPECT_TRUE(becomes(client, "recovering"));
    EXPECT_EQ(client.ask(down)->reason, UndecidedReason::recovering);
    short_of_it->signal(SIGKILL);
    short_of_it->wait(5s);
  }
  starve("");
  start({}, "third");
  Client client = connect();
  EXPECT_TRUE(becomes(client, "ready"));
  EXPECT_EQ(client.ask(down)->verdict, Verdict::hit);
}

// The flight recorder lets go of what it would have recorded, and records again once it can.
TEST_F(ServerMemory, WithoutItInTheRecordersThreadTheServerServesOn) {
  const std::unique_ptr<testing_support::ChildProcess> server = start_starvable({"--flight-recorder", "1s"});
  Client client = connect();
  const auto ask_for = [&](std::chrono::milliseconds time) {
    const auto until = std::chrono::steady_clock::now() + time;
    while (std::chrono::steady_clock::now() < until)
      ASSERT_TRUE(client.ask(RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}}));
  };
  starve("recorder");
  ask_for(1s);
  EXPECT_EQ(server->wait(0s), -1) << server->errors();
  starve("");
  ask_for(300ms);
  const Result<std::string> recording = client.command("recording", R"({"last_s": 1})");
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_GT(json::parse(*recording)["messages"].get<int>(), 100);
}

// Messages of nearly a megabyte in one column after the other, each of which DDS and the server would like to keep room for.
TEST_F(ServerMemory, TwoHundredMegabytesAreEnoughForTheLargestMessages) {
  testing_support::ChildProcess server({"/bin/sh", "-c", "ulimit -d 204800; exec \"$0\" \"$@\"", COLLIDED_SERVER,
                                        "--domain", std::to_string(domain_), "--state-dir", folder_.path()},
                                       folder_.path(), "limited");
  ASSERT_TRUE(server.says("ready:", 20s)) << server.errors();
  testing_support::WireAsker asker(domain_, 0x1234, domain_ + 1'000);
  ASSERT_TRUE(asker.greet());
  const std::vector<double> numbers(110'000, 0.5);
  using Column = dds_sequence_double wire::Query::*;
  constexpr std::array<Column, 8> kColumns{
      &wire::Query::points,     &wire::Query::directions,   &wire::Query::lengths,    &wire::Query::radii,
      &wire::Query::half_sizes, &wire::Query::orientations, &wire::Query::end_points, &wire::Query::end_orientations};
  for (std::uint32_t i = 0; i < 1'500; ++i) {
    wire::Query query{};
    query.kind = static_cast<std::uint8_t>(i % 9);
    query.mask = 1;
    query.max_hits = 1;
    const std::uint32_t count = 1'000 + i * 7'919 % 109'000;
    query.*kColumns[i % kColumns.size()] = {count, count, const_cast<double*>(numbers.data()), false};
    if (i % 9 == 0)
      query.blob = {count * 8, count * 8, reinterpret_cast<std::uint8_t*>(const_cast<double*>(numbers.data())), false};
    if (i % 9 == 0) query.*kColumns[i % kColumns.size()] = {};
    asker.send(query);
    if (i % 100 == 0) asker.forget_replies();
  }
  Client client = connect();
  EXPECT_EQ(client.ask(RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}})->verdict, Verdict::hit);
  EXPECT_EQ(server.wait(0s), -1) << server.errors();
}

// Threads that answer hold nothing but the question at hand: it is refused, and the next one is answered.
TEST_F(ServerMemory, WithoutItInTheThreadsThatAnswerQuestionsAreRefused) {
  const std::unique_ptr<testing_support::ChildProcess> server = start_starvable();
  Client client = connect();
  const std::vector<RayQuestion> rays(5'000, RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}});
  starve("answer");
  const Result<Answers> refused = client.ask(std::span(rays), {.timeout = 3s});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::refused) << refused.error().message;
  EXPECT_NE(refused.error().message.find("memory"), std::string::npos) << refused.error().message;
  starve("");
  const Result<Answers> answered = client.ask(std::span(rays));
  ASSERT_TRUE(answered) << answered.error().message;
  EXPECT_EQ(answered->answers.at(4'999).verdict, Verdict::hit);
}
#endif

}  // namespace
}  // namespace collided
