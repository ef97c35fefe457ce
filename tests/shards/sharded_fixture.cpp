#include "tests/shards/sharded_fixture.hpp"

#include <array>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include <nlohmann/json.hpp>

namespace collided::testing_support {
namespace {

using nlohmann::json;

struct Corners {
  std::array<double, 3> low{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                            -std::numeric_limits<double>::infinity()};
  std::array<double, 3> high{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::infinity()};
};

json written(const std::array<double, 3>& corner) {
  json list = json::array();
  for (const double x : corner) list.push_back(std::isinf(x) ? json(nullptr) : json(x));
  return list;
}

}  // namespace

std::string ShardedWorldTest::random_map(std::mt19937_64& random, std::size_t count, double margin_m) {
  std::vector<Corners> boxes(1);
  while (boxes.size() < count) {
    const std::size_t at = random() % boxes.size();
    const std::size_t axis = random() % 3;
    Corners lower = boxes[at];
    Corners upper = lower;
    const double plane = std::clamp(number(random, kReach_m / 2), -kReach_m, kReach_m);
    if (!(plane > lower.low[axis] && plane < lower.high[axis])) continue;
    lower.high[axis] = upper.low[axis] = plane;
    boxes[at] = lower;
    boxes.push_back(upper);
  }
  json map{{"margin_m", margin_m}, {"shards", json::array()}};
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    map["shards"].push_back(
        {{"name", "s" + std::to_string(i)}, {"low", written(boxes[i].low)}, {"high", written(boxes[i].high)}});
  }
  return map.dump();
}

std::string ShardedWorldTest::write_random_scene(std::mt19937_64& random, int count) {
  std::ostringstream text;
  text.precision(17);
  for (int part = 0; part < count; ++part) {
    const Vec3 center = vector(random, kReach_m);
    const double size_m = random() % 8 == 0 ? 4 : 0.7;  // some reach across several shards
    text << "o part_" << part << '\n';
    for (int corner = 0; corner < 4; ++corner) {
      const Vec3 point = center + vector(random, size_m);
      text << "v " << point.x() << ' ' << point.y() << ' ' << point.z() << '\n';
    }
    text << "f -4 -3 -2\n";
    if (random() % 3 != 0) text << "f -4 -2 -1\nf -4 -1 -3\nf -3 -1 -2\n";
  }
  return folder_.write("scene.obj", text.str());
}

}  // namespace collided::testing_support
