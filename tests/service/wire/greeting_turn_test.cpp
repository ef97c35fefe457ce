// Who may look for a server, when many programs of a machine do at once.

#include "client/library/connection/greeting_turn.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <memory>
#include <vector>

#include "tests/service/wire/network.hpp"

namespace collided::client {
namespace {

using namespace std::chrono_literals;

ConnectOptions at(int domain) {
  ConnectOptions options = test::here();
  options.domain = domain;
  options.wait = 50ms;
  return options;
}

// Domains that no server may have, so that no other program of this machine takes turns there.
int domain_of_test() { return 100'000 + static_cast<int>(::getpid()); }

std::vector<std::unique_ptr<GreetingTurn>> all_turns(const ConnectOptions& options) {
  std::vector<std::unique_ptr<GreetingTurn>> turns;
  for (unsigned i = 0; i < GreetingTurn::count(); ++i) turns.push_back(std::make_unique<GreetingTurn>(options));
  return turns;
}

TEST(ClientGreetingTurn, AFewHaveOneAtATimeAndTheNextOneWaitsForAsLongAsForAServer) {
  const ConnectOptions options = at(domain_of_test());
  std::vector<std::unique_ptr<GreetingTurn>> turns = all_turns(options);
  for (const auto& turn : turns) EXPECT_TRUE(turn->is_taken());
  const auto start = std::chrono::steady_clock::now();
  const GreetingTurn late(options);
  EXPECT_FALSE(late.is_taken());
  EXPECT_GE(std::chrono::steady_clock::now() - start, 50ms);
  turns.pop_back();
  EXPECT_TRUE(GreetingTurn(options).is_taken());
}

TEST(ClientGreetingTurn, OtherDomainsAndOtherMachinesServersAreNotWaitedFor) {
  const ConnectOptions options = at(domain_of_test());
  const std::vector<std::unique_ptr<GreetingTurn>> turns = all_turns(options);
  EXPECT_TRUE(GreetingTurn(at(domain_of_test() + 1)).is_taken());
  ConnectOptions elsewhere = options;
  elsewhere.interface = "auto";
  elsewhere.wait = 1h;
  EXPECT_FALSE(GreetingTurn(elsewhere).is_taken());
}

TEST(ClientGreetingTurn, WhoeverDiesGivesItsTurnBack) {
  const ConnectOptions options = at(domain_of_test());
  std::vector<std::unique_ptr<GreetingTurn>> turns = all_turns(options);
  turns.pop_back();
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const GreetingTurn turn(options);
    ::_exit(turn.is_taken() ? 0 : 1);  // without its destructor
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_TRUE(GreetingTurn(options).is_taken());
}

}  // namespace
}  // namespace collided::client
