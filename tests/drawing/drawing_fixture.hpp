#pragma once

#include <map>
#include <optional>
#include <set>

#include "client/draw/drawing/drawing.hpp"
#include "tests/drawing/scenes.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided::drawing_test {

/// A real server with what a test puts there, and drawings of it.
class DrawingTest : public testing_support::ServerTest {
 protected:
  /// An empty world with these objects, which do not move.
  void serve(const std::vector<ObjectOptions>& objects) {
    start();
    client_.emplace(connect());
    ASSERT_TRUE(client_->command("clear", "{}")) << "the scene that it brings along";
    publisher_.emplace(publish(*client_, "scene"));
    for (ObjectOptions object : objects) {
      object.moving = false;
      object.lost_policy = LostPolicy::hold;  // nobody says that the publisher lives while pictures are drawn
      const auto added = publisher_->add(object);
      ASSERT_TRUE(added) << added.error().message;
    }
    ASSERT_TRUE(publisher_->flush());
    ASSERT_TRUE(publisher_->wait_applied(std::chrono::seconds(10)));
  }
  void serve(const Shape& shape, const Pose& pose = {}) { serve({{.name = "thing", .shape = shape, .pose = pose}}); }

  ShownObjects shown(double crease_cosine = 0.5) {
    const Result<ShownObjects> result = client_->shapes({.edges = true, .crease_cosine = crease_cosine});
    EXPECT_TRUE(result) << result.error().message;
    return result ? *result : ShownObjects{};
  }

  draw::Drawing drawing(draw::DrawOptions options) {
    options.crease_cosine = 0.5;
    rays_.emplace(*client_, AskOptions{.timeout = std::chrono::seconds(30)});
    return draw::draw(shown(), options, *rays_);
  }

  /// Three sides of a cube are seen, none of its edges hides another.
  static draw::View general_eye(bool is_orthographic = false) {
    return {.from = Vec3(3.1, -5.3, 4.2), .at = Vec3(0, 0, 0), .is_orthographic = is_orthographic, .width_px = 400};
  }

  /// Lines by number that have a piece which is seen (or hidden) for more than two pixels.
  static std::set<std::uint32_t> lines_with(const draw::Drawing& drawing, bool is_seen) {
    std::set<std::uint32_t> lines;
    for (const draw::Piece& piece : drawing.pieces) {
      const draw::LineSegment& segment = drawing.segments[piece.segment];
      if (piece.is_seen == is_seen && (piece.to - piece.from) * segment.length_px() > 2) lines.insert(segment.line);
    }
    return lines;
  }

  std::optional<Client> client_;
  std::optional<Publisher> publisher_;
  std::optional<draw::Rays> rays_;
};

}  // namespace collided::drawing_test
