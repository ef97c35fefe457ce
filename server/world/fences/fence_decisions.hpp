#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/world/events/contact_ledger.hpp"
#include "server/world/fences/band_decisions.hpp"
#include "server/world/fences/fence_piece.hpp"
#include "server/world/fences/fence_table.hpp"
#include "server/world/objects/contact_times.hpp"
#include "server/world/step/pair_windows.hpp"
#include "server/world/step/piece_points.hpp"

namespace collided::engine {

/// Lists reused from step to step.
struct FenceLists {
  PiecePoints mover_points;
  PiecePoints fence_points;
  std::vector<std::int64_t> cuts;
  ContactTimes times;  // of the surfaces of the pair at hand, in the piece at hand
};

/// What one step decides of objects and fences: sends to the ledger who is in a fence, who came and who went, by the
/// tests and sweeps that decide contacts. An object and a fence in the world need no common time: the fence is known for
/// ever. A carried fence has the time of its carrier.
class FenceDecisions {
 public:
  FenceDecisions(const StepView& step, FenceTable& table, ContactLedger& ledger, FenceLists& lists,
                 PendingTurns& pending, StepCost& cost)
      : step_(step),
        rows_(step.rows),
        table_(table),
        ledger_(ledger),
        lists_(lists),
        cost_(cost),
        bands_(step, table, ledger, pending, cost) {}

  /// The fence looks at this object: by its rule, and it is not its carrier.
  bool looks_at(std::uint32_t fence, std::uint32_t mover) const;
  /// Of one that is in: it is so still. A filter: false says nothing.
  bool surely_stays(std::uint32_t fence, std::uint32_t mover);
  /// Decides all that is newly known of the two.
  ///
  /// is_new  the fence came, or found its carrier, since the last step: only where the object is now counts
  void decide(std::uint32_t fence, std::uint32_t mover, bool is_new);
  BandDecisions& bands() { return bands_; }

 private:
  void decide_at_rest_in_the_world(std::uint32_t fence, std::uint32_t mover);
  void decide_carried(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier);
  void decide_on_common_time(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier);
  void decide_new(std::uint32_t fence, std::uint32_t mover);
  void decide_piece(const FencePiece& piece);
  void begin_in_motion(const FencePiece& piece, const ContactSearch& touch, const SweptContact& sweep);
  void decide_instant(const FencePiece& instant, const ContactEnd& left);
  FencePiece instant_on(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier, std::int64_t time_ns) const;
  FencePiece instant_now(std::uint32_t fence, std::uint32_t mover, std::int64_t time_ns) const;
  bool is_cut(const FencePiece& piece) const;
  bool decide_intervals(const FencePiece& piece, const ContactSearch& touch, bool is_within, const SweptContact* first);
  bool find_intervals(const FencePiece& piece, const TouchAtEnd& begin, const TouchAtEnd& end,
                      const SweptContact* first);
  void report_intervals(const FencePiece& piece, bool is_in_at_end);
  TouchAtEnd surfaces_at_begin(const FencePiece& piece, bool is_held);
  bool is_within_at(const FencePiece& piece, double t);
  ContactSearch touch_at_end(const FencePiece& piece, bool& is_within);
  ContactSearch touch_surfaces(const FencePiece& piece, const Frame& mover_frame, const Frame& fence_frame);
  bool holds_a_piece(const Placed& outer, const Placed& inner, PiecePoints& points);
  SweptContact sweep(const FencePiece& piece);
  SweptContact sweep_span(const FencePiece& piece, const TimeSpan& span);
  double bracket_width(const FencePiece& piece) const;
  std::optional<SweptContact> sweep_sphere(const FencePiece& piece, bool is_mover);
  ContactEnd leaving(const FencePiece& piece);
  ContactEnd in_seconds(const FencePiece& piece, const TimeBracket& bracket, const Contact& at) const;
  std::int64_t clock_error_ns(const FencePiece& piece) const;
  FoundContact found_in(const FencePiece& piece) const;
  bool band_looks_at(std::uint32_t fence, const ObjectInfo& mover) const;
  Placed placed_fence(std::uint32_t fence, const Frame& frame);
  bool may_begin();

  const StepView& step_;
  const ObjectRows& rows_;
  FenceTable& table_;
  ContactLedger& ledger_;
  FenceLists& lists_;
  StepCost& cost_;
  WalkCost walk_;
  BandDecisions bands_;  // of the fences that are bands
};

}  // namespace collided::engine
