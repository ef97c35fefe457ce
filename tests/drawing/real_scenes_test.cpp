#include <filesystem>

#include "tests/drawing/drawing_fixture.hpp"

namespace collided::drawing_test {
namespace {

class DrawingRealScenes : public DrawingTest {
 protected:
  /// 1,200 pixels wide, from asking for the shapes to the bytes of the picture.
  void expect_five_seconds(const std::string& path, draw::Style style, const Vec3& up) {
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not installed";
    start({path});
    client_.emplace(connect());
    const auto begun = std::chrono::steady_clock::now();
    const draw::Drawing d = drawing({.view = {.up = up}, .style = style});
    const std::string svg = draw::as_svg(d.picture);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    std::printf("%zu lines, %zu kB, %llu rays, %llu undecided, %.2f s\n", d.segments.size(), svg.size() / 1000,
                static_cast<unsigned long long>(rays_->asked()), static_cast<unsigned long long>(rays_->undecided()),
                seconds);
    EXPECT_LT(seconds, 5);
    EXPECT_GT(d.picture.strokes.size(), 100U);
    EXPECT_EQ(rays_->undecided(), 0U);
  }
};

constexpr const char* kHouse = "/usr/share/assimp/models/IFC/AC14-FZK-Haus.ifc";
constexpr const char* kBunny = "/usr/share/glmark2/models/bunny.obj";

// A57
TEST_F(DrawingRealScenes, TheHouseIsDrawnInFiveSeconds) {
  expect_five_seconds(kHouse, draw::Style::hidden_line, Vec3::UnitZ());
}
TEST_F(DrawingRealScenes, TheHouseHasTonesInFiveSeconds) {
  expect_five_seconds(kHouse, draw::Style::toon, Vec3::UnitZ());
}
TEST_F(DrawingRealScenes, TheBunnyIsDrawnInFiveSeconds) {
  expect_five_seconds(kBunny, draw::Style::hidden_line, Vec3::UnitY());
}
TEST_F(DrawingRealScenes, TheBunnyIsHatchedInFiveSeconds) {
  expect_five_seconds(kBunny, draw::Style::hatched, Vec3::UnitY());
}

}  // namespace
}  // namespace collided::drawing_test
