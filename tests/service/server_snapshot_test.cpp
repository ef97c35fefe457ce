#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "collided/snapshot.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/server_fixture.hpp"
#include "tests/service/shell_obj.hpp"

namespace collided {
namespace {

using std::chrono::seconds;
using testing_support::ChildProcess;
using testing_support::ScratchFolder;

/// A closed cube about (50, 0, 0), of half a metre from there to a face's middle.
constexpr const char* kCube =
    "v 49.5 -.5 -.5\nv 50.5 -.5 -.5\nv 50.5 .5 -.5\nv 49.5 .5 -.5\nv 49.5 -.5 .5\nv 50.5 -.5 .5\nv 50.5 .5 .5\nv 49.5 "
    ".5 .5\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
constexpr int kQuestions = 1'000;  // of each kind and mode

void append(std::string& bits, const auto& value) { bits.append(reinterpret_cast<const char*>(&value), sizeof value); }
void append(std::string& bits, const Vec3& value) {
  bits.append(reinterpret_cast<const char*>(value.data()), sizeof(double) * 3);
}

/// All that an answer says but for object numbers, which are the server's own, and cost.
std::string bits_of(const Answer& answer) {
  std::string bits;
  append(bits, answer.verdict);
  append(bits, answer.reason);
  for (const Hit& hit : answer.hits) {
    bits += hit.object + '\0';
    append(bits, hit.triangle);
    for (const double number : {hit.distance_m, hit.error_m, hit.exit_m, hit.point_error_m}) append(bits, number);
    for (const Vec3& vector : {hit.point, hit.normal, hit.weights}) append(bits, vector);
    bits += hit.inside ? '1' : '0';
    bits += hit.by_winding ? '1' : '0';
  }
  if (answer.uncovered) append(bits, answer.uncovered->point);
  return bits;
}

class ServerSnapshot : public testing_support::ServerTest {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  ConnectOptions here() const { return {.domain = domain_, .name_space = "collided", .wait = seconds(10)}; }

  /// A server on the snapshot alone.
  Client load_elsewhere(const std::string& file) {
    other_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{COLLIDED_SERVER, "--domain", std::to_string(domain_), "--namespace", "frozen",
                                 "--state-dir", elsewhere_.path(), file},
        elsewhere_.path(), "frozen");
    EXPECT_TRUE(other_->says("ready:", seconds(20))) << other_->errors();
    return connect("frozen");
  }

  template <class Q>
  static void expect_same(Client& one, Client& other, const std::vector<Q>& questions, const AskOptions& options,
                          const std::string& what) {
    const Result<Answers> expected = one.ask(std::span<const Q>(questions), options);
    const Result<Answers> found = other.ask(std::span<const Q>(questions), options);
    ASSERT_TRUE(expected) << expected.error().message;
    ASSERT_TRUE(found) << found.error().message;
    std::size_t hits = 0;
    for (std::size_t i = 0; i < questions.size(); ++i) {
      hits += expected->answers[i].hits.size();
      ASSERT_EQ(bits_of(expected->answers[i]), bits_of(found->answers[i])) << what << ' ' << i;
    }
    EXPECT_GT(hits, options.mask == 0xffffffff ? questions.size() / 50 : 0) << what;
  }

  /// One of every kind of shape, an object each, at random poses.
  static void add_shapes(Client& client, std::mt19937_64& random) {
    std::uniform_real_distribution<double> place(-8, 8), turn(-1, 1);
    const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const std::vector<ShapePart> parts{
        SphereShape{.radius_m = 0.7},
        BoxShape{.half_m = {0.4, 0.3, 0.9}},
        CapsuleShape{.a = {0, 0, 0}, .b = {0, 0, 1}, .radius_m = 0.2},
        CylinderShape{.a = {0, 0, 0}, .b = {0, 0, 1}, .radius_m = 0.5},
        ConeShape{.apex = {0, 0, 1}, .base = {0, 0, 0}, .radius_m = 0.5},
        EllipsoidShape{.half_m = {0.5, 0.6, 0.9}},
        HullShape{.points = corners},
        MeshShape{.vertices = corners, .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}};
    for (std::size_t i = 0; i < 40; ++i) {
      const Quat rotation = Quat(turn(random), turn(random), turn(random), turn(random)).normalized();
      const ObjectOptions object{
          .name = "shape_" + std::to_string(i),
          .shape = {parts[i % parts.size()]},
          .pose = {.position = {place(random), place(random), place(random) / 4 + 2}, .rotation = rotation},
          .layers = 1U << (i % 3),
          .solid = i % 16 == 7,
          .unknown = i == 9};
      const Result<Added> added = client.add(object);
      ASSERT_TRUE(added) << added.error().message;
    }
  }

  ScratchFolder elsewhere_;
  std::unique_ptr<ChildProcess> other_;
};

// Objects before a scene, a scene with a solid before others, what was removed and added again: equal distances are in the
// order of ids there and here.
TEST_F(ServerSnapshot, AnswersAsTheServerToTheLastBit) {
  start();
  Client client = connect();
  std::mt19937_64 random = oracle::seeded(56);
  add_shapes(client, random);
  ASSERT_TRUE(client.load(folder_.write("cube.obj", kCube), {.solid = "*"}));
  ASSERT_TRUE(client.load(folder_.write("again.obj", testing_support::shell_obj(12)),
                          {.covers = {{.low = {-60, -60, -1}, .high = {60, 60, 30}}}}));
  ASSERT_TRUE(client.remove("pallet_02"));
  ASSERT_TRUE(client.remove("warehouse/wall_east"));
  for (const char* name : {"twin_b", "twin_a"})
    ASSERT_TRUE(client.add({.name = name, .shape = {BoxShape{.half_m = {1, 1, 1}}}, .pose = at(0, 5, 1)}));

  const Result<WrittenSnapshot> written = write_snapshot(here(), path("now.cscene"));
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(written->bytes, std::filesystem::file_size(path("now.cscene")));
  EXPECT_GT(written->parts, 20U);
  EXPECT_GT(written->objects, 40U);
  Client frozen = load_elsewhere(path("now.cscene"));

  std::uniform_real_distribution<double> x(-12, 12), z(-0.5, 5), turn(-1, 1), size(0, 2);
  const auto point = [&] {
    return random() % 4 == 0 ? Vec3(50 + turn(random), turn(random), turn(random))
                             : Vec3(x(random), x(random), z(random));
  };
  std::vector<RayQuestion> rays;
  std::vector<SphereQuestion> spheres;
  std::vector<BoxQuestion> boxes;
  std::vector<NearQuestion> nears;
  std::vector<InsideQuestion> insides;
  for (int i = 0; i < kQuestions; ++i) {
    rays.push_back({.origin = point(), .direction = {turn(random), turn(random), turn(random)}});
    spheres.push_back({.center = point(), .radius_m = size(random)});
    boxes.push_back({.center = point(),
                     .half_m = {size(random), size(random), size(random)},
                     .rotation = Quat(turn(random), turn(random), turn(random), turn(random)).normalized()});
    nears.push_back({.point = point()});
    insides.push_back({.point = point()});
  }
  rays.push_back({.origin = {0, 5, 9}, .direction = {0, 0, -1}});  // both twins at once
  for (const std::uint32_t mask : {0xffffffffU, 2U}) {
    for (const HitMode mode : {HitMode::closest, HitMode::all}) {
      const AskOptions options{.mode = mode, .mask = mask, .timeout = seconds(30)};
      expect_same(client, frozen, rays, options, "ray");
      expect_same(client, frozen, spheres, options, "sphere");
      expect_same(client, frozen, boxes, options, "box");
      expect_same(client, frozen, insides, options, "inside");
    }
    expect_same(client, frozen, nears, {.mask = mask, .max_hits = 3, .timeout = seconds(30)}, "near");
    expect_same(client, frozen, nears, {.mode = HitMode::signed_near, .mask = mask, .timeout = seconds(30)},
                "signed near");
  }
}

TEST_F(ServerSnapshot, SaysWhatItDoesNotCarryOver) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add({.name = "cart", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(0, 0, 3)}));
  ASSERT_TRUE(client.add({.name = "load", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(0, 0, 4)}));
  ASSERT_TRUE(client.attach("load", "cart"));
  ASSERT_TRUE(client.allow("cart", "load"));
  const Result<WrittenSnapshot> written = write_snapshot(here(), path("now.cscene"));
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(written->lacks, (std::vector<std::string>{"2 velocities", "1 rule of allow and deny", "1 attachment"}));
}

TEST_F(ServerSnapshot, OfAnEmptyWorldIsAnEmptyScene) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.clear({}));
  ASSERT_TRUE(client.clear({.moving = true}));
  const Result<WrittenSnapshot> written = write_snapshot(here(), path("empty.cscene"));
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(written->parts + written->objects + written->triangles, 0U);
  Client frozen = load_elsewhere(path("empty.cscene"));
  const Result<Answer> answer = frozen.ask(RayQuestion{.origin = {0, 0, 5}, .direction = {0, 0, -1}});
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->verdict, Verdict::miss);
}

// The file under the name is the old one or the new one, and nothing is left beside it.
TEST_F(ServerSnapshot, ReplacesAFileOnlyByAWholeOne) {
  start();
  Client client = connect();
  const std::string file = folder_.write("now.cscene", "old");
  const auto content = [&] {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const Result<WrittenSnapshot> ended = write_snapshot(here(), file, [](double) { return false; });
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, ErrorCode::refused);
  EXPECT_EQ(content(), "old");
  EXPECT_FALSE(std::filesystem::exists(file + ".part"));

  const Result<WrittenSnapshot> nowhere = write_snapshot(here(), path("no_folder/now.cscene"));
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::bad_input);
  EXPECT_NE(nowhere.error().message.find("No such file"), std::string::npos) << nowhere.error().message;

  // A device without room, where the file beside would be.
  std::filesystem::create_symlink("/dev/full", path("full.cscene.part"));
  const Result<WrittenSnapshot> full = write_snapshot(here(), path("full.cscene"));
  ASSERT_FALSE(full);
  EXPECT_NE(full.error().message.find("No space"), std::string::npos) << full.error().message;
  EXPECT_FALSE(std::filesystem::exists(path("full.cscene")));

  ASSERT_TRUE(write_snapshot(here(), file));
  EXPECT_GT(content().size(), 1'000U);
}

}  // namespace
}  // namespace collided
