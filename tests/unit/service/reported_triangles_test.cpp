#include <gtest/gtest.h>

#include "server/intake/mesh/mend.hpp"
#include "server/service/events/frames.hpp"
#include "server/service/questions/reply_columns.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {
namespace {

/// A panel of one triangle whose long edge a second part meets at its middle: mended, it is two.
Scene panels() {
  Scene scene;
  scene.name = "s";
  scene.mesh = {{{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, 0, 0}, {0, -1, 0}, {2, -1, 0}},
                {{0, 1, 2}, {3, 0, 4}, {1, 3, 5}}};
  scene.parts = {{.name = "s/panel", .first_triangle = 0, .triangle_count = 1},
                 {.name = "s/teeth", .first_triangle = 1, .triangle_count = 2}};
  return scene;
}

class ServiceToldTriangles : public testing::Test {
 protected:
  void SetUp() override {
    Scene scene = panels();
    ASSERT_EQ(mend(scene, 0).t_vertex_count, 1u);
    ASSERT_EQ(scene.parts[0].triangle_count, 2u);
    auto indexed = World::index_scene(scene, {});
    world_.add_scene(indexed);
    world_.step(1, 1, {});
    panel_ = *world_.find("s/panel");
  }

  World world_{WorldOptions{}};
  ObjectId panel_ = 0;
};

TEST_F(ServiceToldTriangles, RepliesNameThePieceOfATriangleByItsNumberInTheFile) {
  Answers answers;
  answers.answers = {Verdict::hit};
  answers.reasons = {UndecidedReason::none};
  answers.levels = {0};
  answers.hit_counts = {3};
  answers.nodes = answers.exact_tests = {0};
  for (const std::uint32_t triangle : {0u, 1u, kNoTriangle}) {
    AnswerHit hit{};
    hit.object = panel_;
    hit.triangle = triangle;
    answers.hits.push_back(hit);
  }
  std::vector<std::uint64_t> named_in;
  std::uint64_t reply_number = 0;
  ReplyColumns columns;
  ReplyFiller filler(*world_.newest(), answers, named_in, reply_number);
  ASSERT_TRUE(filler.fill(columns));
  EXPECT_EQ(columns.triangles, (std::vector<std::uint32_t>{0, 0, kNoTriangle}));
}

TEST_F(ServiceToldTriangles, EventsAndContactsDoTheSame) {
  OpenContact contact{};
  contact.a = panel_;
  contact.a_triangle = 1;
  contact.b = *world_.find("s/teeth");
  contact.b_triangle = 1;
  NameBook book;
  book.note(contact, world_);
  ContactColumns contacts;
  contacts.add(contact, book);
  EXPECT_EQ(contacts.a_triangles[0], 0u);
  EXPECT_EQ(contacts.b_triangles[0], 1u);  // a triangle of its own
  Event event{};
  event.of = contact;
  EventColumns events;
  events.add(event, book);
  EXPECT_EQ(events.a_triangles[0], 0u);
  EXPECT_EQ(events.b_triangles[0], 1u);
}

}  // namespace
}  // namespace collided::engine::service
