// A server whose world is at one step for seconds lives, answers, and says how long that has lasted.
#include <cstdlib>
#include <set>
#include <thread>

#include "collided/diagnosis.hpp"
#include "tests/service/long_step.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using testing_support::ChildProcess;
using testing_support::LongStep;

class ServerBusy : public testing_support::ServerTest {
 protected:
  void SetUp() override { start({"--step-threads", "1"}); }
  /// Whether the newest status says that a step has lasted for so long.
  static bool is_busy(Client& client, std::chrono::nanoseconds least) {
    const Result<ServerStatus> status = client.status();
    return status && status->step_lasting >= least;
  }
};

TEST_F(ServerBusy, ItAnswersAndNobodyTakesItForDead) {
  Client client = connect();
  LongStep crowd(client);
  Watch watching = watch(client);
  const std::uint64_t applied = client.status()->poses_applied;
  crowd.begin();
  ASSERT_TRUE(test::eventually([&] { return is_busy(client, 300ms); }, 20s)) << "the step does not last";
  // Each round until the step is over. A machine that stands still makes a status late, and that is not the server's.
  std::size_t asked = 0;
  std::chrono::nanoseconds lasted{0};
  while (asked < 5'000) {
    const ServerStatus status = *client.status();
    // Over; what it took is applied, and the next step may last too.
    if (status.step_lasting == 0ns || status.poses_applied != applied) break;
    const Result<Answer> answer = client.ask(RayQuestion{.origin = {0, 0, 60}, .direction = {0, 0, -1}});
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_TRUE(watching.connected());
    EXPECT_TRUE(client.command("figures", "{}", {}, 5s));
    lasted = std::max(lasted, status.step_lasting);
    EXPECT_TRUE(crowd.publisher().keep_alive());
    ++asked;
    std::this_thread::sleep_for(5ms);
  }
  EXPECT_GT(asked, 10U);
  EXPECT_GT(lasted, 500ms) << "statuses tell how it goes on";
  const Result<void> waited = crowd.publisher().wait_applied(60s);
  EXPECT_TRUE(waited) << waited.error().message;
  EXPECT_EQ(crowd.publisher().flush()->lost, "");
  EXPECT_TRUE(watching.next(20s)) << "they meet";
  EXPECT_EQ(watching.resyncs(), 0U);
}

// Waits last until their time is over, whatever is due meanwhile, and then say why.
TEST_F(ServerBusy, WaitsLastUntilTheirTimeAndSayWhyItWasNotEnough) {
  Client client = connect();
  LongStep crowd(client);
  crowd.begin();
  ASSERT_TRUE(test::eventually([&] { return is_busy(client, 100ms); }, 20s)) << "the step does not last";
  const auto begun = Clock::now();
  const Result<void> waited = crowd.publisher().wait_applied(400ms);
  if (!waited) {
    EXPECT_EQ(waited.error().code, ErrorCode::timeout) << waited.error().message;
    EXPECT_GE(Clock::now() - begun, 400ms);
    EXPECT_EQ(waited.error().hint.find("it is busy: a step has lasted "), 0U) << waited.error().hint;
  }
  const auto asked = Clock::now();
  const Result<std::string> got = client.command("get", R"({"name": "rough 0"})", {}, 60s);
  EXPECT_TRUE(got) << got.error().message << " after " << (Clock::now() - asked) / 1ms << " ms";
  EXPECT_TRUE(crowd.publisher().wait_applied(60s));
}

TEST_F(ServerBusy, TheCommandLineSaysHowLongTheStepHasLasted) {
  Client client = connect();
  LongStep crowd(client);
  crowd.begin();
  ASSERT_TRUE(test::eventually([&] { return is_busy(client, 600ms); }, 20s)) << "the step does not last";
  ChildProcess status({COLLIDED_CLI, "status", "--fields", "step_lasting", "--domain", std::to_string(domain_)},
                      folder_.path(), "status");
  std::vector<Finding> findings;
  std::thread doctor([&] { findings = diagnose({.domain = domain_, .wait = 10s}); });
  EXPECT_EQ(status.wait(20s), 0) << status.errors();
  doctor.join();
  EXPECT_GT(std::atof(status.output().c_str()), 0.3) << status.output();
  std::set<std::string> about;
  for (const Finding& finding : findings) about.insert(finding.about);
  EXPECT_TRUE(about.contains("busy"));
}

}  // namespace
}  // namespace collided
