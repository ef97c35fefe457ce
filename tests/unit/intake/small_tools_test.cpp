#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "server/intake/mesh/segment_grid.hpp"
#include "server/intake/mesh/shape_scale.hpp"
#include "server/intake/parallel.hpp"
#include "server/intake/polygons/sweep_triangulation.hpp"
#include "server/intake/readers/json_view.hpp"
#include "server/intake/readers/obj_chunk.hpp"
#include "server/intake/readers/srdf.hpp"
#include "server/intake/simplify/growing_tree.hpp"
#include "tests/oracle/seed.hpp"

// What the readers are built on, each by itself.
namespace collided::engine {
namespace {

using BoxPairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

BoxPairs found_by(GrowingTree& tree, const std::vector<Aabb>& asked) {
  std::vector<GrowingTree::Meeting> meetings;
  tree.find(asked, meetings);
  BoxPairs pairs;
  for (const auto& [asked_index, triangle] : meetings) {
    EXPECT_TRUE(pairs.insert({asked_index, triangle}).second) << "found twice";
  }
  return pairs;
}

// Whole numbers are a millionth apart from nothing that they do not touch, so rounding outward adds none.
TEST(IntakeGrowingTree, FindsTheBoxesAsTheyAreNowAndNoOthers) {
  std::mt19937_64 random = oracle::seeded(421);
  const auto whole = [&](int end) { return static_cast<double>(random() % static_cast<unsigned>(end)); };
  for (int round = 0; round < 30; ++round) {
    std::vector<Vec3> vertices(90);
    for (Vec3& vertex : vertices) vertex = {100 + whole(40), whole(40) - 300, whole(40)};
    std::vector<TriangleCorners> corners(1 + random() % 120);
    std::map<std::uint32_t, Aabb> boxes;
    std::vector<std::uint32_t> taken;
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
      const auto first = static_cast<std::uint32_t>(random() % 88);
      corners[i] = {first, first + 1, first + 2};
      if (random() % 4 == 0) continue;
      taken.push_back(i);
      for (const std::uint32_t corner : corners[i]) boxes[i].extend(vertices[corner]);
    }
    GrowingTree tree;
    tree.build(vertices, corners, taken);
    for (int step = 0; step < 30; ++step) {
      std::vector<Aabb> asked(random() % 4);
      for (Aabb& box : asked) {
        const Vec3 low(95 + whole(50), whole(50) - 305, whole(50) - 5);
        box = {low, low + Vec3(whole(9), whole(9), whole(9))};
      }
      BoxPairs expected;
      for (std::uint32_t i = 0; i < asked.size(); ++i) {
        for (const auto& [triangle, box] : boxes) {
          if (overlaps(asked[i], box)) expected.insert({i, triangle});
        }
      }
      ASSERT_EQ(found_by(tree, asked), expected);
      if (boxes.empty()) break;
      const std::uint32_t changed =
          std::next(boxes.begin(), static_cast<std::ptrdiff_t>(random() % boxes.size()))->first;
      if (random() % 3 == 0) {
        tree.remove(changed);
        boxes.erase(changed);
      } else {
        const Vec3 low(90 + whole(60), whole(60) - 310, whole(60) - 10);
        boxes[changed] = {low, low + Vec3(whole(5), whole(5), whole(5))};
        tree.update(changed, boxes[changed]);
      }
    }
  }
}

// Up from 1 and down from 1 + 2^-22 are one float: rounded outward the boxes touch, and to touch is to overlap.
TEST(IntakeGrowingTree, BoxesThatTouchOnceTheyAreRoundedAreFound) {
  const std::vector<Vec3> vertices{{0, 0, 0}, {1, 1, 1}, {-1, -1, -1}};
  GrowingTree tree;
  tree.build(vertices, {{0, 1, 2}}, {0});
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      for (const auto& [apart, is_found] : {std::pair{0x1p-22, true}, {0x1p-20, false}}) {
        Aabb summand{Vec3::Constant(-1), Vec3::Constant(1)};
        summand.low[axis] = side > 0 ? 1 + apart : -3;
        summand.high[axis] = side > 0 ? 3 : -1 - apart;
        EXPECT_EQ(found_by(tree, {summand}).size(), is_found ? 1u : 0u) << axis << ' ' << side << ' ' << apart;
      }
    }
  }
}

/// A JSON text with what its views refer to.
struct JsonText {
  explicit JsonText(const std::string& text)
      : bytes(text),
        reading{.file = "a.json", .bytes = bytes, .options = options, .report = report},
        value(parse_json(reading, bytes)) {}
  JsonView root() const { return {reading, value}; }

  std::string bytes;
  LoadOptions options;
  LoadReport report;
  Reading reading;
  nlohmann::json value;
};

template <class Ask>
std::string complaint_of(const Ask& ask) {
  try {
    ask();
  } catch (const LoadError& error) { return error.what(); }
  return "taken";
}

TEST(IntakeJsonView, ANumberOfSomethingIsWholeAndBelowItsEnd) {
  const JsonText text("[7, -0, 9223372036854775808, -1, 1.5, \"x\"]");
  const auto index = [&](std::size_t i, std::uint64_t end) { return text.root().at(i).index(end); };
  EXPECT_EQ(index(0, 8), 7u);
  EXPECT_EQ(index(1, 8), 0u);
  EXPECT_EQ(index(2, 9223372036854775809u), 9223372036854775808u);
  EXPECT_EQ(complaint_of([&] { index(0, 7); }), "a.json: /0 is 7, allowed are numbers below 7. Nothing was loaded.");
  EXPECT_EQ(complaint_of([&] { index(2, 7); }),
            "a.json: /2 is 9223372036854775808, allowed are numbers below 7. Nothing was loaded.");
  for (const std::size_t i : {3u, 4u, 5u}) {
    EXPECT_EQ(complaint_of([&] { index(i, 7); }),
              "a.json: /" + std::to_string(i) + " is not a whole number of 0 or more. Nothing was loaded.");
  }
}

TEST(IntakeJsonView, ComplaintsNameTheWayFromTheRoot) {
  const JsonText text(R"({"a": [{"b": 1}, {"b": "c"}], "n": 2})");
  const JsonView root = text.root();
  EXPECT_EQ(complaint_of([&] { root.at("a").at(1).at("b").number(); }),
            "a.json: /a/1/b is not a number. Nothing was loaded.");
  EXPECT_EQ(complaint_of([&] { root.at("a").at(std::size_t{0}).at("b").text(); }),
            "a.json: /a/0/b is not text. Nothing was loaded.");
  EXPECT_EQ(complaint_of([&] { root.element("a", 2); }),
            "a.json: /a has 2 elements, number 2 is asked for. Nothing was loaded.");
  EXPECT_EQ(complaint_of([&] { root.at("a").at("b"); }), "a.json: /a is not an object. Nothing was loaded.");
  EXPECT_EQ(complaint_of([&] { root.at("d"); }), "a.json: the root has no member \"d\". Nothing was loaded.");
  EXPECT_EQ(complaint_of([&] { root.at(std::size_t{0}); }), "a.json: the root is not an array. Nothing was loaded.");
  EXPECT_EQ(root.element("a", 1).text_or("b", "d"), "c");
  EXPECT_EQ(root.element("a", 1).text_or("c", "d"), "d");
  EXPECT_EQ(root.index_or("n", 3, 9), 2u);
  EXPECT_EQ(root.index_or("m", 3, 9), 9u);
  EXPECT_EQ(root.size_of("a"), 2u);
  EXPECT_EQ(root.size_of("m"), 0u);
  EXPECT_TRUE(root.has("a"));
  EXPECT_FALSE(root.has("b"));
  EXPECT_FALSE(root.at("a").has("b")) << "an array has no members";
  EXPECT_FALSE(root.at("n").has("b"));
}

// Each of its own tasks that was done is told of, none that failed.
TEST(IntakeParallel, AfterATaskThatFailedNothingIsTold) {
  std::vector<std::size_t> told;
  const auto tell = [&](std::size_t done) { told.push_back(done); };
  EXPECT_THROW(run_in_parallel(
                   1, [](std::size_t) { throw std::runtime_error("0"); }, tell),
               std::runtime_error);
  EXPECT_TRUE(told.empty());
  run_in_parallel(
      1, [](std::size_t) {}, tell);
  EXPECT_EQ(told, std::vector<std::size_t>{1});
  run_in_parallel(
      0, [](std::size_t) { ADD_FAILURE(); }, tell);
  EXPECT_EQ(told.size(), 1u);
}

TEST(IntakeParallel, EveryTaskRunsOnceAndOfThoseThatFailTheFirstIsThrown) {
  std::vector<std::atomic<int>> runs(100);
  run_in_parallel(
      runs.size(), [&](std::size_t i) { ++runs[i]; }, [](std::size_t) {});
  for (const auto& count : runs) EXPECT_EQ(count, 1);
  for (int round = 0; round < 50; ++round) {
    try {
      run_in_parallel(
          40,
          [](std::size_t i) {
            if (i % 7 == 5) throw std::runtime_error(std::to_string(i));
          },
          [](std::size_t) {});
      ADD_FAILURE() << "nothing was thrown";
    } catch (const std::runtime_error& error) { EXPECT_STREQ(error.what(), "5"); }
  }
}

TEST(IntakeSrdf, PairsOfAnyNumberOfLinksAreAllowed) {
  Scene robot;
  for (int i = 0; i < 70; ++i) robot.objects.push_back({.name = "link_" + std::to_string(i)});
  EXPECT_EQ(allow_pairs({{"link_0", "link_69"},
                         {"link_4", "nobody"},
                         {"nobody", "link_4"},
                         {"link_5", "link_2"},
                         {"link_2", "link_5"}},
                        robot),
            2u);
  for (const SceneObject& a : robot.objects) {
    EXPECT_TRUE(may_meet(a.filter, Filter{.layers = 8, .mask = 1})) << "layers are the user's: " << a.name;
    for (const SceneObject& b : robot.objects) {
      const auto is = [&](const char* one, const char* other) { return a.name == one && b.name == other; };
      EXPECT_EQ(robot.allowed_pairs->contains(a.number, b.number),
                is("link_0", "link_69") || is("link_69", "link_0") || is("link_5", "link_2") || is("link_2", "link_5"))
          << a.name << ' ' << b.name;
    }
  }
}

std::vector<std::uint32_t> near(const SegmentGrid& grid, const Vec3& point) {
  std::vector<std::uint32_t> numbers;
  grid.visit_near(point, [&](std::uint32_t i) { numbers.push_back(i); });
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

TEST(IntakeSegmentGrid, NeverMissesASegmentInReachAndNamesNoneTwice) {
  std::mt19937_64 random = oracle::seeded(422);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto anywhere = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  for (const double reach_m : {0.0, 1e-9, 0.03}) {
    std::vector<MeshSegment> segments;
    Aabb bounds;
    for (int i = 0; i < 400; ++i) {
      const Vec3 a = anywhere();
      segments.push_back(
          {a, a + std::ldexp(1.0, -static_cast<int>(random() % 50)) * (i % 9 == 0 ? Vec3::Zero() : anywhere())});
      bounds.extend(segments.back().a);
      bounds.extend(segments.back().b);
    }
    const SegmentGrid grid(segments, bounds, reach_m);
    for (std::uint32_t i = 0; i < segments.size(); ++i) {
      const MeshSegment& s = segments[i];
      for (const double share : {0.0, 0.5, 1.0}) {
        const std::vector<std::uint32_t> seen = near(grid, s.a + share * (s.b - s.a) + 0.57 * reach_m * anywhere());
        EXPECT_TRUE(std::binary_search(seen.begin(), seen.end(), i)) << i << ' ' << share << ' ' << reach_m;
        EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
      }
    }
  }
}

// However small a segment is beside the whole, its cells still lie about it alone.
TEST(IntakeSegmentGrid, SegmentsWithoutLengthAreSeenFromTheirOwnPlaces) {
  std::vector<MeshSegment> points;
  for (int i = 0; i < 100; ++i) points.push_back({Vec3(i, 0, 0), Vec3(i, 0, 0)});
  const SegmentGrid grid(points, {Vec3::Zero(), {99, 0, 0}}, 0);
  for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(near(grid, points[i].a), std::vector<std::uint32_t>{i});
  EXPECT_TRUE(near(grid, {0.5, 0, 0}).empty());
  EXPECT_TRUE(near(SegmentGrid({}, {}, 1), Vec3::Zero()).empty());
}

std::string refusal_of(std::vector<Primitive> primitives, const Vec3& factor) {
  Shape shape{std::move(primitives), nullptr};
  return scale(shape, factor);
}

TEST(IntakeShapeScale, TheFirstReasonIsTheOneThatIsSaid) {
  const Sphere sphere{{0, 0, 0}, 1};
  const Capsule capsule{{0, 0, 0}, {1, 0, 0}, 1};
  EXPECT_EQ(refusal_of({sphere, capsule}, {1, 2, 1}),
            "scale (1, 2, 1): a sphere would become an ellipsoid; one factor for all axes is allowed");
  EXPECT_EQ(refusal_of({capsule, sphere}, {1, 1, 2}),
            "scale (1, 1, 2): a capsule would become no capsule; one factor for all axes is allowed");
  EXPECT_EQ(refusal_of({Sphere{{1e300, 0, 0}, 1e300}}, Vec3::Constant(1e300)),
            "scale (1e+300, 1e+300, 1e+300): a coordinate would exceed 1e290 m");
  EXPECT_EQ(refusal_of({Sphere{{0, 0, 0}, 1e300}}, Vec3::Constant(1e300)),
            "scale (1e+300, 1e+300, 1e+300): a length would exceed 1e290 m");
  const std::string one_factor = "; one factor for all axes is allowed";
  const std::string scale_text = "scale (2, 1, 1): ";
  EXPECT_EQ(refusal_of({Cylinder{{0, 0, 0}, {1, 0, 0}, 1}}, {2, 1, 1}),
            scale_text + "a cylinder would become no cylinder" + one_factor);
  EXPECT_EQ(refusal_of({Cone{{0, 0, 0}, {1, 0, 0}, 1}}, {2, 1, 1}),
            scale_text + "a cone would become no cone" + one_factor);
  EXPECT_EQ(refusal_of({HalfSpace{{0, 0, 0}, {0, 0, 1}}}, {2, 1, 1}),
            scale_text + "a half-space would become another normal" + one_factor);
  const Mat3 turned = Quat(0.8, 0.6, 0, 0).toRotationMatrix();
  EXPECT_EQ(refusal_of({Box{.center = {0, 0, 0}, .axes = turned, .half_m = {1, 2, 3}}}, {2, 1, 1}),
            scale_text + "a turned box would become no box" + one_factor);
  EXPECT_EQ(refusal_of({Ellipsoid{.center = {0, 0, 0}, .axes = turned, .half_m = {1, 2, 3}}}, {2, 1, 1}),
            scale_text + "a turned ellipsoid would get other axes" + one_factor);
  const std::string tiny = "scale (1e-200, 1e-200, 1e-200): ";
  EXPECT_EQ(refusal_of({Cylinder{{1e-200, 0, 0}, {2e-200, 0, 0}, 1}}, Vec3::Constant(1e-200)),
            tiny + "a cylinder would have no length");
  EXPECT_EQ(refusal_of({Cone{{1e-200, 0, 0}, {2e-200, 0, 0}, 1}}, Vec3::Constant(1e-200)),
            tiny + "a cone would have no height");
  EXPECT_EQ(refusal_of({Ellipsoid{.center = {0, 0, 0}, .axes = Mat3::Identity(), .half_m = {1, 1, 1e-200}}},
                       Vec3::Constant(1e-200)),
            tiny + "an ellipsoid would have no thickness");
  for (const Vec3& factor : {Vec3(0, 1, 1), Vec3(1, -1, 1), Vec3(1, 1, std::numeric_limits<double>::infinity())}) {
    EXPECT_NE(refusal_of({sphere}, factor).find("factors must be finite and above 0; mirror images are not offered"),
              std::string::npos);
  }
}

// A quarter turn about z: the box's own first axis is the world's y.
TEST(IntakeShapeScale, ABoxAlongTheAxesTakesTheFactorOfTheAxisThatEachSideLiesAlong) {
  Mat3 quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Shape shape{{Box{.center = {1, 1, 1}, .axes = quarter, .half_m = {1, 2, 3}},
               Ellipsoid{.center = {1, 2, 3}, .axes = quarter, .half_m = {1, 2, 3}}},
              nullptr};
  ASSERT_EQ(scale(shape, {2, 5, 11}), "");
  const Box box = std::get<Box>(shape.primitives[0]);
  EXPECT_EQ(box.center, Vec3(2, 5, 11));
  EXPECT_EQ(box.half_m, Vec3(5, 4, 33));
  EXPECT_EQ(box.axes, quarter);
  EXPECT_EQ(std::get<Ellipsoid>(shape.primitives[1]).center, Vec3(2, 10, 33));
  EXPECT_EQ(std::get<Ellipsoid>(shape.primitives[1]).half_m, Vec3(5, 4, 33));
}

TEST(IntakeShapeScale, OneFactorMultipliesEveryPlaceAndSize) {
  const Mat3 turned = Quat(0.8, 0.6, 0, 0).toRotationMatrix();
  Shape shape{{Sphere{{1, 2, 3}, 4}, Capsule{{1, 2, 3}, {4, 5, 6}, 7}, Cylinder{{1, 2, 3}, {4, 5, 6}, 7},
               Cone{{1, 2, 3}, {4, 5, 6}, 7}, Box{.center = {1, 2, 3}, .axes = turned, .half_m = {4, 5, 6}},
               HalfSpace{{1, 2, 3}, {0, 0, 1}}},
              nullptr};
  ASSERT_EQ(scale(shape, Vec3::Constant(2)), "");
  const auto& sphere = std::get<Sphere>(shape.primitives[0]);
  EXPECT_EQ(sphere.center, Vec3(2, 4, 6));
  EXPECT_EQ(sphere.radius_m, 8);
  const auto& capsule = std::get<Capsule>(shape.primitives[1]);
  const auto& cylinder = std::get<Cylinder>(shape.primitives[2]);
  const auto& cone = std::get<Cone>(shape.primitives[3]);
  for (const Vec3& first : {capsule.a, cylinder.a, cone.apex}) EXPECT_EQ(first, Vec3(2, 4, 6));
  for (const Vec3& second : {capsule.b, cylinder.b, cone.base}) EXPECT_EQ(second, Vec3(8, 10, 12));
  for (const double radius_m : {capsule.radius_m, cylinder.radius_m, cone.radius_m}) EXPECT_EQ(radius_m, 14);
  const auto& box = std::get<Box>(shape.primitives[4]);
  EXPECT_EQ(box.center, Vec3(2, 4, 6));
  EXPECT_EQ(box.half_m, Vec3(8, 10, 12));
  EXPECT_EQ(std::get<HalfSpace>(shape.primitives[5]).point, Vec3(2, 4, 6));
}

// Lines of two to nine megabytes among short ones, joined by backslashes where a chunk would end.
TEST(IntakeObjSplitter, ChunksAreWholeLinesInOrderAndTheFileIsAskedForPieceByPiece) {
  std::string text;
  while (text.size() < 1'900'000) text += "v 1 2 3\n";
  text.append("#").append(9'000'000, 'x').append("\n");
  while (text.size() < 13'500'000) text += "f 1 \\\r\n 2 \\\n 3\n";
  text.append("#").append(2'500'000, 'y');
  LoadReport report;
  const LoadOptions options;
  std::vector<std::size_t> asked{0};
  const Reading reading{
      .file = "a.obj", .bytes = text, .options = options, .report = report, .fetch = [&](const char* end) {
        asked.push_back(static_cast<std::size_t>(end - text.data()));
      }};
  ObjSplitter splitter(reading);
  std::size_t begin = 0;
  std::int64_t lines = 0;
  std::size_t chunk_count = 0;
  for (ObjChunk chunk = splitter.next(); !chunk.text.empty(); chunk = splitter.next()) {
    ASSERT_EQ(chunk.text.data(), text.data() + begin);
    EXPECT_EQ(chunk.lines_before, lines);
    begin += chunk.text.size();
    lines += std::count(chunk.text.begin(), chunk.text.end(), '\n');
    ++chunk_count;
    if (begin == text.size()) continue;
    EXPECT_GE(chunk.text.size(), 2u << 20);
    EXPECT_TRUE(chunk.text.ends_with("\n"));
    EXPECT_FALSE(chunk.text.ends_with("\\\n") || chunk.text.ends_with("\\\r\n"));
  }
  EXPECT_EQ(begin, text.size());
  EXPECT_LE(chunk_count, splitter.chunk_count_at_most());
  EXPECT_EQ(asked.back(), text.size());
  for (std::size_t i = 1; i < asked.size(); ++i) {
    EXPECT_GE(asked[i], asked[i - 1]);
    EXPECT_LE(asked[i], asked[i - 1] + (2u << 20) + 4096);
  }
}

TEST(IntakeSweep, AFlawNamesItsTwoPoints) {
  const auto flaw = [](std::vector<PlanePoint> hole) {
    std::vector<PlanePoint> points{{0, 0}, {9, 0}, {9, 9}, {0, 9}};
    points.insert(points.end(), hole.begin(), hole.end());
    std::vector<TriangleCorners> triangles;
    const std::vector<std::uint32_t> ends{4, static_cast<std::uint32_t>(points.size())};
    const auto found = triangulate_by_sweep(points, ends, triangles);
    EXPECT_TRUE(triangles.empty());
    return found.value_or(PolygonFlaw{99, 99});
  };
  EXPECT_EQ(flaw({{1, 1}, {2, 1}, {2, 3}, {1, 1}}), PolygonFlaw(4, 7)) << "two corners in one place";
  EXPECT_EQ(flaw({{9, 9}, {2, 1}, {2, 3}}), PolygonFlaw(2, 4)) << "on a corner of the border";
  EXPECT_EQ(flaw({{2, 2}, {4, 2}}), PolygonFlaw(4, 4)) << "two corners make no ring";
  EXPECT_EQ(flaw({{2, 2}, {4, 2}, {6, 2}}), PolygonFlaw(6, 4)) << "without area";
}

}  // namespace
}  // namespace collided::engine
