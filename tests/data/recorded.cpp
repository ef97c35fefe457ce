#include "tests/data/recorded.hpp"

#include <algorithm>
#include <charconv>

#include "server/intake/scene.hpp"

namespace collided::recorded {
using namespace engine;

Rows::Rows(const std::filesystem::path& file) : table_(oracle::read_table(file)) {
  EXPECT_FALSE(table_.rows.empty()) << file << " is not there or has no rows";
}

std::size_t Rows::column(const char* name) const {
  for (const auto& [known, number] : known_) {
    if (known == name) return number;
  }
  known_.emplace_back(name, table_.column(name));
  return known_.back().second;
}

const std::string& Rows::text(std::size_t row, const char* name) const { return table_.rows.at(row).at(column(name)); }

double Rows::number(std::size_t row, const char* name) const {
  const std::string& cell = text(row, name);
  double value = 0;
  const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (fault != std::errc() || end != cell.data() + cell.size())
    throw std::runtime_error("no number: '" + cell + "' in column " + name);
  return value;
}

Pose Rows::pose(std::size_t row) const {
  const Quat rotation(number(row, "qw"), number(row, "qx"), number(row, "qy"), number(row, "qz"));
  return {.position = point(row), .rotation = rotation.normalized()};
}

std::vector<std::pair<std::size_t, std::size_t>> Rows::groups(const char* name, const char* other) const {
  std::vector<std::pair<std::size_t, std::size_t>> all;
  for (std::size_t row = 0; row < size(); ++row) {
    const bool goes_on = row > 0 && text(row, name) == text(row - 1, name) && text(row, other) == text(row - 1, other);
    if (goes_on) {
      all.back().second = row + 1;
    } else {
      all.emplace_back(row, row + 1);
    }
  }
  return all;
}

ObjectId Stage::add(const std::string& name, Shape shape, const Pose& pose, bool moving, std::uint32_t group) {
  ObjectDefinition definition;
  definition.name = name;
  definition.shape = std::move(shape);
  definition.pose = pose;
  definition.moving = moving;
  definition.filter.group = group;
  const auto defined = world_.define(definition);
  if (const auto* refused = std::get_if<Refusal>(&defined)) throw std::runtime_error(refused->reason);
  return std::get<ObjectId>(defined);
}

void Stage::move(ObjectId object, const Pose& pose, bool teleport) {
  if (!world_.move(object, pose, time_ns_ + 1, teleport)) throw std::runtime_error("no such object");
}

void Stage::step() {
  if (!world_.step(time_ns_ += 10'000'000, 1, {.contacts = false})) throw std::runtime_error("no free snapshot");
  EXPECT_EQ(world_.cost().undecided, 0u);
  EXPECT_FALSE(world_.cost().truncated);
}

std::vector<std::string> Stage::touching() const {
  std::vector<std::string> pairs;
  for (const OpenContact& contact : world_.contacts()) {
    const ObjectInfo* a = world_.info(contact.a);
    const ObjectInfo* b = world_.info(contact.b);
    if (!a->moving) std::swap(a, b);
    pairs.push_back(a->name + ":" + b->name);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::shared_ptr<const TriangleMesh> mesh_file(const std::filesystem::path& file) {
  LoadReport report;
  Scene scene = load_scene(file.string(), {}, report);
  return std::make_shared<const TriangleMesh>(std::move(scene.mesh));
}

}  // namespace collided::recorded
