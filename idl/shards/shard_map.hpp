#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// How a world that is too large for one server is split among several: each shard is a server that holds what touches its
/// box. Server and client library read the same file.
namespace collided::shards {

/// A map that cannot be used: what is wrong, and where.
struct ShardMapError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An axis-aligned box, closed; sides may be infinite. World coordinates, metres.
struct ShardBox {
  std::array<double, 3> low{};
  std::array<double, 3> high{};
};

/// Whether two closed boxes meet.
bool meet(const ShardBox& a, const ShardBox& b);
/// The box with every side moved outward, rounded outward.
ShardBox grown(const ShardBox& box, double by_m);

struct ShardEntry {
  std::string name;  // 1 to 63 of [A-Za-z0-9_], unique
  ShardBox box;
};

/// A bit for each shard, by its place in the map.
using ShardSet = std::uint64_t;
constexpr ShardSet set_of(std::size_t place) { return ShardSet{1} << place; }
/// Calls visit(place) for each of the set, in order.
template <class Visit>
void for_each_place(ShardSet set, const Visit& visit) {
  for (; set != 0; set &= set - 1) visit(static_cast<std::size_t>(std::countr_zero(set)));
}

/// The boxes of all shards. Together they fill space, and no two have more than a border in common.
///
/// threads  const functions from any thread
class ShardMap {
 public:
  static constexpr std::size_t kMostShards = 64;
  static constexpr std::size_t kMostBytes = 1 << 20;
  static constexpr double kLeastMarginM = 1e-3;

  /// A JSON text: {"margin_m": 2, "shards": [{"name": "west", "low": [null, null, null], "high": [0, null, null]}, ...]}.
  /// null is an endless side; margin_m is 1 where it is left out.
  ///
  /// throws  ShardMapError: no such JSON, a name twice, a flat box, an overlap, a gap (with a point in it)
  static ShardMap parse(std::string_view json);
  /// The same from a file; the message begins with its name.
  static ShardMap read(const std::string& path);
  /// The same of boxes that somebody has worked out.
  static ShardMap of(double margin_m, std::vector<ShardEntry> shards);
  /// The JSON text that parse() reads, a line for each shard, with a line feed at its end.
  std::string text() const;

  /// How far outside its box a shard still holds everything, metres. An object is sent to a shard before it can touch
  /// anything in that shard's box; and where the answers of two shards meet at a border, both hold both objects.
  double margin_m() const { return margin_m_; }
  std::size_t size() const { return shards_.size(); }
  const ShardEntry& at(std::size_t place) const { return shards_[place]; }
  std::optional<std::size_t> find(std::string_view name) const;
  /// The box in which a shard holds everything: its own, grown by the margin.
  const ShardBox& held_by(std::size_t place) const { return held_[place]; }

  /// The shards whose boxes meet this one.
  ShardSet touched_by(const ShardBox& box) const;
  /// The shards that must hold something that fills, at most, this box: those whose held_by() meets it.
  ShardSet holders_of(const ShardBox& box) const;
  /// The shard to whom a point belongs: the first in the map whose box contains it. What several shards tell of the same
  /// thing is taken from that one.
  std::size_t owner_of(const std::array<double, 3>& point) const;
  ShardSet all() const { return active_; }

  /// The same shards, of which only some hold anything: the others are in no set and own nothing, but keep their places.
  ShardMap limited_to(ShardSet active) const;
  /// With more shards behind those that are there, whose boxes may overlap them: for the time in which a shard is split.
  ///
  /// throws  ShardMapError for more than kMostShards
  ShardMap with(const std::vector<ShardEntry>& more) const;

  /// Of the map as it was read. The same for maps that say the same; two members with different ones do not fit together.
  std::uint64_t fingerprint() const { return fingerprint_; }

 private:
  ShardMap() = default;
  void finish();
  void hold(const ShardEntry& shard);

  double margin_m_ = 1;
  ShardSet active_ = 0;
  std::vector<ShardEntry> shards_;
  std::vector<ShardBox> held_;
  std::uint64_t fingerprint_ = 0;
};

/// The namespace in which a shard serves: "<name_space>/shard_<name>".
std::string shard_namespace(std::string_view name_space, std::string_view shard);

}  // namespace collided::shards
