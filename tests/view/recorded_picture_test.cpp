#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "client/library/publishing/shape_encoding.hpp"
#include "client/view/recording.hpp"
#include "collided/recording.hpp"
#include "idl/cdr.hpp"
#include "idl/mcap/output.hpp"
#include "idl/recording/recorded_topics.hpp"
#include "idl/scene_tables.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided {
namespace {

using nlohmann::json;
using recording::Recorded;
using std::chrono::nanoseconds;

constexpr std::int64_t kBegin_ns = 1'000'000'000;
constexpr std::int64_t kStep_ns = 200'000'000;

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }
std::vector<std::uint8_t> encoded(const Shape& shape) {
  return *client::encode_shape(shape, Vec3::Ones(), "test", {}, false);
}
std::vector<std::uint8_t> ball() { return encoded({SphereShape{.radius_m = 0.25}}); }
json at(double x) { return {x, 0, 0, 1, 0, 0, 0}; }

/// Writes a recording, a sample each 0.2 s after the opening, and a sample a chunk.
class RecordingFile {
 public:
  explicit RecordingFile(const std::string& path, std::uint64_t opening = 0)
      : output_(path), writer_(output_, "test", channels()), opening_left_(opening) {
    writer_.metadata("recording", {{"opening_messages", std::to_string(opening)}});
  }
  void define(std::uint32_t number, const std::string& name, const std::vector<std::uint8_t>& shape) {
    dds::Sample<wire::Definition> definition;
    definition->publisher = 7;
    definition->object_number = number;
    definition->moving = true;
    definition->orientation[0] = 1;
    definition->layers = definition->mask = 1;
    static_cast<void>(dds::set_text(definition->name, name));
    dds::borrow(definition->shape, shape);
    add(Recorded::object, *definition);
  }
  void pose(std::uint32_t number, double x) {
    dds::Sample<wire::PoseBatch> batch;
    batch->publisher = 7;
    const std::vector<std::uint32_t> numbers{number};
    const std::vector<double> position{x, 0, 0}, orientation{1, 0, 0, 0};
    dds::borrow(batch->object_numbers, numbers);
    dds::borrow(batch->positions, position);
    dds::borrow(batch->orientations, orientation);
    add(Recorded::pose, *batch);
  }
  void query(const json& command, const std::vector<std::uint8_t>& shape = {}) {
    dds::Sample<wire::Query> query;
    query->client = 9;
    query->request = ++requests_;
    query->chunk_count = 1;
    query->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::command);
    static_cast<void>(dds::set_text(query->text, command.dump()));
    dds::borrow(query->blob, shape);
    add(Recorded::query, *query);
  }
  void reply(const json& answer, wire_contract::ReplyStatus status = wire_contract::ReplyStatus::ok) {
    dds::Sample<wire::Reply> reply;
    reply->client = 9;
    reply->request = requests_;
    reply->chunk_count = 1;
    reply->status = static_cast<std::uint8_t>(status);
    const std::vector<std::uint8_t> text = bytes_of(answer.dump());
    dds::borrow(reply->text, text);
    add(Recorded::reply, *reply);
  }
  void done(const json& command, const json& answer, const std::vector<std::uint8_t>& shape = {}) {
    query(command, shape);
    reply(answer);
  }
  void lost() {
    dds::Sample<wire::Status> status;
    const std::vector<std::uint64_t> publishers{7}, applied{1};
    const std::vector<std::int64_t> silent{0};
    const std::vector<std::uint8_t> states{static_cast<std::uint8_t>(wire_contract::PublisherState::lost)};
    dds::borrow(status->publishers, publishers);
    dds::borrow(status->applied_sequences, applied);
    dds::borrow(status->silent_ns, silent);
    dds::borrow(status->publisher_states, states);
    add(Recorded::status, *status);
  }
  void add_bytes(Recorded topic, std::string_view bytes) {
    const auto time = static_cast<std::uint64_t>(now_ns_);
    writer_.write(static_cast<std::uint16_t>(topic), time, time, std::as_bytes(std::span(bytes)));
    writer_.flush();
    if (opening_left_ > 0) --opening_left_;
    else now_ns_ += kStep_ns;
  }
  nanoseconds now() const { return nanoseconds(now_ns_ - kBegin_ns); }
  void close() { writer_.close(); }

 private:
  static std::vector<mcap::ChannelDescription> channels() { return recording::channels_of("collided"); }
  template <class T>
  void add(Recorded topic, const T& sample) {
    const std::vector<std::byte> bytes = wire::cdr_bytes(sample);
    add_bytes(topic, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }

  mcap::FileOutput output_;
  mcap::FileWriter writer_;
  std::uint64_t opening_left_;
  std::uint64_t requests_ = 0;
  std::int64_t now_ns_ = kBegin_ns;
};

/// The tables and poses that a recording shows, by time.
struct ShownPicture {
  std::map<nanoseconds, std::shared_ptr<const ShownObjects>> tables;
  std::map<nanoseconds, Poses> poses;
  RecordedPicture read;

  const ShownObjects& table_at(nanoseconds time) const { return *std::prev(tables.upper_bound(time))->second; }
  std::set<std::string> names_at(nanoseconds time) const {
    std::set<std::string> names;
    for (const ShownObject& object : table_at(time).objects) names.insert(object.name);
    return names;
  }
  const ShownObject* object(const std::string& name, nanoseconds time = nanoseconds::max()) const {
    for (const ShownObject& object : table_at(time).objects)
      if (object.name == name) return &object;
    return nullptr;
  }
  std::optional<double> x_of(const std::string& name, nanoseconds time) const {
    const ShownObject* const shown = object(name, time);
    const Poses& frame = std::prev(poses.upper_bound(time))->second;
    for (std::size_t i = 0; shown != nullptr && i < frame.ids.size(); ++i)
      if (frame.ids[i] == shown->id) return frame.poses[i].position.x();
    return std::nullopt;
  }
};

class RecordedPictureTest : public testing::Test {
 protected:
  ShownPicture show(std::shared_ptr<const ShownObjects> surroundings = {}) const {
    ShownPicture shown;
    const PictureOptions options{.surroundings = std::move(surroundings), .table = nanoseconds(0)};
    const Result<RecordedPicture> read = recorded_picture(path, options, [&](const PictureChange& change) {
      if (const auto* table = std::get_if<std::shared_ptr<const ShownObjects>>(&change.what))
        shown.tables[change.at] = *table;
      if (const auto* poses = std::get_if<Poses>(&change.what)) shown.poses[change.at] = *poses;
    });
    EXPECT_TRUE(read) << read.error().message;
    if (read) shown.read = *read;
    return shown;
  }
  std::string why_not(const std::string& contents) {
    folder.write("refused.mcap", contents);
    const Result<std::string> run = view::run_of_recording(folder.path() + "/refused.mcap", {}, [] { return false; });
    return run ? "it was read" : run.error().message;
  }

  testing_support::ScratchFolder folder;
  const std::string path = folder.path() + "/run.mcap";
};

TEST_F(RecordedPictureTest, CommandsDoWhatTheirAnswersReport) {
  auto scene = std::make_shared<ShownObjects>();
  for (const char* name : {"shelf_1", "shelf_2"}) scene->objects.emplace_back().name = name;
  RecordingFile file(path, 3);
  file.query({{"command", "add"}, {"name", "crate_0"}, {"pose", at(0)}}, ball());
  file.query({{"command", "add"}, {"name", "lamp"}, {"pose", at(0)}}, ball());
  file.query({{"command", "remove"}, {"name", "shelf_[1]"}});
  file.done({{"command", "add"}, {"name", "crate_1"}, {"pose", at(1)}}, json::object(), ball());
  file.done({{"command", "add"}, {"name", "crate_2"}, {"pose", at(1)}, {"scale", {2, 2, 2}}}, json::object(), ball());
  file.done({{"command", "add"}, {"name", "Crate_3"}, {"pose", at(1)}}, json::object(), ball());
  file.query({{"command", "move"}, {"name", "crate_1"}, {"pose", at(9)}});
  file.reply({{"message", "no"}}, wire_contract::ReplyStatus::refused);
  file.query({{"command", "add"}, {"name", "refused"}, {"pose", at(0)}}, ball());
  file.reply({{"message", "no"}}, wire_contract::ReplyStatus::refused);
  file.query({{"command", "add"}, {"name", "unanswered"}, {"pose", at(0)}}, ball());
  file.done({{"command", "attach"}, {"child", "crate_2"}, {"parent", "crate_1"}}, {{"pose", {0, 1, 0, 1, 0, 0, 0}}});
  file.done({{"command", "move"}, {"name", "crate_1"}, {"pose", {5, 0, 0, M_SQRT1_2, 0, 0, M_SQRT1_2}}},
            json::object());
  const nanoseconds before_removal = file.now();
  file.done({{"command", "remove"}, {"name", "crate_*"}},
            {{"removed", {"crate_0", "crate_1"}}, {"detached", {"crate_2"}}});
  file.done({{"command", "move"}, {"name", "lamp"}, {"pose", at(3)}}, json::object());
  file.close();
  const ShownPicture shown = show(scene);
  using Names = std::set<std::string>;
  EXPECT_EQ(shown.names_at(before_removal), (Names{"Crate_3", "crate_0", "crate_1", "crate_2", "lamp", "shelf_2"}));
  EXPECT_EQ(shown.x_of("crate_1", before_removal), 5);
  EXPECT_NEAR(*shown.x_of("crate_2", before_removal), 4, 1e-12) << "it goes along, turned";
  EXPECT_EQ(std::get<SphereShape>(shown.object("crate_2")->parts.at(0)).radius_m, 0.5) << "scaled";
  EXPECT_EQ(shown.names_at(nanoseconds::max()), (Names{"Crate_3", "crate_2", "lamp", "shelf_2"}));
  EXPECT_NEAR(*shown.x_of("crate_2", nanoseconds::max()), 4, 1e-12) << "what was attached stays where it was";
  EXPECT_EQ(shown.x_of("lamp", nanoseconds::max()), 3);
}

TEST_F(RecordedPictureTest, ALostPublishersObjectsLeave) {
  RecordingFile file(path);
  file.define(1, "drone", ball());
  file.pose(1, 2);
  const nanoseconds before = file.now();
  file.pose(1, 3);
  file.lost();
  file.done({{"command", "add"}, {"name", "lamp"}, {"pose", at(0)}}, json::object(), ball());
  file.close();
  const ShownPicture shown = show();
  EXPECT_EQ(shown.x_of("drone", before), 2);
  EXPECT_EQ(shown.names_at(nanoseconds::max()), std::set<std::string>{"lamp"}) << "its policy is to remove them";
}

/// The area and the volume within the surfaces of an object.
std::pair<double, double> measured(const ShownObject& object) {
  double area = 0, volume = 0;
  for (const SurfaceRun& run : object.runs) {
    for (const auto& [i, j, k] : run.surface->triangles) {
      const auto& v = run.surface->vertices;
      const Vec3 normal = (v[j] - v[i]).cross(v[k] - v[i]);
      area += normal.norm() / 2;
      volume += v[i].dot(normal) / 6;
    }
  }
  return {area, volume};
}

TEST_F(RecordedPictureTest, EveryKindOfShapeIsAsTheServerShowsIt) {
  HullShape hull;
  for (int i = 0; i < 30; ++i) hull.points.emplace_back(0.1 + 0.027 * i, 0.5, 0.9 - 0.025 * i);
  for (int bits = 0; bits < 8; ++bits) hull.points.emplace_back(bits & 1, bits >> 1 & 1, bits >> 2);
  RecordingFile file(path);
  file.define(1, "hull", *client::encode_shape({hull}, {2, 2, 2}, "test", {}, false));
  file.define(2, "heights", encoded({HeightFieldShape{3, 0.5, 1, std::vector<double>(6, 0.0)}}));
  file.define(3, "cloud", encoded({CloudShape{{{1, 2, 3}, {4, 5, 6}}, 0.1}}));
  file.define(4, "line", encoded({PolylineShape{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, 0.1}}));
  // An L of five cells along x and y, and one above its corner.
  file.define(5, "voxels", encoded({VoxelShape{0.5, {-1, 0, 4}, {3, 3, 2}, {0b01001111, 0b00000010, 0}}}));
  file.define(6, "noise", bytes_of("no FlatBuffer at all"));
  file.close();
  const ShownPicture shown = show();
  const auto [hull_area, hull_volume] = measured(*shown.object("hull"));
  EXPECT_NEAR(hull_area, 24, 1e-9);
  EXPECT_NEAR(hull_volume, 8, 1e-9);
  EXPECT_NEAR(measured(*shown.object("heights")).first, 1, 1e-12);
  const Shape& balls = shown.object("cloud")->parts;
  ASSERT_EQ(balls.size(), 2U);
  EXPECT_EQ(std::get<SphereShape>(balls[1]).center, Vec3(4, 5, 6));
  const Shape& rods = shown.object("line")->parts;
  ASSERT_EQ(rods.size(), 2U);
  EXPECT_EQ(std::get<CapsuleShape>(rods[1]).b, Vec3(1, 1, 0));
  const Shape& boxes = shown.object("voxels")->parts;
  ASSERT_EQ(boxes.size(), 3U);
  EXPECT_EQ(std::get<BoxShape>(boxes[0]).center, Vec3(0.25, 0.25, 2.25));
  EXPECT_EQ(std::get<BoxShape>(boxes[1]).half_m, Vec3(0.25, 0.5, 0.25));
  EXPECT_EQ(std::get<BoxShape>(boxes[2]).center, Vec3(-0.25, 0.25, 2.75));
  EXPECT_EQ(shown.object("noise"), nullptr);
  ASSERT_EQ(shown.read.warnings.size(), 1U);
  EXPECT_NE(shown.read.warnings[0].find("1 samples do not hold"), std::string::npos);
}

// Renderers' buffers come from publishers that are not of this library.
TEST_F(RecordedPictureTest, VertexBuffersAreWhatTheirKindSays) {
  using Kind = format::BufferKind;
  const std::vector<double> square{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  const auto buffer = [&](Kind kind, std::vector<std::uint8_t> indices) {
    format::ShapeT shape;
    format::VertexBufferT& to = *shape.buffers.emplace_back(std::make_unique<format::VertexBufferT>());
    to.kind = kind;
    to.is_double = true;
    to.stride = 24;
    const auto* const first = reinterpret_cast<const std::uint8_t*>(square.data());
    to.vertices.assign(first, first + 8 * square.size());
    to.index_bytes = indices.empty() ? 0 : 2;
    to.indices = std::move(indices);
    to.radius = 0.1;
    flatbuffers::FlatBufferBuilder builder;
    builder.Finish(format::CreateShape(builder, &shape));
    return std::vector<std::uint8_t>(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
  };
  struct Case {
    const char* name;
    Kind kind;
    std::vector<std::uint8_t> indices;
    std::size_t parts;
    double area;
  };
  const Case cases[] = {{"points", Kind::points, {}, 4, 0},
                        {"segments", Kind::segments, {}, 2, 0},
                        {"polyline", Kind::polyline, {0, 0, 1, 0, 3, 0}, 2, 0},
                        {"triangles", Kind::triangles, {0, 0, 1, 0, 3, 0, 0, 0, 3, 0, 2, 0}, 0, 1},
                        {"fan", Kind::fan, {0, 0, 1, 0, 3, 0, 2, 0}, 0, 1},
                        {"strip", Kind::strip, {}, 0, 1}};
  RecordingFile file(path);
  std::uint32_t number = 0;
  for (const Case& one : cases) file.define(++number, one.name, buffer(one.kind, one.indices));
  file.define(++number, "beyond", buffer(Kind::triangles, {0, 0, 1, 0, 9, 0}));
  file.close();
  const ShownPicture shown = show();
  for (const Case& one : cases) {
    ASSERT_NE(shown.object(one.name), nullptr) << one.name;
    EXPECT_EQ(shown.object(one.name)->parts.size(), one.parts) << one.name;
    EXPECT_NEAR(measured(*shown.object(one.name)).first, one.area, 1e-12) << one.name;
  }
  EXPECT_EQ(shown.object("beyond"), nullptr) << "an index beyond the vertices";
}

TEST_F(RecordedPictureTest, WhatCannotBeShownIsRefusedWithASentence) {
  EXPECT_EQ(why_not("# notes\n"), "is no MCAP file. Nothing is shown");
  EXPECT_EQ(why_not("\x89MCAP0\r\n"), "holds nothing of a collision server. Nothing is shown");
  RecordingFile noise(path);
  noise.add_bytes(Recorded::object, "0123456789");
  noise.close();
  const Result<std::string> run = view::run_of_recording(path, {}, [] { return false; });
  ASSERT_FALSE(run);
  EXPECT_EQ(run.error().message, "nothing in it has a place");
}

TEST_F(RecordedPictureTest, ADamagedFileIsShownUpToItsDamageAndSaysWhere) {
  RecordingFile file(path);
  for (std::uint32_t i = 0; i < 5; ++i) file.define(i, "drone_" + std::to_string(i), ball());
  file.close();
  std::ifstream in(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  std::filesystem::resize_file(path, bytes.find("drone_4"));
  const Result<std::string> run = view::run_of_recording(path, {}, [] { return false; });
  ASSERT_TRUE(run) << run.error().message;
  const json notes = json::parse(*run)["notes"];
  ASSERT_FALSE(notes.empty());
  EXPECT_TRUE(notes[0].get<std::string>().starts_with("breaks off in the record at byte")) << notes;
}

}  // namespace
}  // namespace collided
