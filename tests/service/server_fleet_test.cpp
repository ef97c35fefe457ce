// Which servers of a namespace there are, as the servers themselves say.
#include <algorithm>
#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include "collided/fleet.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using testing_support::ChildProcess;
using testing_support::ScratchFolder;

class ServerFleet : public testing_support::ServerTest {
 protected:
  Fleet listen() {
    Result<Fleet> found = fleet({.domain = domain_});
    EXPECT_TRUE(found) << found.error().message;
    return found ? std::move(*found) : Fleet{};
  }
  static std::vector<std::string> abouts(const Fleet& fleet) {
    std::vector<std::string> all;
    for (const Finding& finding : fleet.findings) all.push_back(finding.about);
    return all;
  }
  /// A server that starts while the first is held, so that neither knows of the other.
  std::unique_ptr<ChildProcess> start_beside(ChildProcess& first, const ScratchFolder& folder,
                                             std::vector<std::string> options) {
    first.signal(SIGSTOP);
    std::vector<std::string> words{COLLIDED_SERVER, "--domain", std::to_string(domain_), "--state-dir", folder.path()};
    words.insert(words.end(), options.begin(), options.end());
    auto second = std::make_unique<ChildProcess>(words, folder.path(), "second");
    EXPECT_TRUE(second->says("ready:", 20s)) << second->errors();
    first.signal(SIGCONT);
    return second;
  }
  static bool logs(const ChildProcess& server, const std::string& sentence) {
    return test::eventually([&] { return server.errors().find(sentence) != std::string::npos; });
  }
};

TEST_F(ServerFleet, OneServerIsOneMemberThatFits) {
  ChildProcess& server = start({"--member", "north"});
  const Fleet found = listen();
  ASSERT_EQ(found.members.size(), 1U);
  const FleetMember& member = found.members[0];
  EXPECT_EQ(member.name, "north");
  EXPECT_EQ(member.role, FleetRole::primary);
  EXPECT_EQ(member.state, "ready");
  EXPECT_EQ(member.pid, static_cast<std::uint32_t>(server.pid()));
  EXPECT_EQ(member.version_text, library_version());
  EXPECT_NE(member.scene_fingerprint, 0U);
  EXPECT_EQ(member.hash_time, 0s) << "there is nobody to be compared with";
  EXPECT_EQ(member.alarm, "");
  EXPECT_LT(std::chrono::abs(member.clock_ahead), 500ms);
  EXPECT_EQ(abouts(found), std::vector<std::string>{});
}

TEST_F(ServerFleet, AServerThatHasLeftIsNotListed) {
  ChildProcess& server = start();
  EXPECT_EQ(listen().members.size(), 1U);
  server.signal(SIGTERM);
  EXPECT_EQ(server.wait(10s), 0);
  const Result<Fleet> found = fleet({.domain = domain_});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::no_server);
}

TEST_F(ServerFleet, TwoPrimariesAreFoundByThemselvesAndByWhoLooks) {
  ChildProcess& first = start({"--member", "north"});
  const ScratchFolder elsewhere;
  const auto second = start_beside(first, elsewhere, {"--member", "south"});
  EXPECT_TRUE(logs(first, "fleet: two primaries: 'south'")) << first.errors();
  EXPECT_TRUE(logs(*second, "fleet: two primaries: 'north'")) << second->errors();
  const Fleet found = listen();
  ASSERT_EQ(found.members.size(), 2U);
  EXPECT_EQ(found.members[0].name, "north");
  EXPECT_EQ(found.members[1].name, "south");
  EXPECT_EQ(abouts(found), std::vector<std::string>{"primaries"});
  EXPECT_EQ(first.errors().find("different scenes"), std::string::npos);
}

TEST_F(ServerFleet, ServersThatHoldTheSameHaveOneHashAndOtherScenesAnother) {
  ChildProcess& first = start({"--member", "north"});
  const ScratchFolder elsewhere;
  {
    const auto second = start_beside(first, elsewhere, {"--member", "south"});
    EXPECT_TRUE(test::eventually(
        [&] {
          const Fleet found = listen();
          return found.members.size() == 2 && found.members[0].hash_time != 0s &&
                 found.members[0].hash_time == found.members[1].hash_time &&
                 found.members[0].world_hash == found.members[1].world_hash;
        },
        20s));
  }
  const std::string mesh = folder_.write("wall.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto third = start_beside(first, elsewhere, {"--member", "east", mesh});
  EXPECT_TRUE(logs(first, "fleet: different scenes: those of 'east'")) << first.errors();
  const std::vector<std::string> about = abouts(listen());
  EXPECT_NE(std::ranges::find(about, "scenes"), about.end());
}

}  // namespace
}  // namespace collided
