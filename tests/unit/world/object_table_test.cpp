// The object table of a state follows the writer's by what changed; a state that is still held keeps its own.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/world/objects/slot_marks.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

constexpr std::size_t kChunk = ObjectTable::kChunk;

std::shared_ptr<const ObjectInfo> named(std::uint32_t slot, const std::string& name) {
  auto info = std::make_shared<ObjectInfo>();
  info->id = (ObjectId{1} << 32) | slot;
  info->name = name;
  return info;
}

ObjectDefinition ball(const std::string& name, bool is_unknown) {
  ObjectDefinition definition{.name = name, .scene = "", .shape = {}, .pose = {}, .filter = {}};
  definition.shape.primitives = {Sphere{Vec3::Zero(), 0.5}};
  definition.shape.is_unknown = is_unknown;
  definition.moving = !is_unknown;
  definition.publisher = is_unknown ? 0 : 1;
  return definition;
}

std::vector<std::string> names_in(const ObjectTable& table) {
  std::vector<std::string> names;
  for (const auto& info : table) names.push_back(info ? info->name : "");
  while (!names.empty() && names.back().empty()) names.pop_back();
  return names;
}

// Objects come and go while some states are held for long and others for a moment, so that a state is filled again after
// one step or after many.
TEST(ObjectTable, EachStateHasTheObjectsOfItsStep) {
  std::mt19937_64 random = oracle::seeded(20261131);
  World world({.max_objects = 1'000});
  struct Held {
    SnapshotRing::Lease lease;
    std::vector<std::string> names;
  };
  std::vector<Held> held;
  std::map<std::uint64_t, std::vector<const ObjectInfo*>> content_of;  // of a chunk, by its version
  std::vector<ObjectId> ids;
  int next = 0;
  for (std::int64_t step = 1; step <= 600; ++step) {
    const std::uint64_t kind = random() % 10;
    const std::uint64_t changes = kind < 6 ? random() % 3 : kind < 9 ? random() % 20 : random() % 500;
    for (std::uint64_t i = 0; i < changes; ++i) {
      if (ids.size() < 700 && (ids.empty() || random() % 2 == 0)) {
        const ObjectDefinition definition = ball("ball " + std::to_string(next++), random() % 16 == 0);
        ids.push_back(std::get<ObjectId>(world.define(definition)));
      } else {
        std::swap(ids[random() % ids.size()], ids.back());
        ASSERT_TRUE(world.remove(ids.back(), EndReason::removed));
        ids.pop_back();
      }
    }
    ASSERT_TRUE(world.step(step, 1, {}));
    const SnapshotRing::Lease now = world.newest();
    ASSERT_EQ(names_in(now->objects), names_in(world.objects())) << "step " << step;
    ObjectTable::ObjectCounts counts;
    for (const auto& info : now->objects) {
      if (!info) continue;
      ++counts.objects;
      counts.moving += info->moving ? 1 : 0;
      counts.unknown += info->is_unknown ? 1 : 0;
    }
    EXPECT_EQ(now->objects.counts().objects, counts.objects);
    EXPECT_EQ(now->objects.counts().moving, counts.moving);
    EXPECT_EQ(now->objects.counts().unknown, counts.unknown);
    EXPECT_EQ(now->objects.version(), world.objects().version());
    for (std::size_t chunk = 0; chunk < now->objects.chunk_versions().size(); ++chunk) {
      std::vector<const ObjectInfo*> content(kChunk);
      for (std::size_t i = 0; i < kChunk && chunk * kChunk + i < now->objects.size(); ++i) {
        content[i] = now->objects[chunk * kChunk + i].get();
      }
      const auto [known, is_new] = content_of.emplace(now->objects.chunk_versions()[chunk], content);
      ASSERT_TRUE(is_new || known->second == content)
          << "one version, two contents: chunk " << chunk << ", step " << step;
    }
    for (const Held& old : held) ASSERT_EQ(names_in(old.lease->objects), old.names) << "a held state changed";
    if (random() % 4 == 0) held.push_back({now, names_in(now->objects)});
    while (held.size() > 10 || (!held.empty() && random() % 5 == 0)) {
      held.erase(held.begin() + static_cast<std::ptrdiff_t>(random() % held.size()));
    }
  }
}

TEST(ObjectTable, TablesOfOneContentEachHaveTheirOwnVersion) {
  const ObjectTable one({named(0, "a")});
  const ObjectTable other({named(0, "a")});
  EXPECT_NE(one.version(), other.version());
  EXPECT_NE(one.chunk_versions()[0], other.chunk_versions()[0]);
  EXPECT_EQ(ObjectTable().version(), 0u);
}

TEST(SlotMarks, AnObjectThatJoinsCostsItsChunk) {
  ObjectTable table;
  for (std::uint32_t slot = 0; slot < 10 * kChunk + 3; ++slot) {
    table.add_slot();
    table.set(slot, named(slot, std::to_string(slot)));
  }
  SlotMarks marks;
  std::size_t looks = 0;
  const auto is_even = [&](const ObjectInfo& info) {
    ++looks;
    return slot_of(info.id) % 2 == 0;
  };
  marks.follow(table, is_even);
  EXPECT_EQ(looks, table.size());
  looks = 0;
  marks.follow(table, is_even);
  EXPECT_EQ(looks, 0u) << "nothing changed";
  const ObjectTable before = table;
  table.set(3 * kChunk + 2, nullptr);
  table.set(7 * kChunk + 5, named(7 * kChunk + 5, "another"));
  marks.follow(table, is_even);
  EXPECT_EQ(looks, 2 * kChunk - 1);
  EXPECT_EQ(marks.by_slot()[3 * kChunk + 2], 0);
  // An older state again, then the newer one.
  for (const ObjectTable* now : std::initializer_list<const ObjectTable*>{&before, &table}) {
    marks.follow(*now, is_even);
    for (std::size_t slot = 0; slot < now->size(); ++slot) {
      EXPECT_EQ(marks.by_slot()[slot], (*now)[slot] && slot % 2 == 0 ? 1 : 0) << slot;
    }
  }
  // Another rule.
  marks.forget();
  marks.follow(table, [](const ObjectInfo&) { return true; });
  EXPECT_EQ(marks.by_slot()[1], 1);
}

}  // namespace
}  // namespace collided::engine
