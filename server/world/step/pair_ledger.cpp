#include "server/world/step/pair_ledger.hpp"

#include <mutex>

namespace collided::engine {
namespace {

using Kind = LedgerWrite::Kind;

LedgerWrite change_of(Kind kind, ObjectId a, ObjectId b, double bracket_low_s, double bracket_high_s) {
  return {.kind = kind,
          .found = {.a = a, .b = b, .contact = {}, .bracket_low_s = bracket_low_s, .bracket_high_s = bracket_high_s}};
}

/// The rules cache names, and a found contact is seldom read again.
bool is_allowed(const ContactLedger& ledger, ObjectId a, ObjectId b) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  return ledger.passes(a, b);
}

}  // namespace

void PairLedger::touches(const FoundContact& found) {
  if (block_ == nullptr) return ledger_.touches(found);
  record({.kind = Kind::touches, .found = found});
}

void PairLedger::parts(ObjectId a, ObjectId b, EndReason reason, double bracket_low_s, double bracket_high_s) {
  if (block_ == nullptr) return ledger_.parts(a, b, reason, bracket_low_s, bracket_high_s);
  LedgerWrite change = change_of(Kind::parts, a, b, bracket_low_s, bracket_high_s);
  change.reason = reason;
  record(change);
}

void PairLedger::changes_containment(ObjectId a, ObjectId b, Contained to, const ContactEnd& when) {
  if (block_ == nullptr) return ledger_.changes_containment(a, b, to, when);
  LedgerWrite change = change_of(Kind::changes_containment, a, b, when.bracket_low_s, when.bracket_high_s);
  change.reason = when.reason;
  change.found.contained = to;
  record(change);
}

void PairLedger::doubts(const FoundContact& found, Doubt why) {
  if (block_ == nullptr) return ledger_.doubts(found, why);
  record({.kind = Kind::doubts, .why = why, .found = found});
}

void PairLedger::doubted_and_parted(const FoundContact& found, Doubt why) {
  if (block_ == nullptr) return ledger_.doubted_and_parted(found, why);
  record({.kind = Kind::doubted_and_parted, .why = why, .found = found});
}

void PairLedger::decided_apart(ObjectId a, ObjectId b, double bracket_low_s, double bracket_high_s) {
  if (block_ == nullptr) return ledger_.decided_apart(a, b, bracket_low_s, bracket_high_s);
  record(change_of(Kind::decided_apart, a, b, bracket_low_s, bracket_high_s));
}

void PairLedger::touched_and_parted(const FoundContact& found) {
  if (block_ == nullptr) return ledger_.touched_and_parted(found);
  record({.kind = Kind::touched_and_parted, .found = found});
}

void PairLedger::record(const LedgerWrite& change) {
  const ObjectId a = change.found.a;
  const ObjectId b = change.found.b;
  if (!is_written(a, b)) {
    const OpenContact* open = ledger_.find(a, b);
    state_ = open != nullptr ? std::optional(*open) : std::nullopt;
    written_a_ = a;
    written_b_ = b;
  }
  block_->writes.push_back(change);
  follow(change);
}

/// Changes state_ in the way that the ledger's functions will change the pair's contact.
void PairLedger::follow(const LedgerWrite& change) {
  const FoundContact& found = change.found;
  const bool is_doubt = state_ && state_->doubt != Doubt::none;
  // An open contact ends or changes even if the pair is allowed to touch.
  if (change.kind == Kind::parts) return state_.reset();
  if (change.kind == Kind::changes_containment) {
    if (state_ && !is_doubt) state_->contained = found.contained;
    return;
  }
  const bool is_lost = ledger_.has_lost(found.a, found.b);
  if (change.kind == Kind::decided_apart) {
    if (is_doubt && !is_lost) state_.reset();
    return;
  }
  if (is_allowed(ledger_, found.a, found.b)) return;
  if (change.kind == Kind::doubts || is_lost) {
    const Doubt why = change.kind == Kind::doubts ? change.why : Doubt::publisher_lost;
    if (!state_) state_ = ledger_.doubted(found, why);
    return;
  }
  if (change.kind == Kind::doubted_and_parted) return;
  if (is_doubt) state_.reset();
  if (change.kind == Kind::touched_and_parted) return;
  const std::uint64_t episode = state_ ? state_->episode : 0;
  const std::int64_t began_ns = state_ ? state_->began_ns : 0;
  const bool goes_on = state_.has_value();
  state_ = ledger_.opened(found);
  if (!goes_on) return;
  state_->episode = episode;
  state_->began_ns = began_ns;
  state_->surface = found.contact;
}

void write(const LedgerWrite& change, ContactLedger& ledger) {
  const FoundContact& found = change.found;
  switch (change.kind) {
    case Kind::touches: return ledger.touches(found);
    case Kind::parts: return ledger.parts(found.a, found.b, change.reason, found.bracket_low_s, found.bracket_high_s);
    case Kind::changes_containment:
      return ledger.changes_containment(found.a, found.b, found.contained,
                                        {change.reason, found.bracket_low_s, found.bracket_high_s});
    case Kind::doubts: return ledger.doubts(found, change.why);
    case Kind::doubted_and_parted: return ledger.doubted_and_parted(found, change.why);
    case Kind::decided_apart: return ledger.decided_apart(found.a, found.b, found.bracket_low_s, found.bracket_high_s);
    case Kind::touched_and_parted: return ledger.touched_and_parted(found);
  }
}

}  // namespace collided::engine
