#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/world/fences/fence.hpp"
#include "server/world/objects/shared_primitives.hpp"
#include "server/world/objects/sweep.hpp"

namespace collided::engine {

/// The fences of a world, by slot and by name, with an index over their bounds. Most are one primitive, which takes
/// about 300 bytes in all.
/// threads  the writer only
class FenceTable {
 public:
  static constexpr std::uint32_t kMost = 1'000'000;
  static constexpr std::uint32_t kNone = 0xffffffff;

  FenceTable() = default;
  FenceTable(const FenceTable&) = delete;
  FenceTable& operator=(const FenceTable&) = delete;

  /// Adds a fence. The caller has checked that the name is free and that there is room.
  ObjectId add(const FenceDefinition& definition);
  /// Takes slots for that many bands of one object, in the order of their ids, which is the order of their events.
  std::vector<std::uint32_t> take_slots(std::size_t count);
  /// Puts a band around the object into such a slot. Its name must be unused.
  ///
  /// widest  slot of the widest band of the same margin and object, possibly this one
  void add_band(std::uint32_t slot, std::uint32_t widest, const std::string& name, const FenceRule& rule,
                std::shared_ptr<const ObjectInfo> about, std::uint32_t object);
  void remove(std::uint32_t slot);

  std::size_t size() const { return fences_.size(); }  // number of slots, including free ones
  std::size_t count() const { return by_name_.size(); }
  bool holds(std::uint32_t slot) const { return slot < fences_.size() && fences_[slot].rule != nullptr; }
  std::optional<std::uint32_t> find(std::string_view name) const;
  /// Id of the fence in a slot in use.
  ObjectId id(std::uint32_t slot) const {
    const FenceRow& fence = fences_[slot];
    const ObjectId kind = kStandingBit | (fence.rule && fence.rule->nearest ? kNearestBit : 0);
    return kind | (static_cast<ObjectId>(fence.generation) << 32) | slot;
  }
  /// A removed fence keeps its name until its slot is used again.
  const std::string& name(std::uint32_t slot) const { return fences_[slot].name; }
  const FenceRule& rule(std::uint32_t slot) const { return *fences_[slot].rule; }
  bool is_band(std::uint32_t slot) const { return rule(slot).band.has_value(); }
  /// True for a question for the nearest: it has no bounds, and nothing is inside it.
  bool is_nearest(std::uint32_t slot) const { return rule(slot).nearest.has_value(); }
  std::uint32_t widest(std::uint32_t slot) const { return fences_[slot].widest; }
  /// True if it lies within another band: it has no bounds of its own, and is found by those of the widest.
  bool is_inner_band(std::uint32_t slot) const { return is_band(slot) && widest(slot) != slot; }
  /// True if it is found by bounds of its own.
  bool has_bounds(std::uint32_t slot) const { return !is_inner_band(slot) && !is_nearest(slot); }
  /// How far a band reaches beyond its body, metres.
  double beyond_m(std::uint32_t slot) const { return is_band(slot) ? rule(slot).band->reach_m() : 0; }
  /// The fence as an object, whose frame is the world's or its carrier's. Valid until the next call for another fence.
  const ObjectInfo& body(std::uint32_t slot);
  /// A copy of body(), for descriptions.
  ObjectInfo described(std::uint32_t slot) const;
  /// Largest distance of a point of the fence from the origin of that frame, metres.
  double reach_m(std::uint32_t slot) { return reach_of(body(slot)); }
  std::size_t bytes() const;

  /// Slot of the object that carries it; kNone: it stands in the world, or its carrier does not exist.
  std::uint32_t carrier(std::uint32_t slot) const;
  bool is_carried(std::uint32_t slot) const { return !rule(slot).carrier.empty() || is_band(slot); }
  /// Fences carried by the object in that slot.
  std::span<const std::uint32_t> carried_by(std::uint32_t object) const;
  /// Slots of all fences with a carrier, even if it does not exist yet.
  const std::unordered_set<std::uint32_t>& carried() const { return carried_; }
  void bind(std::uint32_t slot, std::uint32_t object);
  void unbind(std::uint32_t slot);
  /// The fences that wait for an object of this name, to be bound to it.
  std::vector<std::uint32_t> waiting_for(std::string_view carrier) const;

  const Aabb& bounds(std::uint32_t slot) const { return bounds_[slot]; }
  void set_bounds(std::uint32_t slot, const Aabb& bounds);
  /// Brings the index up to date with the bounds; then it may be walked.
  /// False: nothing changed.
  bool update_index();
  const Grid& index() const { return *index_; }

 private:
  struct FenceRow {
    std::string name;
    std::shared_ptr<const FenceRule> rule;  // null: the slot is free
    SharedPrimitives primitive;             // the whole fence, if there is no body
    std::shared_ptr<const ObjectInfo> body;
    std::uint32_t generation = 1;
    std::uint32_t widest = kNone;  // for a band
  };

  /// Finds slots by the names in fences_, so that names are stored once.
  struct NameHash {
    using is_transparent = void;
    const std::deque<FenceRow>* fences;
    std::size_t operator()(std::string_view name) const { return std::hash<std::string_view>{}(name); }
    std::size_t operator()(std::uint32_t slot) const { return (*this)((*fences)[slot].name); }
  };
  struct NameEqual {
    using is_transparent = void;
    const std::deque<FenceRow>* fences;
    std::string_view name(std::string_view text) const { return text; }
    std::string_view name(std::uint32_t slot) const { return (*fences)[slot].name; }
    template <class A, class B>
    bool operator()(const A& a, const B& b) const {
      return name(a) == name(b);
    }
  };

  std::shared_ptr<const FenceRule> shared(const FenceRule& rule);
  std::uint32_t take_slot();

  std::deque<FenceRow> fences_;  // a deque grows in blocks, without large unused reserves
  std::vector<Aabb> bounds_;     // empty: the slot is free, or the carrier does not exist
  std::vector<std::uint32_t> free_;
  std::unordered_set<std::uint32_t, NameHash, NameEqual> by_name_{0, NameHash{&fences_}, NameEqual{&fences_}};
  std::unordered_multimap<std::size_t, std::weak_ptr<const FenceRule>> rules_;
  RecentPrimitives primitives_;
  std::unordered_map<std::uint32_t, std::uint32_t> carrier_of_;               // carrier by fence
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> carried_by_;  // fences by carrier
  std::unordered_set<std::uint32_t> carried_;
  ObjectInfo scratch_;
  std::uint32_t scratch_slot_ = kNone;
  std::unique_ptr<Grid> index_ = std::make_unique<Grid>(Grid::Use::pairs);
  std::vector<std::uint32_t> changed_;  // since the last update of the index
};

}  // namespace collided::engine
