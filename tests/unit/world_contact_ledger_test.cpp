#include <gtest/gtest.h>

#include "server/world/contact_ledger.hpp"

namespace collided {
namespace {

using wire_contract::EndReason;
using wire_contract::EventKind;

FoundContact pair_of(ObjectId a, ObjectId b) { return {.a = a, .b = b, .contact = {}}; }

void end_everything_unfound(ContactLedger& ledger) {
  ledger.end_unfound([](const OpenContact&) { return ContactEnd{.reason = EndReason::separated}; });
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

}  // namespace
}  // namespace collided
