#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "client/library/connection/local_process.hpp"
#include "collided/client.hpp"
#include "tests/service/wire/fake_server.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using test::FakeServer;

const double kInf = std::numeric_limits<double>::infinity();
const double kNan = std::numeric_limits<double>::quiet_NaN();

RayQuestion ray_from(double x) { return {{x, 0, 5}, {0, 0, -1}}; }

class ClientAsk : public testing::Test {
 protected:
  void SetUp() override {
    Result<Client> connected = Client::connect(test::here());
    ASSERT_TRUE(connected) << connected.error().message;
    client_.emplace(std::move(*connected));
  }
  FakeServer server_{test::own_namespace()};
  std::optional<Client> client_;
};

TEST(ClientConnect, NobodyThereIsSaidWithinTheWait) {
  ConnectOptions options = test::here();
  options.wait = 300ms;
  const auto start = std::chrono::steady_clock::now();
  const Result<Client> client = Client::connect(options);
  const auto took = std::chrono::steady_clock::now() - start;
  ASSERT_FALSE(client);
  EXPECT_EQ(client.error().code, ErrorCode::no_server);
  EXPECT_EQ(client.error().message, "no collided answered in 300 ms on domain " + std::to_string(options.domain) +
                                        ", namespace '" + options.name_space + "'");
  EXPECT_EQ(client.error().hint, "seen on this domain: 0 participants; start a server with 'collided'");
  EXPECT_GE(took, 300ms);
  EXPECT_LE(took, 1500ms);
}

TEST(ClientConnect, ServerOfAnotherNamespaceIsSeenButNotMet) {
  const FakeServer server(test::own_namespace() + "_other");
  ConnectOptions options = test::here();
  options.wait = 500ms;
  const Result<Client> client = Client::connect(options);
  ASSERT_FALSE(client);
  EXPECT_EQ(client.error().hint, "seen on this domain: 1 participant, none of ours; start a server with 'collided'");
}

// One that is found and has no time yet is waited for longer than one that is not there.
TEST(ClientConnect, ABusyServerIsWaitedFor) {
  FakeServer server(test::own_namespace());
  server.answering = false;
  ConnectOptions options = test::here();
  options.wait = 500ms;
  std::thread later([&] {
    std::this_thread::sleep_for(1500ms);  // three times the wait; how long the server has no time is what is tested
    server.answering = true;
  });
  const auto start = std::chrono::steady_clock::now();
  const Result<Client> client = Client::connect(options);
  later.join();
  EXPECT_TRUE(client) << client.error().message;
  EXPECT_GE(std::chrono::steady_clock::now() - start, 1500ms);
}

// That it is there is said, and how long it was waited for, which is more than was asked for.
TEST(ClientConnect, AServerThatIsThereAndDoesNotAnswerIsSaidToBeThere) {
  FakeServer server(test::own_namespace());
  server.answering = false;
  ConnectOptions options = test::here();
  options.wait = 200ms;
  const auto start = std::chrono::steady_clock::now();
  const Result<Client> client = Client::connect(options);
  const auto took = std::chrono::steady_clock::now() - start;
  ASSERT_FALSE(client);
  EXPECT_EQ(client.error().code, ErrorCode::no_server);
  EXPECT_TRUE(client.error().hint.starts_with("a server is seen there")) << client.error().hint;
  EXPECT_EQ(client.error().message.find("200 ms"), std::string::npos) << client.error().message;
  EXPECT_GE(took, 9s);
}

// Variables are the process's: put back as they were.
class Variables {
 public:
  void set(const char* name, const char* value) {
    const char* const before = std::getenv(name);
    before_.emplace(name, before == nullptr ? std::optional<std::string>() : std::optional<std::string>(before));
    if (value == nullptr) ::unsetenv(name);
    else ::setenv(name, value, 1);
  }
  ~Variables() {
    for (const auto& [name, value] : before_)
      value ? ::setenv(name.c_str(), value->c_str(), 1) : ::unsetenv(name.c_str());
  }

 private:
  std::map<std::string, std::optional<std::string>> before_;
};

TEST(ClientConnect, TheEnvironmentSaysWhereToForTheLibraryAsForTheCommandLine) {
  Variables variables;
  for (const char* name : {"COLLIDED_DOMAIN", "COLLIDED_NAMESPACE", "COLLIDED_INTERFACE"}) variables.set(name, nullptr);
  variables.set("ROS_DOMAIN_ID", "7");
  EXPECT_EQ(ConnectOptions::from_environment()->domain, 7);
  EXPECT_EQ(ConnectOptions::from_environment()->name_space, "collided");
  EXPECT_EQ(ConnectOptions::from_environment()->interface, "lo");
  variables.set("COLLIDED_DOMAIN", "8");
  variables.set("COLLIDED_NAMESPACE", "lab");
  variables.set("COLLIDED_INTERFACE", "auto");
  EXPECT_EQ(ConnectOptions::from_environment()->domain, 8);
  EXPECT_EQ(ConnectOptions::from_environment()->name_space, "lab");
  EXPECT_EQ(ConnectOptions::from_environment()->interface, "auto");
  variables.set("COLLIDED_DOMAIN", "lab");
  ASSERT_FALSE(ConnectOptions::from_environment());
  EXPECT_EQ(ConnectOptions::from_environment().error().code, ErrorCode::bad_input);
  const Result<Client> client = Client::connect();
  ASSERT_FALSE(client);
  EXPECT_EQ(client.error().message, "domain 'lab': allowed 0 to 230");
}

TEST(ClientConnect, BadWordsAreRefusedBeforeAnythingStarts) {
  ConnectOptions options = test::here();
  options.name_space = "a-b";
  EXPECT_EQ(Client::connect(options).error().code, ErrorCode::bad_input);
  options = test::here();
  options.domain = 231;
  const Result<Client> client = Client::connect(options);
  ASSERT_FALSE(client);
  EXPECT_EQ(client.error().code, ErrorCode::bad_input);
  EXPECT_EQ(client.error().message, "domain 231: allowed 0 to 230");
  options = test::here();
  options.peers = {"10.0.0.2", "<evil>"};
  const Result<Client> peers = Client::connect(options);
  ASSERT_FALSE(peers);
  EXPECT_NE(peers.error().message.find("peer"), std::string::npos) << peers.error().message;
}

TEST_F(ClientAsk, SeveralClientsShareTheProcessesParticipant) {
  const Result<Client> second = Client::connect(test::here());
  ASSERT_TRUE(second) << second.error().message;
  ConnectOptions elsewhere = test::here();
  elsewhere.interface = "auto";
  const Result<Client> third = Client::connect(elsewhere);
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().code, ErrorCode::bad_input);
  EXPECT_NE(third.error().message.find("one interface"), std::string::npos) << third.error().message;
}

TEST_F(ClientAsk, SingleRayComesBackWhole) {
  const Result<Answer> answer = client_->ask(ray_from(3.25));
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->verdict, Verdict::hit);
  EXPECT_EQ(answer->reason, UndecidedReason::none);
  EXPECT_EQ(answer->cost.nodes, 12u);
  EXPECT_EQ(answer->cost.exact_tests, 2u);
  EXPECT_EQ(answer->cost.level, 1);
  ASSERT_EQ(answer->hits.size(), 1u);
  const Hit& hit = answer->hits[0];
  EXPECT_EQ(hit.object, "wall");
  EXPECT_EQ(hit.object_id, FakeServer::kWall);
  EXPECT_EQ(hit.triangle, 118u);
  EXPECT_EQ(hit.distance_m, 3.25);
  EXPECT_EQ(hit.error_m, 4.4e-16);
  EXPECT_EQ(hit.exit_m, 6.5);
  EXPECT_EQ(hit.point, Vec3(1, 2, 3));
  EXPECT_EQ(hit.normal, Vec3(0, 0, 1));
  EXPECT_EQ(hit.weights, Vec3(0.25, 0.25, 0.5));
  EXPECT_EQ(hit.point_error_m, 8.8e-16);
  EXPECT_TRUE(hit.inside);
  EXPECT_FALSE(hit.stale);
  const Result<Answer> miss = client_->ask(ray_from(-1));
  ASSERT_TRUE(miss);
  EXPECT_EQ(miss->verdict, Verdict::miss);
  EXPECT_TRUE(miss->hits.empty());
}

TEST_F(ClientAsk, EveryKindOfQuestionIsAnswered) {
  EXPECT_TRUE(client_->ask(SphereQuestion{{1, 2, 3}, 0.5}));
  EXPECT_TRUE(client_->ask(BoxQuestion{{1, 2, 3}, {1, 1, 1}}));
  EXPECT_TRUE(client_->ask(NearQuestion{{1, 2, 3}}));
  EXPECT_EQ(server_.query_chunks().size(), 3u);
}

TEST_F(ClientAsk, OptionsTravel) {
  const AskOptions options{.mode = HitMode::all,
                           .mask = 6,
                           .only = "pallet_*",
                           .skip = "pallet_0?",
                           .max_hits = 17,
                           .error_m = 1e-6,
                           .deadline = 200us,
                           .importance = Importance::high};
  ASSERT_TRUE(client_->ask(ray_from(1), options));
  const wire::Query query = server_.last_query();
  EXPECT_EQ(query.mode, static_cast<std::uint8_t>(wire_contract::HitMode::all));
  EXPECT_EQ(query.importance, static_cast<std::uint8_t>(wire_contract::Importance::high));
  EXPECT_EQ(query.mask, 6u);
  EXPECT_STREQ(query.only, "pallet_*");
  EXPECT_STREQ(query.skip, "pallet_0?");
  EXPECT_EQ(query.max_hits, 17u);
  EXPECT_EQ(query.error_asked, 1e-6);
  EXPECT_EQ(query.deadline_ns, 200'000);
  ASSERT_TRUE(client_->ask(ray_from(1)));  // the reused sample must not remember
  EXPECT_STREQ(server_.last_query().only, "");
  EXPECT_EQ(server_.last_query().mask, 0xffffffffu);
}

TEST_F(ClientAsk, HundredThousandRaysKeepTheirOrder) {
  std::vector<RayQuestion> rays;
  for (int i = 0; i < 100'000; ++i) { rays.push_back(ray_from(i % 3 == 0 ? -1 : i)); }
  const Result<Answers> answers = client_->ask(rays, {.timeout = 20s});
  ASSERT_TRUE(answers) << answers.error().message;
  ASSERT_EQ(answers->answers.size(), rays.size());
  EXPECT_EQ(answers->version, 5u);
  EXPECT_EQ(answers->epoch, 101u);
  EXPECT_FALSE(answers->oldest_pose_age.has_value());
  for (int i = 0; i < 100'000; ++i) {
    const Answer& answer = answers->answers[static_cast<std::size_t>(i)];
    ASSERT_EQ(answer.verdict, i % 3 == 0 ? Verdict::miss : Verdict::hit) << i;
    if (answer.verdict == Verdict::hit) { ASSERT_EQ(answer.hits.at(0).distance_m, i); }
  }
  const std::vector<std::uint32_t> chunks = server_.query_chunks();
  EXPECT_EQ(chunks.size(), 100u);
  EXPECT_EQ(*std::max_element(chunks.begin(), chunks.end()), wire_contract::kMaxQuestionsPerChunk);
}

// Memory that served before holds other hits, of more or fewer answers: nothing of them may show.
TEST_F(ClientAsk, AnswersInTheMemoryOfEarlierOnesAreThoseOfAFreshRequest) {
  Answers kept;
  for (const int count : {2'500, 40, 1'000, 1'001}) {
    std::vector<RayQuestion> rays;
    for (int i = 0; i < count; ++i) { rays.push_back(ray_from((i + count) % 3 == 0 ? -1 : i + 0.5)); }
    const Result<Answers> fresh = client_->ask(rays);
    Result<Answers> again = client_->ask(rays, AskOptions{}, std::move(kept));
    ASSERT_TRUE(fresh && again);
    ASSERT_EQ(again->answers.size(), rays.size());
    EXPECT_EQ(again->version, fresh->version);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Answer& a = again->answers[i];
      const Answer& b = fresh->answers[i];
      ASSERT_EQ(a.verdict, b.verdict) << i;
      ASSERT_EQ(a.hits.size(), b.hits.size()) << i;
      for (std::size_t hit = 0; hit < a.hits.size(); ++hit) {
        ASSERT_EQ(a.hits[hit].distance_m, b.hits[hit].distance_m) << i;
        ASSERT_EQ(a.hits[hit].object, b.hits[hit].object) << i;
        ASSERT_EQ(a.hits[hit].object_id, b.hits[hit].object_id) << i;
        ASSERT_EQ(a.hits[hit].triangle, b.hits[hit].triangle) << i;
      }
    }
    kept = std::move(*again);
  }
}

TEST_F(ClientAsk, NoMoreChunksAreUnderWayThanTheWindowHolds) {
  server_.delay_us = 2000;
  const std::vector<RayQuestion> rays(20'500, ray_from(1));
  const Result<Answers> answers = client_->ask(rays, {.timeout = 20s});
  ASSERT_TRUE(answers) << answers.error().message;
  EXPECT_EQ(answers->answers.size(), rays.size());
  EXPECT_EQ(server_.query_chunks().size(), 21u);
  // How soon it grows to that depends on the machine, and is tested on a clock of its own (ClientSendWindow).
  EXPECT_LE(server_.most_in_flight(), wire_contract::kChunksInFlight);
  EXPECT_GE(server_.most_in_flight(), 2U);
}

TEST_F(ClientAsk, RepeatedRepliesCountOnce) {
  const std::vector<RayQuestion> rays(5'000, ray_from(1));
  const Result<Answers> answers = client_->ask(rays, {.only = "twice"});
  ASSERT_TRUE(answers) << answers.error().message;
  EXPECT_EQ(answers->answers.back().hits.size(), 1u);
}

TEST_F(ClientAsk, RefusalCarriesReasonAndHint) {
  const Result<Answer> answer = client_->ask(ray_from(1), {.only = "refuse"});
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::refused);
  EXPECT_EQ(answer.error().message, "server refused: 'box' against 'octree' is not supported");
  EXPECT_EQ(answer.error().hint, "collide plan");
}

// A server that has no room says when to ask again: that is done within the timeout, and told where it is too short.
TEST_F(ClientAsk, ABusyServerIsAskedAgain) {
  const auto start = std::chrono::steady_clock::now();
  const Result<Answer> hurried = client_->ask(ray_from(1), {.only = "busy", .timeout = 50ms});
  ASSERT_FALSE(hurried);
  EXPECT_EQ(hurried.error().code, ErrorCode::refused);
  EXPECT_EQ(hurried.error().retry_after, 100ms);
  const Result<Answer> patient = client_->ask(ray_from(1), {.only = "busy", .timeout = 20s});
  ASSERT_TRUE(patient) << patient.error().message;
  EXPECT_EQ(patient->verdict, Verdict::hit);
  EXPECT_GE(std::chrono::steady_clock::now() - start, 200ms) << "refused twice more";
}

TEST_F(ClientAsk, SilenceOfALivingServerIsATimeout) {
  const auto start = std::chrono::steady_clock::now();
  const Result<Answer> answer = client_->ask(ray_from(1), {.only = "silent", .timeout = 500ms});
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::timeout) << answer.error().message;
  EXPECT_GE(std::chrono::steady_clock::now() - start, 500ms);
}

TEST_F(ClientAsk, LateReplyIsNotTakenForTheNextAnswer) {
  ASSERT_FALSE(client_->ask(ray_from(111), {.only = "late", .timeout = 100ms}));
  server_.release_late();
  std::this_thread::sleep_for(50ms);
  for (int i = 0; i < 10; ++i) {
    const Result<Answer> answer = client_->ask(ray_from(i));
    ASSERT_TRUE(answer);
    ASSERT_EQ(answer->hits.at(0).distance_m, i);
  }
}

TEST_F(ClientAsk, NonsenseIsNotPassedOn) {
  const Result<Answer> answer = client_->ask(ray_from(1), {.only = "nonsense"});
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::internal);
}

TEST_F(ClientAsk, DeadServerIsDisconnectedNotATimeout) {
  ASSERT_TRUE(client_->status());
  server_.beating = false;
  server_.answering = false;
  const auto start = std::chrono::steady_clock::now();
  const Result<Answer> answer = client_->ask(ray_from(1), {.timeout = 10s});
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::disconnected) << answer.error().message;
  EXPECT_LE(std::chrono::steady_clock::now() - start, 2s);
  EXPECT_EQ(client_->ask(ray_from(1)).error().code, ErrorCode::disconnected);
  server_.beating = true;
  server_.answering = true;
  EXPECT_TRUE(test::eventually([&] { return static_cast<bool>(client_->ask(ray_from(1))); }));
}

/// A process of the server's name that does nothing, and can be stopped and killed.
class Stand {
 public:
  Stand() : pid_(::fork()) {
    if (pid_ != 0) return;
    ::prctl(PR_SET_NAME, "collided");
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    while (true) ::pause();
  }
  ~Stand() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Stand(const Stand&) = delete;
  Stand& operator=(const Stand&) = delete;
  std::uint32_t pid() const { return static_cast<std::uint32_t>(pid_); }
  bool runs() const { return client::runs_here(pid(), "collided"); }
  void signal(int number) const { ::kill(pid_, number); }

 private:
  pid_t pid_;
};

TEST(ClientLocalProcess, OnlyOneThatCanRunIsSaidTo) {
  const Stand stand;
  ASSERT_TRUE(test::eventually([&] { return stand.runs(); }));
  EXPECT_FALSE(client::runs_here(stand.pid(), "collide"));
  EXPECT_FALSE(client::runs_here(0, "collided"));
  stand.signal(SIGSTOP);
  EXPECT_TRUE(test::eventually([&] { return !stand.runs(); })) << "one that hangs";
  stand.signal(SIGCONT);
  EXPECT_TRUE(test::eventually([&] { return stand.runs(); }));
  stand.signal(SIGKILL);
  EXPECT_TRUE(test::eventually([&] { return !stand.runs(); })) << "killed, and nobody has asked how it ended";
}

// Threads that could run are counted by the kernel, whoever has a processor.
TEST(ClientLocalProcess, ManyBusyThreadsCrowdAMachine) {
  std::atomic<bool> over{false};
  std::vector<std::thread> busy;
  for (unsigned i = 0; i < 5 * std::max(1U, std::thread::hardware_concurrency()); ++i) {
    busy.emplace_back([&] {
      while (!over) {}
    });
  }
  EXPECT_TRUE(test::eventually([] { return client::is_machine_crowded(); }));
  over = true;
  for (std::thread& thread : busy) thread.join();
}

// On a machine with more to do than it can, a server may find no time for a word for long; its process tells it from one
// that is gone.
TEST_F(ClientAsk, ASilentServerWhoseProcessRunsIsWaitedFor) {
  const Stand stand;
  ASSERT_TRUE(test::eventually([&] { return stand.runs(); }));
  {
    const std::lock_guard lock(server_.mutex);
    server_.status->pid = stand.pid();
  }
  ASSERT_TRUE(test::eventually([&] { return client_->status()->pid == stand.pid(); }));
  server_.beating = false;
  std::thread later([&] {
    std::this_thread::sleep_for(1s);  // four times as long as a server may be silent
    server_.release_late();
  });
  const Result<Answer> answer = client_->ask(ray_from(1), {.only = "late", .timeout = 10s});
  later.join();
  EXPECT_TRUE(answer) << answer.error().message;
  stand.signal(SIGKILL);
  ASSERT_TRUE(test::eventually([&] { return !stand.runs(); }));
  std::this_thread::sleep_for(300ms);
  EXPECT_EQ(client_->ask(ray_from(1), {.only = "silent", .timeout = 10s}).error().code, ErrorCode::disconnected);
}

TEST(ClientReconnect, RestartedServerIsGreetedAnew) {
  auto first = std::make_unique<FakeServer>(test::own_namespace(), 1);
  Result<Client> client = Client::connect(test::here());
  ASSERT_TRUE(client) << client.error().message;
  ASSERT_TRUE(client->ask(ray_from(1)));
  first.reset();
  const FakeServer second(test::own_namespace(), 2);
  ASSERT_TRUE(test::eventually([&] { return static_cast<bool>(client->ask(ray_from(1))); }));
  EXPECT_EQ(client->status()->epoch, 102u);
}

TEST_F(ClientAsk, WrongQuestionsAreNamedAndNothingIsSent) {
  const auto message = [&](const auto& question) {
    const Result<Answer> answer = client_->ask(question);
    EXPECT_FALSE(answer);
    EXPECT_EQ(answer.error().code, ErrorCode::bad_input);
    EXPECT_EQ(answer.error().hint, "nothing was sent");
    return answer.error().message;
  };
  EXPECT_EQ(message(RayQuestion{{0, 0, 0}, {0, 0, 0}}), "ray: direction 0 0 0 has no direction");
  EXPECT_EQ(message(RayQuestion{{0, kNan, 0}, {0, 0, 1}}), "ray: origin 0 nan 0 is not finite");
  EXPECT_EQ(message(RayQuestion{{0, 0, 0}, {0, 0, 1}, -2}), "ray: length -2: allowed 0 to inf");
  EXPECT_EQ(message(RayQuestion{{0, 0, 0}, {0, 0, 1}, kNan}), "ray: length nan: allowed 0 to inf");
  EXPECT_EQ(message(SphereQuestion{{0, 0, 0}, -0.5}), "sphere: radius -0.5: allowed 0 to 1e290");
  EXPECT_EQ(message(SphereQuestion{{0, 0, 0}, kInf}), "sphere: radius inf: allowed 0 to 1e290");
  EXPECT_EQ(message(BoxQuestion{{0, 0, 0}, {1, -1, 1}}), "box: half size 1 -1 1: allowed 0 to 1e290");
  EXPECT_EQ(message(BoxQuestion{{0, 0, 0}, {1, 1, 1}, Quat(0.5, 0, 0, 0)}),
            "box: rotation 0.5 0 0 0 has norm 0.5, allowed 1 +- 1e-06");
  EXPECT_EQ(message(NearQuestion{{kInf, 0, 0}}), "near: point inf 0 0 is not finite");
  EXPECT_EQ(message(NearQuestion{{0, 2e290, 0}}), "near: point 0 2e+290 0: allowed are numbers up to 1e290");
  EXPECT_EQ(message(RayQuestion{{0, 0, 0}, {0, 0, -1e300}}),
            "ray: direction 0 0 -1e+300: allowed are numbers up to 1e290");
  EXPECT_EQ(message(SphereQuestion{{0, 0, 0}, 1e291}), "sphere: radius 1e+291: allowed 0 to 1e290");

  std::vector<RayQuestion> rays(2'000, ray_from(1));
  rays[1'812].direction.z() = kNan;
  const Result<Answers> answers = client_->ask(rays);
  ASSERT_FALSE(answers);
  EXPECT_EQ(answers.error().message, "ray 1812: direction 0 0 nan is not finite");
  EXPECT_TRUE(server_.query_chunks().empty());
}

// Its squares vanish, so a test of the norm would call it zero.
TEST_F(ClientAsk, TinyDirectionIsADirection) { EXPECT_TRUE(client_->ask(RayQuestion{{0, 0, 0}, {0, 0, 5e-324}})); }

TEST_F(ClientAsk, RotationInSinglePrecisionIsTaken) {
  const Eigen::Quaternionf rotation(Eigen::AngleAxisf(0.7f, Eigen::Vector3f(1, 2, 3).normalized()));
  EXPECT_TRUE(client_->ask(BoxQuestion{{0, 0, 0}, {1, 1, 1}, rotation.cast<double>()}));
}

TEST_F(ClientAsk, TooManyOrNoQuestionsAreRefused) {
  const std::vector<RayQuestion> rays(100'001, ray_from(1));
  EXPECT_EQ(client_->ask(rays).error().message, "ray: 100001 questions; a request holds 1 to 100000");
  EXPECT_EQ(client_->ask(std::span<const RayQuestion>()).error().code, ErrorCode::bad_input);
  EXPECT_EQ(client_->ask(ray_from(1), {.only = std::string(256, 'x')}).error().code, ErrorCode::bad_input);
}

TEST_F(ClientAsk, AsynchronousAnswersReachTheirFutures) {
  std::vector<std::future<Result<Answers>>> futures;
  for (int i = 0; i < 50; ++i) { futures.push_back(client_->ask_async(std::vector<RayQuestion>(10, ray_from(i)))); }
  for (int i = 0; i < 50; ++i) {
    const Result<Answers> answers = futures[static_cast<std::size_t>(i)].get();
    ASSERT_TRUE(answers) << answers.error().message;
    EXPECT_EQ(answers->answers.at(9).hits.at(0).distance_m, i);
  }
}

TEST_F(ClientAsk, SeveralThreadsAskOverOneClient) {
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 200; ++i) {
        const Result<Answer> answer = client_->ask(ray_from(1000 * t + i));
        wrong += !answer || answer->hits.at(0).distance_m != 1000 * t + i;
      }
    });
  }
  for (std::thread& thread : threads) { thread.join(); }
  EXPECT_EQ(wrong, 0);
}

TEST_F(ClientAsk, CommandAnswersInSeveralChunksArePutTogether) {
  const Result<std::string> answer = client_->command("long", "{}");
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->size(), 400'000 + std::string(R"({"answer":""})").size());
  EXPECT_EQ(answer->front(), '{');
  EXPECT_EQ(answer->back(), '}');
}

TEST_F(ClientAsk, CommandCarriesArgumentsAndShape) {
  const Result<std::string> answer = client_->command("add", R"({"name":"crate"})", {SphereShape{.radius_m = 1}});
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->find(R"({"command":"add","name":"crate","blob":)"), 0u) << *answer;
  EXPECT_EQ(answer->find("\"blob\":0"), std::string::npos) << *answer;
  EXPECT_EQ(client_->command("add", "[1]").error().code, ErrorCode::bad_input);
  EXPECT_EQ(client_->command("add", "{oops").error().code, ErrorCode::bad_input);
  EXPECT_EQ(client_->command("add", '"' + std::string(5'000, 'x') + '"').error().code, ErrorCode::bad_input);
  EXPECT_EQ(client_->command("refuse", "{}").error().code, ErrorCode::refused);
}

// Each word of progress starts the timeout anew: loading may take long as long as it goes on.
TEST_F(ClientAsk, ProgressKeepsALongCommandAlive) {
  std::vector<double> fractions;
  const Result<std::string> answer =
      client_->command("load", "{}", {}, 700ms, [&](double fraction) { fractions.push_back(fraction); });
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(*answer, R"({"scene":"warehouse"})");
  EXPECT_EQ(fractions, (std::vector<double>{0.25, 0.5, 0.75}));
}

TEST_F(ClientAsk, StatusIsTheNewestHeard) {
  const Result<ServerStatus> status = client_->status();
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(status->name_space, test::own_namespace());
  EXPECT_EQ(status->state, "ready");
  EXPECT_EQ(status->pid, 4711u);
  EXPECT_EQ(status->scenes, (std::vector<std::string>{"warehouse", "yard"}));
  EXPECT_LT(status->age, 1s);
}

}  // namespace
}  // namespace collided
