#include "idl/shards/shard_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "idl/outside_text.hpp"

namespace collided::shards {
namespace {

using nlohmann::json;
using wire_contract::shown;

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr std::size_t kMostNameBytes = 63;
constexpr const char* kNameRule = "its name must be 1 to 63 letters, digits or '_'";

std::string text_of(double value) {
  if (std::isinf(value)) return value < 0 ? "-endless" : "endless";
  return json(value).dump();
}

std::string text_of(const std::array<double, 3>& point) {
  return '(' + text_of(point[0]) + ", " + text_of(point[1]) + ", " + text_of(point[2]) + ')';
}

bool is_name(std::string_view name) {
  const auto is_fit = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && name.size() <= kMostNameBytes && std::ranges::all_of(name, is_fit);
}

std::array<double, 3> read_corner(const json& shard, const char* key, double endless, const std::string& where) {
  const auto found = shard.find(key);
  if (found == shard.end() || !found->is_array() || found->size() != 3) {
    throw ShardMapError(where + ": '" + key + "' must be three numbers or nulls, [x, y, z]");
  }
  std::array<double, 3> corner{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const json& side = (*found)[axis];
    if (!side.is_null() && !side.is_number()) {
      throw ShardMapError(where + ": '" + key + "' has " + shown(side.dump()) +
                          "; allowed are numbers, and null for endless");
    }
    corner[axis] = side.is_null() ? endless : side.get<double>();
    if (!side.is_null() && !std::isfinite(corner[axis])) {
      throw ShardMapError(where + ": '" + key + "' has a number that is not finite; endless is null");
    }
  }
  return corner;
}

void refuse_unknown(const json& object, const std::set<std::string>& known, const std::string& where) {
  for (const auto& [key, value] : object.items()) {
    if (!known.contains(key)) throw ShardMapError(where + ": unknown key " + wire_contract::in_quotes(key));
  }
}

ShardEntry read_shard(const json& said, std::size_t place) {
  const std::string where = "shard " + std::to_string(place);
  if (!said.is_object()) throw ShardMapError(where + " is no object");
  refuse_unknown(said, {"name", "low", "high"}, where);
  const auto name = said.find("name");
  if (name == said.end() || !name->is_string() || !is_name(name->get_ref<const std::string&>())) {
    throw ShardMapError(where + ": " + kNameRule);
  }
  ShardEntry shard{.name = name->get<std::string>(), .box = {}};
  const std::string named = "shard '" + shard.name + '\'';
  shard.box.low = read_corner(said, "low", -kEndless, named);
  shard.box.high = read_corner(said, "high", kEndless, named);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(shard.box.low[axis] < shard.box.high[axis])) {
      throw ShardMapError(named + ": 'low' must be below 'high'; it reaches from " + text_of(shard.box.low) + " to " +
                          text_of(shard.box.high));
    }
  }
  return shard;
}

/// Whether the boxes have more than a border in common.
bool overlap(const ShardBox& a, const ShardBox& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(std::max(a.low[axis], b.low[axis]) < std::min(a.high[axis], b.high[axis]))) return false;
  }
  return true;
}

void refuse_overlaps(const std::vector<ShardEntry>& shards) {
  for (auto a = shards.begin(); a != shards.end(); ++a) {
    for (auto b = std::next(a); b != shards.end(); ++b) {
      if (a->name == b->name) throw ShardMapError("two shards are called '" + a->name + '\'');
      if (!overlap(a->box, b->box)) continue;
      std::array<double, 3> low{};
      std::array<double, 3> high{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::max(a->box.low[axis], b->box.low[axis]);
        high[axis] = std::min(a->box.high[axis], b->box.high[axis]);
      }
      throw ShardMapError("shards '" + a->name + "' and '" + b->name + "' overlap from " + text_of(low) + " to " +
                          text_of(high));
    }
  }
}

/// A point between two bounds that may be infinite.
double between(double low, double high) {
  if (std::isinf(low) && std::isinf(high)) return 0;
  if (std::isinf(low)) return high - std::max(1.0, std::abs(high));
  if (std::isinf(high)) return low + std::max(1.0, std::abs(low));
  return low + (high - low) / 2;
}

/// All sides of all boxes cut space into cells, each wholly inside or outside of every box.
void refuse_gaps(const std::vector<ShardEntry>& shards) {
  std::array<std::vector<double>, 3> cuts;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::set<double> sides{-kEndless, kEndless};
    for (const ShardEntry& shard : shards) sides.insert({shard.box.low[axis], shard.box.high[axis]});
    cuts[axis].assign(sides.begin(), sides.end());
  }
  const auto cell_of = [&](std::size_t axis, double side) {
    return static_cast<std::size_t>(std::ranges::lower_bound(cuts[axis], side) - cuts[axis].begin());
  };
  const std::array<std::size_t, 3> counts{cuts[0].size() - 1, cuts[1].size() - 1, cuts[2].size() - 1};
  std::vector<bool> is_filled(counts[0] * counts[1] * counts[2]);
  const auto place = [&](std::size_t x, std::size_t y, std::size_t z) { return (z * counts[1] + y) * counts[0] + x; };
  for (const ShardEntry& shard : shards) {
    std::array<std::size_t, 3> from{};
    std::array<std::size_t, 3> to{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      from[axis] = cell_of(axis, shard.box.low[axis]);
      to[axis] = cell_of(axis, shard.box.high[axis]);
    }
    for (std::size_t z = from[2]; z < to[2]; ++z) {
      for (std::size_t y = from[1]; y < to[1]; ++y) {
        for (std::size_t x = from[0]; x < to[0]; ++x) is_filled[place(x, y, z)] = true;
      }
    }
  }
  const auto gap = std::ranges::find(is_filled, false);
  if (gap == is_filled.end()) return;
  const auto number = static_cast<std::size_t>(gap - is_filled.begin());
  const std::array<std::size_t, 3> cell{number % counts[0], number / counts[0] % counts[1],
                                        number / counts[0] / counts[1]};
  std::array<double, 3> inside{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    inside[axis] = between(cuts[axis][cell[axis]], cuts[axis][cell[axis] + 1]);
  }
  throw ShardMapError("no shard holds what is at " + text_of(inside) +
                      "; the boxes must fill space, with null for a side "
                      "that has no end");
}

/// FNV-1a (Fowler, Noll, Vo), 64 bits.
class Fingerprint {
 public:
  void add(std::uint8_t byte) { hash_ = (hash_ ^ byte) * 0x100000001b3; }
  void add(std::string_view text) {
    for (const char letter : text) add(static_cast<std::uint8_t>(letter));
    add(std::uint8_t{0});
  }
  void add(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value);
    for (int byte = 0; byte < 8; ++byte) add(static_cast<std::uint8_t>(bits >> (8 * byte)));
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

}  // namespace

bool meet(const ShardBox& a, const ShardBox& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (a.high[axis] < b.low[axis] || b.high[axis] < a.low[axis]) return false;
  }
  return true;
}

ShardBox grown(const ShardBox& box, double by_m) {
  ShardBox larger;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    larger.low[axis] = std::nextafter(box.low[axis] - by_m, -kEndless);
    larger.high[axis] = std::nextafter(box.high[axis] + by_m, kEndless);
  }
  return larger;
}

ShardMap ShardMap::parse(std::string_view text) {
  if (text.size() > kMostBytes) {
    throw ShardMapError("the shard map has " + std::to_string(text.size()) + " bytes; allowed are " +
                        std::to_string(kMostBytes));
  }
  if (wire_contract::nests_too_deep(text)) {
    throw ShardMapError("the shard map nests deeper than " + std::to_string(wire_contract::kMostJsonDepth) + " levels");
  }
  const json said = json::parse(text, nullptr, false);
  if (!said.is_object()) throw ShardMapError("the shard map is no JSON object");
  refuse_unknown(said, {"margin_m", "shards"}, "the shard map");
  ShardMap map;
  if (const auto margin = said.find("margin_m"); margin != said.end()) {
    map.margin_m_ = margin->is_number() ? margin->get<double>() : std::nan("");
    if (!(map.margin_m_ >= kLeastMarginM && map.margin_m_ < kEndless)) {
      throw ShardMapError("'margin_m' is " + shown(margin->dump()) + "; allowed are numbers from 0.001");
    }
  }
  const auto shards = said.find("shards");
  if (shards == said.end() || !shards->is_array() || shards->empty() || shards->size() > kMostShards) {
    throw ShardMapError("'shards' must be a list of 1 to " + std::to_string(kMostShards) + " shards");
  }
  for (const json& shard : *shards) map.shards_.push_back(read_shard(shard, map.shards_.size()));
  map.finish();
  return map;
}

ShardMap ShardMap::of(double margin_m, std::vector<ShardEntry> shards) {
  if (shards.empty() || shards.size() > kMostShards) {
    throw ShardMapError(std::to_string(shards.size()) + " shards; a map holds 1 to " + std::to_string(kMostShards));
  }
  for (const ShardEntry& shard : shards) {
    if (!is_name(shard.name)) throw ShardMapError('\'' + shard.name + "': " + kNameRule);
  }
  ShardMap map;
  map.margin_m_ = margin_m;
  map.shards_ = std::move(shards);
  map.finish();
  return map;
}

std::string ShardMap::text() const {
  const auto written = [](const std::array<double, 3>& corner) {
    json list = json::array();
    for (const double side : corner) list.push_back(std::isinf(side) ? json(nullptr) : json(side));
    return list.dump();
  };
  std::string text = "{\"margin_m\": " + json(margin_m_).dump() + ", \"shards\": [\n";
  for (const ShardEntry& shard : shards_) {
    text += "  {\"name\": " + json(shard.name).dump() + ", \"low\": " + written(shard.box.low) +
            ", \"high\": " + written(shard.box.high) + (&shard == &shards_.back() ? "}]}\n" : "},\n");
  }
  return text;
}

void ShardMap::finish() {
  refuse_overlaps(shards_);
  refuse_gaps(shards_);
  Fingerprint fingerprint;
  fingerprint.add(margin_m_);
  for (const ShardEntry& shard : shards_) {
    hold(shard);
    fingerprint.add(shard.name);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      fingerprint.add(shard.box.low[axis]);
      fingerprint.add(shard.box.high[axis]);
    }
  }
  fingerprint_ = fingerprint.value();
}

void ShardMap::hold(const ShardEntry& shard) {
  active_ |= set_of(held_.size());
  held_.push_back(grown(shard.box, margin_m_));
}

ShardMap ShardMap::limited_to(ShardSet active) const {
  ShardMap limited = *this;
  limited.active_ = active;
  return limited;
}

ShardMap ShardMap::with(const std::vector<ShardEntry>& more) const {
  if (shards_.size() + more.size() > kMostShards) {
    throw ShardMapError(std::to_string(shards_.size() + more.size()) +
                        " shards, those before a split among them; at most " + std::to_string(kMostShards) +
                        " are known at a time");
  }
  ShardMap larger = *this;
  for (const ShardEntry& shard : more) {
    larger.hold(shard);
    larger.shards_.push_back(shard);
  }
  return larger;
}

ShardMap ShardMap::read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw ShardMapError(path + ": it cannot be opened");
  // One byte more than is allowed, so that a longer file is seen to be one.
  std::string text(kMostBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) throw ShardMapError(path + ": it cannot be read");
  text.resize(static_cast<std::size_t>(file.gcount()));
  try {
    return parse(text);
  } catch (const ShardMapError& wrong) { throw ShardMapError(path + ": " + wrong.what()); }
}

std::optional<std::size_t> ShardMap::find(std::string_view name) const {
  const auto found = std::ranges::find(shards_, name, &ShardEntry::name);
  if (found == shards_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - shards_.begin());
}

ShardSet ShardMap::touched_by(const ShardBox& box) const {
  ShardSet touched = 0;
  for (std::size_t i = 0; i < shards_.size(); ++i) touched |= ShardSet{meet(shards_[i].box, box)} << i;
  return touched & active_;
}

ShardSet ShardMap::holders_of(const ShardBox& box) const {
  ShardSet holders = 0;
  for (std::size_t i = 0; i < held_.size(); ++i) holders |= ShardSet{meet(held_[i], box)} << i;
  return holders & active_;
}

std::size_t ShardMap::owner_of(const std::array<double, 3>& point) const {
  return static_cast<std::size_t>(std::countr_zero(touched_by({point, point})));
}

std::string shard_namespace(std::string_view name_space, std::string_view shard) {
  return std::string(name_space) + "/shard_" + std::string(shard);
}

}  // namespace collided::shards
