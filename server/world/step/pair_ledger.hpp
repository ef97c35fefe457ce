#pragma once

#include <optional>

#include "server/world/step/step_block.hpp"

namespace collided::engine {

/// Reads and writes the contact of the pair being decided. On the world's thread it accesses the ledger. Any other
/// thread only reads the ledger: its writes go into a block, and later reads return what the ledger will hold once the
/// block is applied.
///
/// Always: a pair's decision reads no other pair's contact, so that blocks may be decided at once and applied in order.
class PairLedger {
 public:
  /// block  null: the ledger itself is written
  explicit PairLedger(ContactLedger& ledger, StepBlock* block = nullptr) : ledger_(ledger), block_(block) {}

  /// The whole ledger, for the world's thread.
  ContactLedger& all() { return ledger_; }
  const ContactLedger& all() const { return ledger_; }
  /// The block; null: the ledger itself is written.
  StepBlock* block() { return block_; }
  bool is_recording() const { return block_ != nullptr; }
  /// True if the ledger is full. Never true while recording: a block that may have filled it is decided again.
  bool is_full(std::size_t most) const { return block_ == nullptr && ledger_.open().size() >= most; }

  /// Same as ContactLedger's functions of these names.
  const OpenContact* find(ObjectId a, ObjectId b) const {
    if (is_written(a, b)) return state_ ? &*state_ : nullptr;
    return ledger_.find(a, b);
  }
  bool holds(ObjectId a, ObjectId b) const {
    return is_written(a, b) ? state_ && state_->doubt == Doubt::none : ledger_.holds(a, b);
  }
  bool is_in_doubt(ObjectId a, ObjectId b) const {
    return is_written(a, b) ? state_ && state_->doubt != Doubt::none : ledger_.is_in_doubt(a, b);
  }
  bool is_open(ObjectId a, ObjectId b) const { return is_written(a, b) ? state_.has_value() : ledger_.is_open(a, b); }
  Contained contained(ObjectId a, ObjectId b) const {
    if (!is_written(a, b)) return ledger_.contained(a, b);
    return state_ ? state_->contained : Contained::none;
  }
  void touches(const FoundContact& found);
  void parts(ObjectId a, ObjectId b, EndReason reason, double bracket_low_s, double bracket_high_s);
  void changes_containment(ObjectId a, ObjectId b, Contained to, const ContactEnd& when);
  void doubts(const FoundContact& found, Doubt why);
  void doubted_and_parted(const FoundContact& found, Doubt why);
  void decided_apart(ObjectId a, ObjectId b, double bracket_low_s, double bracket_high_s);
  void touched_and_parted(const FoundContact& found);

 private:
  bool is_written(ObjectId a, ObjectId b) const { return b == written_b_ && a == written_a_; }
  void record(const LedgerWrite& write);
  void follow(const LedgerWrite& write);

  ContactLedger& ledger_;
  StepBlock* const block_;
  // The pair written last, and its contact after that. No pair has 0 as its higher id.
  ObjectId written_a_ = 0;
  ObjectId written_b_ = 0;
  std::optional<OpenContact> state_;
};

/// Applies one change that a decision recorded.
void write(const LedgerWrite& change, ContactLedger& ledger);

}  // namespace collided::engine
