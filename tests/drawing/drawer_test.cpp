#include "client/view/drawer.hpp"

#include <thread>

#include "client/draw/drawing/picture.hpp"
#include "tests/drawing/drawing_fixture.hpp"

namespace collided::drawing_test {
namespace {

using namespace std::chrono_literals;

class ViewDrawer : public DrawingTest {
 protected:
  static std::string newest(view::Drawer& drawer) {
    const auto until = std::chrono::steady_clock::now() + 120s;
    while (std::chrono::steady_clock::now() < until) {
      if (const view::Bytes drawn = drawer.newest()) return *drawn;
      std::this_thread::sleep_for(5ms);
    }
    return "nothing was drawn";
  }
  std::string drawn(bool y_is_up) {
    draw::DrawOptions options;
    options.view.width_px = 900;
    if (y_is_up) options.view.up = Vec3::UnitY();
    options.crease_cosine = 0.866;
    options.sight.spacing_px = 2;
    draw::Rays rays(*client_, {.timeout = 30s});
    try {
      return draw::as_svg(draw::draw(shown(0.866), options, rays).picture);
    } catch (const Error& failed) { return "nothing was drawn: " + failed.message; }
  }
};

// Browsers without WebGL see what the library draws: every line, to the digit.
TEST_F(ViewDrawer, ThePictureIsTheOneThatTheLibraryDraws) {
  serve({{.name = "crate", .shape = {BoxShape{{1, 0.7, 0.4}}}},
         {.name = "ball", .shape = {SphereShape{0.6}}, .pose = {.position = {1.1, -1.3, 0.3}}},
         {.name = "pipe", .shape = {CylinderShape{.a = {-1, -1, -1}, .b = {1, 1.2, 1.5}, .radius_m = 0.2}}},
         {.name = "ring", .shape = {torus(1.5, 0.2, 24, 12)}, .pose = {.position = {0, 0.4, -0.2}}}});
  for (const bool y_is_up : {false, true}) {
    view::Drawer drawer(*client_, y_is_up);
    EXPECT_EQ(newest(drawer), drawn(y_is_up));
  }
}

}  // namespace
}  // namespace collided::drawing_test
