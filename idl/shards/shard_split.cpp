#include "idl/shards/shard_split.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

#include "idl/outside_text.hpp"

namespace collided::shards {
namespace {

using nlohmann::json;

constexpr std::array<std::pair<SuccessionPhase, std::string_view>, 4> kPhases{
    {{SuccessionPhase::joining, "joining"},
     {SuccessionPhase::in_force, "in_force"},
     {SuccessionPhase::done, "done"},
     {SuccessionPhase::withdrawn, "withdrawn"}}};

bool is_same_box(const ShardBox& a, const ShardBox& b) { return a.low == b.low && a.high == b.high; }

bool lies_in(const ShardBox& inner, const ShardBox& outer) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (inner.low[axis] < outer.low[axis] || inner.high[axis] > outer.high[axis]) return false;
  }
  return true;
}

}  // namespace

ShardSplit split_between(const ShardMap& map, const ShardMap& next) {
  if (map.margin_m() != next.margin_m()) throw ShardMapError("the maps differ in their margins");
  std::optional<std::size_t> from;
  for (std::size_t place = 0; place < map.size(); ++place) {
    const ShardEntry& shard = map.at(place);
    const auto there = next.find(shard.name);
    if (there && !is_same_box(next.at(*there).box, shard.box))
      throw ShardMapError("shard '" + shard.name +
                          "' has another box; one that is split is replaced by others of new names");
    if (there) continue;
    if (from)
      throw ShardMapError("shards '" + map.at(*from).name + "' and '" + shard.name +
                          "' are both gone; one is split at a time");
    from = place;
  }
  if (!from) throw ShardMapError("no shard is split: all of the map before are in the next one");
  ShardSplit split{.from = *from, .into = {}};
  // Both maps fill space and the other boxes are the same, so the new ones fill the box of the one that is gone.
  for (std::size_t place = 0; place < next.size(); ++place) {
    if (map.find(next.at(place).name)) continue;
    if (!lies_in(next.at(place).box, map.at(*from).box))
      throw ShardMapError("shard '" + next.at(place).name + "' reaches out of '" + map.at(*from).name +
                          "', which is split");
    split.into.push_back(place);
  }
  if (split.into.size() < 2)
    throw ShardMapError("shard '" + map.at(*from).name + "' has another name; a split makes two of it or more");
  if (map.size() + split.into.size() > ShardMap::kMostShards)
    throw ShardMapError("at most " + std::to_string(ShardMap::kMostShards) +
                        " shards, old and new, can be there at a time");
  return split;
}

std::string_view name_of(SuccessionPhase phase) {
  return std::ranges::find(kPhases, phase, &std::pair<SuccessionPhase, std::string_view>::first)->second;
}

std::optional<SuccessionPhase> succession_phase(std::string_view name) {
  const auto found = std::ranges::find(kPhases, name, &std::pair<SuccessionPhase, std::string_view>::second);
  if (found == kPhases.end()) return std::nullopt;
  return found->first;
}

std::string fingerprint_text(std::uint64_t fingerprint) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(fingerprint));
  return text.data();
}

std::optional<std::uint64_t> fingerprint_of(std::string_view text) {
  std::uint64_t fingerprint = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, fingerprint, 16);
  if (text.size() != 16 || read.ptr != end || read.ec != std::errc()) return std::nullopt;
  return fingerprint;
}

std::string succession_text(const MapSuccession& succession) {
  return json{{"revision", succession.revision},
              {"phase", name_of(succession.phase)},
              {"from", fingerprint_text(succession.from)},
              {"map", succession.next.text()}}
      .dump();
}

MapSuccession parse_succession(std::string_view text) {
  if (wire_contract::nests_too_deep(text)) throw ShardMapError("the words about a shard map nest too deep");
  const json said = json::parse(text, nullptr, false);
  const auto word = [&](const char* key) -> std::string {
    const auto found = said.is_object() ? said.find(key) : said.end();
    if (found == said.end() || !found->is_string()) throw ShardMapError(std::string("'") + key + "' must be a text");
    return found->get<std::string>();
  };
  const auto phase = succession_phase(word("phase"));
  if (!phase) throw ShardMapError("'phase' is joining, in_force, done or withdrawn");
  const auto from = fingerprint_of(word("from"));
  if (!from) throw ShardMapError("'from' must be the fingerprint of a map, 16 hexadecimal digits");
  const auto revision = said.find("revision");
  if (revision == said.end() || !revision->is_number_unsigned())
    throw ShardMapError("'revision' must be a whole number");
  return {
      .revision = revision->get<std::uint64_t>(), .phase = *phase, .from = *from, .next = ShardMap::parse(word("map"))};
}

}  // namespace collided::shards
