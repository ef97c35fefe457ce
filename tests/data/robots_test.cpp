#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "server/exact_phase/distance/convex_pair.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/aabb.hpp"
#include "tests/data/recorded.hpp"

namespace collided::recorded {
using namespace engine;
namespace {

class RecordedRobots : public RecordedReality {
 protected:
  /// One mesh a name, read once.
  std::shared_ptr<const TriangleMesh> mesh(const std::filesystem::path& folder, const std::string& name,
                                           const char* ending) {
    auto& found = meshes_[name];
    if (!found) found = mesh_file(folder / (name + ending));
    return found;
  }

 private:
  std::map<std::string, std::shared_ptr<const TriangleMesh>> meshes_;
};

double apart_m(const Aabb& a, const Aabb& b) { return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0).norm(); }

/// Distance of a placed mesh that does not touch a box, by the engine's separation of convex sets; `most` where it is
/// more.
double clearance_m(const TriangleMesh& mesh, const Frame& frame, const Box& box, double most) {
  const Aabb around = bounds(box);
  const kernel::Convex of_box(box);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle triangle = place(frame, mesh.triangle(i));
    if (apart_m(bounds(triangle), around) >= most) continue;
    const kernel::ConvexPair pair{kernel::Convex(triangle), of_box};
    const Separation apart = kernel::separation_of(pair);
    EXPECT_LT(apart.error_m, 1e-9);
    most = std::min(most, apart.distance_m);
  }
  return most;
}

// A Franka Panda's log of 21 s in its lab: it ran, so nothing collides; the least distance, FCL's 59.009 mm, is between
// hand and work table.
TEST_F(RecordedRobots, ThePandaThatRanNeverTouchesItsTables) {
  const auto folder = data_ / "panda_lab";
  const Rows poses(folder / "link_poses_50hz.csv.gz"), tables(folder / "env.csv"),
      expected(folder / "expected_clearance_50hz.csv");
  Stage stage;
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    boxes.push_back({.center = tables.point(i),
                     .half_m = 0.5 * Vec3(tables.number(i, "sx"), tables.number(i, "sy"), tables.number(i, "sz"))});
    stage.add(tables.text(i, "name"), Shape{{boxes.back()}, nullptr}, {}, false);
  }
  std::map<std::string, ObjectId> links;
  double least_m = std::numeric_limits<double>::infinity(), worst_m = 0;
  std::string nearest;
  int colliding = 0;
  const auto frames = poses.groups("frame");
  for (std::size_t f = 0; f < frames.size(); ++f) {
    double here_m = 10;
    for (std::size_t row = frames[f].first; row < frames[f].second; ++row) {
      const std::string& link = poses.text(row, "link");
      if (link == "panda_link0") continue;  // it stands on its table
      const auto shape = mesh(folder / "meshes", poses.text(row, "mesh"), ".stl");
      const auto [at, is_new] = links.try_emplace(link);
      if (is_new) {
        at->second = stage.add(link, Shape{{}, shape}, poses.pose(row), true, 1);
      } else {
        stage.move(at->second, poses.pose(row));
      }
      for (std::size_t b = 0; b < boxes.size(); ++b) {
        const double distance_m = clearance_m(*shape, frame_of(poses.pose(row)), boxes[b], here_m);
        if (distance_m < std::min(here_m, least_m)) nearest = link + ":" + tables.text(b, "name");
        here_m = std::min(here_m, distance_m);
      }
      least_m = std::min(least_m, here_m);
    }
    stage.step();
    colliding += stage.touching().empty() ? 0 : 1;
    worst_m = std::max(worst_m, std::abs(here_m - expected.number(f, "min_distance_m")));
  }
  std::printf("%zu frames, %d collide, least clearance %.6f m (%s), at most %.2g m off FCL's in any frame\n",
              frames.size(), colliding, least_m, nearest.c_str(), worst_m);
  EXPECT_EQ(frames.size(), 1050u);
  EXPECT_EQ(colliding, 0);
  EXPECT_NEAR(least_m, 0.0590, 0.0001);
  EXPECT_EQ(nearest, "panda_hand:work_table");
  EXPECT_LT(worst_m, 2e-6);  // FCL's figures have six digits after the point, and its iteration ends at 1e-6
}

/// Boxes and cylinders of a cell; shape in its own frame.
Shape object_shape(const Rows& scenes, std::size_t row) {
  Shape shape;
  const double d0 = scenes.number(row, "d0"), d1 = scenes.number(row, "d1");
  if (scenes.text(row, "type") == "box") {
    shape.primitives = {Box{.center = Vec3::Zero(), .half_m = 0.5 * Vec3(d0, d1, scenes.number(row, "d2"))}};
  } else {
    shape.primitives = {Cylinder{.a = {0, 0, -d0 / 2}, .b = {0, 0, d0 / 2}, .radius_m = d1}};
  }
  return shape;
}

// 1,400 starts and goals in 700 cells with the robot as 59 spheres: all free but the goal of table_pick/0041, as VAMP
// counts 699 valid problems of 700.
TEST_F(RecordedRobots, OneStateOf1400CollidesAsSpheres) {
  const auto folder = data_ / "mbm_panda";
  const Rows scenes(folder / "scenes.csv.gz"), spheres(folder / "spheres.csv.gz");
  std::map<std::string, std::vector<std::pair<std::string, Primitive>>> cells;
  for (std::size_t row = 0; row < scenes.size(); ++row) {
    const Primitive placed = place(frame_of(scenes.pose(row)), object_shape(scenes, row).primitives[0]);
    cells[scenes.text(row, "scene")].emplace_back(scenes.text(row, "object"), placed);
  }
  std::set<std::string> hits;
  const auto states = spheres.groups("scene", "state");
  for (const auto& [first, end] : states) {
    for (std::size_t row = first; row < end; ++row) {
      const Primitive sphere = Sphere{spheres.point(row), spheres.number(row, "r")};
      for (const auto& [name, object] : cells[spheres.text(row, "scene")]) {
        const ExactResult verdict = overlaps(sphere, object);
        ASSERT_NE(verdict.decision, Decision::undecided);
        if (verdict.yes()) hits.insert(spheres.text(row, "scene") + " " + spheres.text(row, "state") + " " + name);
      }
    }
  }
  std::printf("%zu cells, %zu states, %zu collide\n", cells.size(), states.size(), hits.size());
  EXPECT_EQ(cells.size(), 700u);
  EXPECT_EQ(states.size(), 1400u);
  EXPECT_EQ(hits, std::set<std::string>{"table_pick/0041 goal Object3"});
}

/// What touches in each state of a table of link poses; a state is a scene with a text in the column.
class Cells {
 public:
  Cells(const std::filesystem::path& folder,
        std::function<std::shared_ptr<const TriangleMesh>(const std::string&)> mesh)
      : scenes_(folder / "scenes.csv.gz"), mesh_(std::move(mesh)) {
    for (const auto& [first, end] : scenes_.groups("scene")) rows_of_[scenes_.text(first, "scene")] = {first, end};
  }

  /// Calls with (first row of the state, "mesh:object" of every pair that touches).
  void play(const Rows& links, const char* state,
            const std::function<void(std::size_t, const std::set<std::string>&)>& tell) const {
    for (const auto& [first, end] : links.groups("scene")) {
      Stage stage;
      const auto [object, last_object] = rows_of_.at(links.text(first, "scene"));
      for (std::size_t row = object; row < last_object; ++row) {
        stage.add(scenes_.text(row, "object"), object_shape(scenes_, row), scenes_.pose(row), false);
      }
      play_scene(stage, links, state, {first, end}, tell);
    }
  }

 private:
  void play_scene(Stage& stage, const Rows& links, const char* state, std::pair<std::size_t, std::size_t> rows,
                  const std::function<void(std::size_t, const std::set<std::string>&)>& tell) const {
    std::map<std::string, std::pair<ObjectId, std::string>> robot;  // by link: the object, and its mesh's name
    for (std::size_t row = rows.first; row < rows.second;) {
      const std::size_t begin = row;
      for (; row < rows.second && links.text(row, state) == links.text(begin, state); ++row) {
        const std::string& link = links.text(row, "link");
        const auto [at, is_new] = robot.try_emplace(link);
        if (is_new) {
          const std::string& mesh = links.text(row, "mesh");
          at->second = {stage.add("robot/" + link, Shape{{}, mesh_(mesh)}, links.pose(row), true, 1), mesh};
        } else {
          stage.move(at->second.first, links.pose(row), true);
        }
      }
      stage.step();
      std::set<std::string> pairs;
      for (const std::string& pair : stage.touching()) {
        const std::size_t colon = pair.find(':');
        pairs.insert(robot.at(pair.substr(6, colon - 6)).second + pair.substr(colon));
      }
      tell(begin, pairs);
    }
  }

  Rows scenes_;
  std::function<std::shared_ptr<const TriangleMesh>(const std::string&)> mesh_;
  std::map<std::string, std::pair<std::size_t, std::size_t>> rows_of_;
};

std::set<std::string> words(std::string text) {
  std::erase(text, '"');
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

// The same starts and goals with the robot as its meshes: the data set calls them all valid.
TEST_F(RecordedRobots, NoStateOf1400CollidesAsMeshes) {
  const auto folder = data_ / "mbm_panda";
  const Cells cells(folder, [&](const std::string& name) { return mesh(folder / "meshes", name, ".obj"); });
  int states = 0, colliding = 0;
  cells.play(Rows(folder / "links.csv.gz"), "state", [&](std::size_t, const std::set<std::string>& pairs) {
    ++states;
    colliding += pairs.empty() ? 0 : 1;
  });
  std::printf("%d states, %d collide\n", states, colliding);
  EXPECT_EQ(states, 1400);
  EXPECT_EQ(colliding, 0);
}

// 2,940 states on straight ways between start and goal: FCL finds 1,023 that collide, and names the pairs.
TEST_F(RecordedRobots, AThousandStatesOnTheWayCollideWithTheListedPairs) {
  const auto folder = data_ / "mbm_panda";
  const Rows links(folder / "paths.csv.gz"), expected(folder / "expected_paths.csv.gz");
  const Cells cells(folder, [&](const std::string& name) { return mesh(folder / "meshes", name, ".obj"); });
  std::size_t state = 0;
  int colliding = 0, other_answer = 0, other_pairs = 0;
  std::vector<std::string> differ;
  cells.play(links, "step", [&](std::size_t row, const std::set<std::string>& pairs) {
    ASSERT_EQ(expected.text(state, "scene"), links.text(row, "scene"));
    ASSERT_EQ(expected.text(state, "step"), links.text(row, "step"));
    const bool collides = expected.text(state, "colliding") == "1";
    colliding += pairs.empty() ? 0 : 1;
    if (pairs.empty() == collides) ++other_answer;
    if (collides && words(expected.text(state, "pairs_or_closest")) != pairs) {
      ++other_pairs;
      std::string ours;
      for (const std::string& pair : pairs) ours += pair + " ";
      differ.push_back(links.text(row, "scene") + " " + links.text(row, "step") + ": " +
                       expected.text(state, "pairs_or_closest") + " against " + ours);
    }
    ++state;
  });
  std::printf("%zu states, %d collide, another answer than FCL's %d, other pairs %d\n", state, colliding, other_answer,
              other_pairs);
  for (std::size_t i = 0; i < std::min<std::size_t>(differ.size(), 10); ++i) std::printf("  %s\n", differ[i].c_str());
  EXPECT_EQ(state, 2940u);
  EXPECT_EQ(colliding, 1023);
  EXPECT_EQ(other_answer, 0);
  EXPECT_EQ(other_pairs, 0);
}

}  // namespace
}  // namespace collided::recorded
