// The client's library and the engine in one program, each with its own types.
#include <gtest/gtest.h>

#include <collided/client.hpp>

#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/service/own_domain.hpp"

namespace collided {
namespace {

// A user's program asks its own world and a server's, and compares.
TEST(OneProgram, AsksAnEngineOfItsOwnBesideTheClient) {
  engine::World world{engine::WorldOptions{}};
  engine::Shape shape;
  shape.primitives.emplace_back(engine::Sphere{.center = Vec3::Zero(), .radius_m = 0.5});
  const engine::ObjectDefinition ball{.name = "ball",
                                      .scene = {},
                                      .shape = shape,
                                      .pose = {},
                                      .filter = {},
                                      .moving = true,
                                      .lost_policy = engine::LostPolicy::remove,
                                      .publisher = 1};
  ASSERT_TRUE(std::holds_alternative<engine::ObjectId>(world.define(ball)));
  ASSERT_TRUE(world.step(1, 1, {}));
  engine::Answers answers;
  engine::QueryScratch scratch;
  const std::vector<double> down{0, 0, 2, 0, 0, -1, 10};
  engine::answer(
      *world.newest(),
      {.kind = engine::QuestionKind::ray, .mode = engine::HitMode::closest, .numbers = down, .mover = nullptr}, answers,
      scratch);
  ASSERT_EQ(answers.hits.size(), 1u);
  EXPECT_EQ(answers.hits[0].distance_m, 1.5);

  ConnectOptions nowhere;
  nowhere.domain = testing_support::own_domain();
  nowhere.wait = std::chrono::milliseconds(1);
  const Result<Client> client = Client::connect(nowhere);
  ASSERT_FALSE(client) << "nobody serves there";
  EXPECT_EQ(client.error().code, ErrorCode::no_server) << client.error().message;
}

}  // namespace
}  // namespace collided
