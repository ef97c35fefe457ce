#include <collided/vcollide.hpp>

#include <algorithm>
#include <stdexcept>

#include "tests/oracle/simple_prototype.hpp"
#include "tests/studies/homework/method.hpp"

namespace collided::homework {
using namespace engine;
namespace {

/// Above this the copies of the meshes do not fit well.
constexpr std::size_t kMostTriangles = 8'000'000;

class VCollidePolygons final : public Method {
 public:
  explicit VCollidePolygons(const Recording& recording) {
    for (std::size_t i = 0; i < recording.objects(); ++i) {
      int id = 0;
      vc_.NewObject(&id);
      const TriangleMesh& mesh = *recording.mesh(i).mesh;
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle corners = mesh.triangle(t);
        vc_.AddTri(corners.a.data(), corners.b.data(), corners.c.data(), static_cast<int>(t));
      }
      if (vc_.EndObject() != vcollide::VC_OK) throw std::runtime_error(vc_.LastError());
    }
  }
  std::string name() const override { return "Collided, all polygons"; }
  void frame(const std::vector<Pose>& poses) override {
    double trans[4][4] = {{}, {}, {}, {0, 0, 0, 1}};
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Frame frame = frame_of(poses[i]);
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) trans[row][column] = frame.rotation(row, column);
        trans[row][3] = frame.position[row];
      }
      if (vc_.UpdateTrans(static_cast<int>(i), trans) != vcollide::VC_OK) throw std::runtime_error(vc_.LastError());
    }
    vc_.Collide(&report_, vcollide::VC_ALL_CONTACTS);
  }
  ObjectPairs pairs() const override {
    ObjectPairs all;
    for (int i = 0; i < report_.numObjPairs(); ++i) {
      all.push_back({static_cast<std::uint32_t>(report_.obj1ID(i)), static_cast<std::uint32_t>(report_.obj2ID(i))});
    }
    return all;
  }
  std::optional<std::size_t> polygon_pairs() const override {
    std::size_t count = 0;
    for (int i = 0; i < report_.numObjPairs(); ++i) count += static_cast<std::size_t>(report_.numTriPairs(i));
    return count;
  }
  std::size_t candidates() const override { return vc_.ObjectCandidates(); }

 private:
  vcollide::VCollide vc_;
  vcollide::VCReport report_;
};

class Prototype final : public Method {
 public:
  explicit Prototype(const Recording& recording) {
    for (std::size_t i = 0; i < recording.objects(); ++i) prototype_.add(recording.mesh(i).mesh);
  }
  std::string name() const override { return "simple prototype"; }
  void frame(const std::vector<Pose>& poses) override {
    for (std::size_t i = 0; i < poses.size(); ++i) prototype_.move(i, frame_of(poses[i]));
    found_ = prototype_.collide();
  }
  ObjectPairs pairs() const override {
    ObjectPairs all;
    for (const oracle::MeetingPair& pair : found_) all.push_back(pair.object);
    return all;
  }
  std::optional<std::size_t> polygon_pairs() const override {
    std::size_t count = 0;
    for (const oracle::MeetingPair& pair : found_) count += pair.triangles.size();
    return count;
  }
  std::size_t candidates() const override { return prototype_.object_candidates(); }

 private:
  oracle::SimplePrototype prototype_;
  std::vector<oracle::MeetingPair> found_;
};

}  // namespace

CollidedWorld::CollidedWorld(const Recording& recording, bool contacts)
    : contacts_(contacts), world_(WorldOptions{}), moved_(new bool[recording.objects()]) {
  for (std::size_t i = 0; i < recording.objects(); ++i) {
    ObjectDefinition definition;
    definition.name = std::to_string(i);
    definition.shape.mesh = recording.mesh(i).mesh;
    definition.indexed = recording.sizes[recording.size_of[i]];
    definition.pose = recording.poses[0][i];
    const auto defined = world_.define(definition);
    if (const auto* refused = std::get_if<Refusal>(&defined)) throw std::runtime_error(refused->reason);
    ids_.push_back(std::get<ObjectId>(defined));
    number_of_[ids_.back()] = static_cast<std::uint32_t>(i);
  }
  world_.step(time_ns_ += 1, 1, {.contacts = contacts_});
}

void CollidedWorld::frame(const std::vector<Pose>& poses) {
  time_ns_ += 16'666'667;
  world_.move(ids_, poses, time_ns_, false, {moved_.get(), ids_.size()});
  if (!world_.step(time_ns_, 1, {.contacts = contacts_})) throw std::runtime_error("no free snapshot");
  if (world_.cost().undecided != 0 || world_.cost().truncated) throw std::runtime_error("an undecided step");
}

ObjectPairs CollidedWorld::pairs() const {
  ObjectPairs all;
  for (const OpenContact& contact : world_.contacts()) {
    const std::uint32_t a = number_of_.at(contact.a), b = number_of_.at(contact.b);
    all.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(all.begin(), all.end());
  return all;
}

void CollidedWorld::for_each_change(const std::function<void(std::size_t, std::size_t, bool)>& change) const {
  for (const Event& event : world_.events()) {
    if (event.kind == EventKind::persisted) continue;
    change(number_of_.at(event.of.a), number_of_.at(event.of.b), event.kind == EventKind::began);
  }
}

std::unique_ptr<Method> collided_world(const Recording& recording) {
  return std::make_unique<CollidedWorld>(recording);
}

std::unique_ptr<Method> collided_polygons(const Recording& recording) {
  if (recording.objects() * recording.polygons > kMostTriangles) return nullptr;
  return std::make_unique<VCollidePolygons>(recording);
}

std::unique_ptr<Method> simple_prototype(const Recording& recording) { return std::make_unique<Prototype>(recording); }

}  // namespace collided::homework
