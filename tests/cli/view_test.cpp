#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class View : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().status.state = "ready";
    fake::server().command = [](const std::string&, const nlohmann::json&, const Shape&) -> Result<std::string> {
      return std::string("{}");
    };
    fake::server().shapes = [](const ShapesOptions&) -> Result<ShownObjects> {
      ShownObject ball;
      ball.id = 1;
      ball.name = "</script><b>ball";
      ball.moving = true;
      ball.parts = {SphereShape{.radius_m = 0.1}};
      return ShownObjects{.epoch = 1, .version = 1, .table_version = 1, .objects = {ball}};
    };
    fake::server().poses = [this]() -> Result<Poses> {
      Poses poses;
      poses.epoch = 1;
      poses.table_version = 1;
      poses.version = ++looks;
      poses.ids = {1};
      poses.poses = {{.position = {static_cast<double>(looks), 0, 0}, .rotation = Quat::Identity()}};
      poses.stale = {0};
      return poses;
    };
  }

  std::uint64_t looks = 0;
};

TEST_F(View, SaysWhereItsPageIs) {
  const Ran ran = at_terminal("view --port 0 --for 20ms");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out.substr(0, 17), "http://127.0.0.1:");
  EXPECT_NE(ran.out.find("  (Foxglove or Lichtblick: ws://127.0.0.1:"), std::string::npos) << ran.out;
  EXPECT_EQ(ran.err.substr(0, 14), "0 connections;");
}

// To an address that other machines may reach belongs a token, in both addresses that are printed.
TEST_F(View, OpenToTheNetworkItPrintsAToken) {
  const Ran ran = collide("view --bind 0.0.0.0 --port 0 --for 20ms --json");
  EXPECT_EQ(ran.code, 0) << ran.err;
  const nlohmann::json said = nlohmann::json::parse(ran.out);
  const std::string url = said["url"];
  const std::size_t at = url.find("/?token=");
  ASSERT_NE(at, std::string::npos) << url;
  EXPECT_EQ(url.size() - at, 8U + 32U) << url;
  EXPECT_TRUE(said["foxglove"].get<std::string>().ends_with(url.substr(at))) << said;
  EXPECT_NE(ran.err.find("warning: anybody on the network who reaches 0.0.0.0 and has the token may watch"),
            std::string::npos)
      << ran.err;
  EXPECT_EQ(collide("view --port 0 --for 20ms --json").out.find("token"), std::string::npos);
}

TEST_F(View, BadUseIsSaidBeforeAnythingIsServed) {
  EXPECT_EQ(collide("view --port 65536").err.substr(0, 47), "error: view: --port 65536; allowed: 0 to 65535\n");
  EXPECT_EQ(collide("view --up x").err, "error: view: --up x; allowed: y, z\n");
  EXPECT_EQ(collide("view --bind nowhere --port 0").code, 2);
  EXPECT_EQ(collide("view --save /nowhere/at/all.html").err, "error: view: /nowhere/at/all.html: cannot be written\n");
  EXPECT_EQ(collide("view --save /tmp/x.html --last 0s").code, 2);
  EXPECT_EQ(fake::server().connect_count, 1) << "for the address alone";
}

// A name is data: in the file that is saved it never ends the script that it stands in.
TEST_F(View, ASavedRunHoldsItsFramesAndNoNameBreaksOut) {
  const ScratchFile file("run.html", "");
  const Ran ran = collide("view --save " + file.path() + " --last 200ms --json --fields file,frames");
  EXPECT_EQ(ran.code, 0) << ran.err;
  const nlohmann::json said = nlohmann::json::parse(ran.out);
  EXPECT_GE(said["frames"].get<int>(), 2);
  std::ifstream in(file.path());
  const std::string page((std::istreambuf_iterator<char>(in)), {});
  std::size_t frames = 0;
  for (std::size_t at = page.find("\"kind\":\"poses\""); at != std::string::npos;
       at = page.find("\"kind\":\"poses\"", at + 1))
    ++frames;
  EXPECT_EQ(frames, said["frames"].get<std::size_t>());
  EXPECT_EQ(page.find("<b>ball"), std::string::npos);
  std::size_t ends = 0;
  for (std::size_t at = page.find("</script>"); at != std::string::npos; at = page.find("</script>", at + 1)) ++ends;
  EXPECT_EQ(ends, 2U);
}

}  // namespace
}  // namespace collided
