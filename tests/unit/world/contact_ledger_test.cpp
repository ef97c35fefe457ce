#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "server/world/events/contact_ledger.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

FoundContact pair_of(ObjectId a, ObjectId b) { return {.a = a, .b = b, .contact = {}}; }

constexpr std::uint32_t kSlots[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};

void end_everything_unfound(ContactLedger& ledger) {
  ledger.end_unfound(kSlots, [](const OpenContact&) { return ContactEnd{.reason = EndReason::separated}; });
}

TEST(ContactLedger, BeganAndEndedAlternateAndShareTheEpisode) {
  ContactLedger ledger;
  ledger.begin_step(1'000, false);
  ledger.touches(pair_of(1, 2));
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 1u);
  EXPECT_EQ(ledger.events()[0].kind, EventKind::began);
  EXPECT_EQ(ledger.events()[0].sequence, 1u);

  ledger.begin_step(2'000, false);
  ledger.touches(pair_of(1, 2));
  end_everything_unfound(ledger);
  ledger.finish_step();
  EXPECT_TRUE(ledger.events().empty()) << "a contact that goes on is no event";

  ledger.begin_step(3'000, false);
  end_everything_unfound(ledger);
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 1u);
  EXPECT_EQ(ledger.events()[0].kind, EventKind::ended);
  EXPECT_EQ(ledger.events()[0].reason, EndReason::separated);
  EXPECT_EQ(ledger.events()[0].sequence, 2u);
  EXPECT_EQ(ledger.events()[0].of.episode, 1u);
  EXPECT_TRUE(ledger.open().empty());
}

// A shard that knows only a part of a mesh reports neither end as a parting: the two may touch in another shard.
TEST(ContactLedger, AnUnsureEndAndWhatEmergesWithItHaveOneReason) {
  ContactLedger ledger;
  ledger.begin_step(1'000, false);
  FoundContact inside = pair_of(1, 2);
  inside.contained = Contained::a_in_b;
  ledger.touches(inside);
  ledger.finish_step();
  ledger.begin_step(2'000, false);
  end_everything_unfound(ledger);
  ledger.retell_unsure([](const OpenContact&) { return true; });
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 2u);
  EXPECT_EQ(ledger.events()[0].kind, EventKind::emerged);
  EXPECT_EQ(ledger.events()[1].kind, EventKind::ended);
  EXPECT_EQ(ledger.events()[1].reason, EndReason::removed);
  EXPECT_EQ(ledger.events()[0].reason, ledger.events()[1].reason);
}

TEST(ContactLedger, OrderOfFindingDoesNotShow) {
  ContactLedger one, other;
  for (ContactLedger* ledger : {&one, &other}) ledger->begin_step(0, false);
  one.touches(pair_of(1, 2));
  one.touches(pair_of(3, 4));
  other.touches(pair_of(3, 4));
  other.touches(pair_of(1, 2));
  one.finish_step();
  other.finish_step();
  ASSERT_EQ(one.events().size(), other.events().size());
  for (std::size_t i = 0; i < one.events().size(); ++i) {
    EXPECT_EQ(one.events()[i].of.a, other.events()[i].of.a);
    EXPECT_EQ(one.events()[i].sequence, other.events()[i].sequence);
  }
}

TEST(ContactLedger, APassingContactIsOneEpisodeWithinTheStep) {
  ContactLedger ledger;
  ledger.begin_step(0, false);
  ledger.touched_and_parted(pair_of(1, 2));
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 2u);
  EXPECT_EQ(ledger.events()[0].kind, EventKind::began);
  EXPECT_EQ(ledger.events()[1].kind, EventKind::ended);
  EXPECT_EQ(ledger.events()[1].of.episode, ledger.events()[0].sequence);
  EXPECT_TRUE(ledger.open().empty());
}

TEST(ContactLedger, AnObjectTakesAllItsContactsWithIt) {
  ContactLedger ledger;
  ledger.begin_step(0, false);
  for (ObjectId other = 2; other < 10; ++other) ledger.touches(pair_of(1, other));
  ledger.touches(pair_of(20, 21));
  ledger.finish_step();
  ledger.begin_step(1, false);
  ledger.end_object(1, EndReason::publisher_lost);
  ledger.finish_step();
  EXPECT_EQ(ledger.events().size(), 8u);
  for (const Event& event : ledger.events()) EXPECT_EQ(event.reason, EndReason::publisher_lost);
  ASSERT_EQ(ledger.open().size(), 1u);
  EXPECT_TRUE(ledger.holds(20, 21));
}

TEST(ContactLedger, PersistedIsSaidOnRequestAndTakesNoSequence) {
  ContactLedger ledger;
  ledger.begin_step(0, true);
  ledger.touches(pair_of(1, 2));
  ledger.finish_step();
  ledger.begin_step(1, true);
  ledger.touches(pair_of(1, 2));
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 1u);
  EXPECT_EQ(ledger.events()[0].kind, EventKind::persisted);
  EXPECT_EQ(ledger.events()[0].sequence, 0u);
  EXPECT_EQ(ledger.last_sequence(), 1u);
}

FoundContact told_in_full(ObjectId a, ObjectId b) {
  return {.a = a,
          .b = b,
          .a_triangle = 3,
          .b_triangle = 5,
          .contact = {.point = {1, 2, 3}, .normal = {0, 0.6, 0.8}, .depth_m = 0.25, .depth_error_m = 0.0625},
          .bracket_low_s = 0.75,
          .bracket_high_s = 0.5,
          .relative_velocity = {7, 8, 9}};
}

void expect_told(const Event& event, const FoundContact& found) {
  EXPECT_EQ(event.of.a, found.a);
  EXPECT_EQ(event.of.b, found.b);
  EXPECT_EQ(event.of.a_triangle, found.a_triangle);
  EXPECT_EQ(event.of.b_triangle, found.b_triangle);
  EXPECT_EQ(event.of.contact.point, found.contact.point);
  EXPECT_EQ(event.of.contact.normal, found.contact.normal);
  EXPECT_EQ(event.of.contact.depth_m, found.contact.depth_m);
  EXPECT_EQ(event.of.contact.depth_error_m, found.contact.depth_error_m);
}

// It began between 0.75 and 0.5 s before the step's end and parted between then and the end of the step.
TEST(ContactLedger, APassingContactEndsAfterItBeganAndNoLaterThanTheStep) {
  ContactLedger ledger;
  ledger.begin_step(10'000'000'000, false);
  FoundContact found = told_in_full(1, 2);
  found.parted_low_s = 0.375;
  found.parted_high_s = 0.25;
  ledger.touched_and_parted(found);
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 2u);
  const Event& began = ledger.events()[0];
  const Event& ended = ledger.events()[1];
  expect_told(began, found);
  expect_told(ended, found);
  EXPECT_EQ(began.bracket_low_s, 0.75);
  EXPECT_EQ(began.bracket_high_s, 0.5);
  EXPECT_EQ(began.relative_velocity, Vec3(7, 8, 9));
  EXPECT_EQ(began.reason, EndReason::none);
  EXPECT_EQ(began.of.began_ns, 9'500'000'000);
  EXPECT_EQ(ended.bracket_low_s, 0.375);
  EXPECT_EQ(ended.bracket_high_s, 0.25);
  EXPECT_EQ(ended.relative_velocity, Vec3(0, 0, 0));
  EXPECT_EQ(ended.reason, EndReason::separated);
  EXPECT_EQ(ended.of.began_ns, 9'500'000'000);
}

TEST(ContactLedger, EveryFieldOfAContactIsToldWhenItBeginsAndTheNewestOnceItIsOver) {
  ContactLedger ledger;
  ledger.begin_step(10'000'000'000, true);
  const FoundContact first = told_in_full(1, 2);
  ledger.touches(first);
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 1u);
  expect_told(ledger.events()[0], first);
  EXPECT_EQ(ledger.events()[0].bracket_low_s, 0.75);
  EXPECT_EQ(ledger.events()[0].bracket_high_s, 0.5);
  EXPECT_EQ(ledger.events()[0].relative_velocity, Vec3(7, 8, 9));
  EXPECT_EQ(ledger.events()[0].of.episode, 1u);
  EXPECT_EQ(ledger.open().at(0).episode, 1u);

  ledger.begin_step(11'000'000'000, true);
  FoundContact second = told_in_full(1, 2);
  second.a_triangle = 4;
  second.b_triangle = 6;
  second.contact = {.point = {4, 5, 6}, .normal = {0, 0.8, 0.6}, .depth_m = 0.5, .depth_error_m = 0.125};
  second.relative_velocity = {-1, -2, -3};
  ledger.touches(second);
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 1u);
  expect_told(ledger.events()[0], second);
  EXPECT_EQ(ledger.events()[0].kind, EventKind::persisted);
  EXPECT_EQ(ledger.events()[0].relative_velocity, Vec3(-1, -2, -3));
  EXPECT_EQ(ledger.events()[0].of.began_ns, 9'500'000'000) << "it is still the contact that began then";
  EXPECT_EQ(ledger.events()[0].of.episode, 1u);

  ledger.begin_step(12'000'000'000, true);
  ledger.end_unfound(kSlots, [](const OpenContact&) { return ContactEnd{EndReason::teleported, 0.25, 0.125}; });
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 1u);
  expect_told(ledger.events()[0], second);
  EXPECT_EQ(ledger.events()[0].reason, EndReason::teleported);
  EXPECT_EQ(ledger.events()[0].bracket_low_s, 0.25);
  EXPECT_EQ(ledger.events()[0].bracket_high_s, 0.125);
  EXPECT_EQ(ledger.events()[0].of.began_ns, 9'500'000'000);
  EXPECT_EQ(ledger.events()[0].of.episode, 1u);
}

// Contacts are kept beside each other; one that ends leaves its place to the last.
TEST(ContactLedger, TheContactThatTakesAnothersPlaceIsStillFoundAndEndsAsItself) {
  ContactLedger ledger;
  ledger.begin_step(0, false);
  for (ObjectId other = 2; other < 6; ++other) ledger.touches(pair_of(1, other));
  ledger.finish_step();
  ledger.begin_step(1, false);
  ledger.touches(pair_of(1, 5));
  ledger.touches(pair_of(1, 4));
  ledger.touches(pair_of(1, 3));
  end_everything_unfound(ledger);
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 1u);
  EXPECT_EQ(ledger.events()[0].of.b, 2u);
  EXPECT_FALSE(ledger.holds(1, 2));
  for (std::size_t i = 0; i < ledger.open().size(); ++i) EXPECT_TRUE(ledger.found(i)) << i;
  ledger.begin_step(2, false);
  ledger.touches(pair_of(1, 5));
  end_everything_unfound(ledger);
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 2u);
  EXPECT_EQ(ledger.events()[0].of.b, 3u);
  EXPECT_EQ(ledger.events()[0].of.episode, 2u);
  EXPECT_EQ(ledger.events()[1].of.b, 4u);
  EXPECT_EQ(ledger.events()[1].of.episode, 3u);
  ASSERT_EQ(ledger.open().size(), 1u);
  EXPECT_EQ(ledger.open()[0].b, 5u);
}

// A name is given on within a step: its old contact must be over before its new one begins, whatever the numbers say.
TEST(ContactLedger, WhatHeldEndsBeforeAnythingBegins) {
  ContactLedger ledger;
  ledger.begin_step(0, false);
  ledger.touches(pair_of(8, 9));
  ledger.finish_step();
  ledger.begin_step(1, false);
  ledger.touches(pair_of(1, 2));
  ledger.end_object(8, EndReason::geometry_changed);
  ledger.touched_and_parted(pair_of(3, 4));
  ledger.touched_and_parted(pair_of(5, 6));
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 6u);
  EXPECT_EQ(ledger.events()[0].kind, EventKind::ended);
  EXPECT_EQ(ledger.events()[0].of.a, 8u);
  EXPECT_EQ(ledger.events()[0].bracket_low_s, 0);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_EQ(ledger.events()[i].sequence, i + 2);
  EXPECT_EQ(ledger.events()[1].of.a, 1u);
  EXPECT_EQ(ledger.events()[2].of.a, 3u);
  EXPECT_EQ(ledger.events()[3].of.episode, ledger.events()[2].sequence);
  EXPECT_EQ(ledger.events()[4].of.a, 5u);
  EXPECT_EQ(ledger.events()[5].of.episode, ledger.events()[4].sequence);
}

TEST(ContactLedger, ACorrectedContactIsToldInItsBeginningAndNoOther) {
  ContactLedger ledger;
  ledger.begin_step(0, true);
  ledger.touches(pair_of(1, 2));
  ledger.touches(pair_of(3, 4));
  ledger.touched_and_parted(pair_of(5, 6));
  ledger.correct(1, {.point = {1, 2, 3}, .normal = {0, 0, 1}, .depth_m = 0.5, .depth_error_m = 0.25});
  ledger.retell_corrected();
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 4u);
  EXPECT_EQ(ledger.events()[0].of.contact.depth_m, 0);
  EXPECT_EQ(ledger.events()[1].of.contact.depth_m, 0) << "the shortest way out stays what it was";
  EXPECT_EQ(ledger.events()[1].of.surface.depth_m, 0.5);
  EXPECT_EQ(ledger.events()[1].of.surface.point, Vec3(1, 2, 3));
  EXPECT_EQ(ledger.open()[1].surface.depth_m, 0.5);
  EXPECT_EQ(ledger.events()[0].of.surface.depth_m, 0);
  EXPECT_EQ(ledger.events()[2].of.surface.depth_m, 0);
}

// 10 s, less 0.75 s: from then on it is not decided; what is not known is told as not known.
TEST(ContactLedger, ADoubtBeganWhereTheUndecidedSpanBeginsAndTellsNoPlace) {
  ContactLedger ledger;
  ledger.begin_step(10'000'000'000, false);
  ledger.doubts(told_in_full(1, 2), Doubt::cost_limit);
  ledger.finish_step();
  ASSERT_EQ(ledger.open().size(), 1u);
  const OpenContact& open = ledger.open()[0];
  EXPECT_EQ(open.began_ns, 9'250'000'000);
  EXPECT_EQ(open.doubt, Doubt::cost_limit);
  EXPECT_EQ(open.a_triangle, kNoTriangle);
  EXPECT_EQ(open.b_triangle, kNoTriangle);
  EXPECT_EQ(open.contact.point, Vec3(0, 0, 0));
  EXPECT_EQ(open.doubt, Doubt::cost_limit);
  EXPECT_EQ(open.contact.depth_m, 0);
  EXPECT_EQ(ledger.events().at(0).bracket_low_s, 0.75);
  EXPECT_EQ(ledger.events()[0].bracket_high_s, 0.5);
}

TEST(ContactLedger, AnObjectThatEndedIsNoLongerLost) {
  ContactLedger ledger;
  ledger.begin_step(0, false);
  ledger.lose(1);
  ledger.touches(pair_of(1, 2));
  EXPECT_TRUE(ledger.is_in_doubt(1, 2));
  ledger.finish_step();
  ledger.begin_step(1, false);
  ledger.end_object(1, EndReason::removed);
  EXPECT_FALSE(ledger.is_open(1, 2));
  ledger.touches(pair_of(1, 2));
  ledger.finish_step();
  EXPECT_TRUE(ledger.holds(1, 2));
}

// What passed in this step keeps its own contact, though one that began before is still open and was not found again.
TEST(ContactLedger, WhatPassedIsNotRetoldAsWhatWasOpenBefore) {
  ContactLedger ledger;
  ledger.begin_step(0, false);
  ledger.touches(pair_of(1, 2));
  ledger.finish_step();
  ledger.begin_step(1, false);
  ledger.touched_and_parted(told_in_full(1, 2));
  ledger.retell_corrected();
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 2u);
  expect_told(ledger.events()[0], told_in_full(1, 2));
  expect_told(ledger.events()[1], told_in_full(1, 2));
}

// Random contacts that begin and end, beside a plain map: the table of pairs and each object's list lose and confuse none.
TEST(ContactLedger, EqualsAPlainMapWhateverBeginsAndEnds) {
  std::mt19937_64 random = oracle::seeded(20261124);
  constexpr std::uint32_t kObjects = 60;
  ContactLedger ledger;
  std::map<std::pair<ObjectId, ObjectId>, std::uint64_t> twin;  // the step that last found the pair
  for (std::uint64_t step = 1; step <= 400; ++step) {
    ledger.begin_step(static_cast<std::int64_t>(step), false);
    std::set<std::uint32_t> found_slots;
    const std::uint64_t finds = random() % (step < 200 ? 80 : 20);
    for (std::uint64_t i = 0; i < finds; ++i) {
      const ObjectId a = random() % kObjects;
      const ObjectId b = random() % kObjects;
      if (a == b) continue;
      ledger.touches(pair_of(std::min(a, b), std::max(a, b)));
      twin[{std::min(a, b), std::max(a, b)}] = step;
      found_slots.insert({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
    }
    std::vector<std::uint32_t> moved;
    for (std::uint32_t slot = 0; slot < kObjects; ++slot) {
      if (random() % 4 == 0) moved.push_back(slot);
    }
    EXPECT_EQ(std::set(ledger.found_slots().begin(), ledger.found_slots().end()), found_slots);
    EXPECT_EQ(ledger.found_slots().size(), found_slots.size());
    ledger.end_unfound(moved, [](const OpenContact&) { return ContactEnd{.reason = EndReason::separated}; });
    const auto has_moved = [&](ObjectId id) { return std::find(moved.begin(), moved.end(), id) != moved.end(); };
    std::erase_if(twin, [&](const auto& entry) {
      return entry.second != step && (has_moved(entry.first.first) || has_moved(entry.first.second));
    });
    if (step % 50 == 0) {
      ledger.end_object(7, EndReason::removed);
      std::erase_if(twin, [](const auto& entry) { return entry.first.first == 7 || entry.first.second == 7; });
    }
    ledger.finish_step();
    ASSERT_EQ(ledger.open().size(), twin.size()) << "step " << step;
    for (const auto& [pair, when] : twin) ASSERT_TRUE(ledger.holds(pair.first, pair.second)) << "step " << step;
    for (std::uint32_t slot = 0; slot < kObjects; ++slot) {
      std::set<std::pair<ObjectId, ObjectId>> listed;
      ledger.for_each_of(slot, [&](std::uint32_t number) {
        return listed.insert({ledger.open()[number].a, ledger.open()[number].b}).second;
      });
      const auto expected = std::count_if(twin.begin(), twin.end(), [&](const auto& entry) {
        return entry.first.first == slot || entry.first.second == slot;
      });
      ASSERT_EQ(listed.size(), static_cast<std::size_t>(expected)) << "slot " << slot << ", step " << step;
    }
  }
}

// Random contacts, doubts and containments of objects of which two thirds have faces: each object's contacts at faces are
// those that a search through all of its contacts finds.
TEST(ContactLedger, ContactsAtFacesAreThoseOfAPlainSearch) {
  std::mt19937_64 random = oracle::seeded(20261130);
  constexpr std::uint32_t kObjects = 40;
  const auto has_faces = [](ObjectId id) { return id % 3 != 0; };
  ContactLedger ledger;
  ledger.set_has_faces(has_faces);
  std::size_t most_at_faces = 0;
  for (std::uint64_t step = 1; step <= 400; ++step) {
    ledger.begin_step(static_cast<std::int64_t>(step), false);
    if (step % 40 == 0) ledger.end_object(random() % kObjects, EndReason::removed);
    if (step % 40 == 20) ledger.lose(random() % kObjects);
    if (step % 40 == 30) {
      for (ObjectId id = 0; id < kObjects; ++id) ledger.find_again(id);
    }
    for (int i = 0; i < 60; ++i) {
      const ObjectId one = random() % kObjects;
      const ObjectId other = random() % kObjects;
      if (one == other) continue;
      FoundContact found = pair_of(std::min(one, other), std::max(one, other));
      const std::uint64_t kind = random() % 8;
      if (kind < 2) found.contained = kind == 0 ? Contained::a_in_b : Contained::b_in_a;
      if (kind == 2) ledger.doubts(found, Doubt::numeric);
      else ledger.touches(found);
    }
    std::vector<std::uint32_t> moved;
    for (std::uint32_t slot = 0; slot < kObjects; ++slot) {
      if (random() % 6 == 0) moved.push_back(slot);
    }
    ledger.end_unfound(moved, [](const OpenContact&) { return ContactEnd{.reason = EndReason::separated}; });
    ledger.finish_step();
    for (std::uint32_t slot = 0; slot < kObjects; ++slot) {
      std::set<std::uint32_t> expected;
      for (std::uint32_t number = 0; number < ledger.open().size(); ++number) {
        const OpenContact& open = ledger.open()[number];
        if (slot_of(open.a) != slot && slot_of(open.b) != slot) continue;
        if (open.doubt != Doubt::none || open.contained != Contained::none) continue;
        if (has_faces(slot_of(open.a) == slot ? open.b : open.a)) expected.insert(number);
      }
      std::set<std::uint32_t> listed;
      ledger.for_each_at_faces(slot, [&](std::uint32_t number) { return listed.insert(number).second; });
      ASSERT_EQ(listed, expected) << "slot " << slot << ", step " << step;
      ASSERT_EQ(ledger.face_count(slot), expected.size()) << "slot " << slot << ", step " << step;
      most_at_faces = std::max(most_at_faces, expected.size());
    }
  }
  EXPECT_GT(most_at_faces, 10u);
}

}  // namespace
}  // namespace collided::engine
