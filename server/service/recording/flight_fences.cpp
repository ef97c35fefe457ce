#include "server/service/recording/flight_fences.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "idl/commands.hpp"
#include "idl/glob.hpp"
#include "idl/packed_fences.hpp"
#include "idl/topics.hpp"

namespace collided::engine::service {
namespace {

using nlohmann::json;
using recording::Recorded;

/// Bytes of fences in one command; DDS delivers no message above kMaxMessageBytes.
constexpr std::size_t kMostPacked = wire_contract::kMaxMessageBytes - std::size_t{64} * 1024;

constexpr const char* kMany = R"({"command":"fence","many":true})";

bool is_true(const json& arguments, const char* key) {
  const auto found = arguments.find(key);
  return found != arguments.end() && found->is_boolean() && found->get<bool>();
}

std::string name_in(const json& arguments) {
  const auto found = arguments.find("name");
  return found != arguments.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::vector<std::byte> query_of(std::uint64_t client, std::string_view text, std::span<const std::uint8_t> blob) {
  dds::Sample<wire::Query> query;
  query->client = client;
  query->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::command);
  query->chunk_count = 1;
  static_cast<void>(dds::set_text(query->text, text));  // of those that fit
  dds::borrow(query->blob, blob);
  return wire::cdr_bytes(*query);
}

}  // namespace

std::size_t FlightFences::Standing::bytes() const {
  constexpr std::size_t kOverhead = 150;  // of the map, and of the name
  return text.size() + shape.size() + kOverhead;
}

void FlightFences::done(const wire::Query& query, const json& arguments) {
  if (!arguments.is_object()) return;
  const std::span<const std::byte> blob = std::as_bytes(dds::view(query.blob));
  if (is_true(arguments, "remove")) {
    return remove(name_in(arguments), is_true(arguments, "margins")   ? Kind::margin
                                      : is_true(arguments, "nearest") ? Kind::nearest
                                                                      : Kind::fence);
  }
  if (!is_true(arguments, "many")) return add(query.client, arguments, blob);
  const auto packed = wire_contract::unpack_fences(blob);
  if (!packed) return;
  for (const wire_contract::PackedFence& one : *packed)
    add(query.client, json::parse(one.arguments, nullptr, false), one.shape);
}

void FlightFences::add(std::uint64_t client, const json& arguments, std::span<const std::byte> shape) {
  if (!arguments.is_object()) return;
  const std::string name = name_in(arguments);
  Standing fence{.kind = arguments.contains("bands")    ? Kind::margin
                         : arguments.contains("within") ? Kind::nearest
                                                        : Kind::fence,
                 .owner = is_true(arguments, "keep") ? 0 : client,
                 .number = added_++,
                 .text = arguments.dump(-1, ' ', false, json::error_handler_t::replace),
                 .shape = {}};
  const std::size_t room = kMostBytes - bytes_;
  if (fence.bytes() + shape.size() > room) {
    ++left_out_;
    return;
  }
  const auto* const first = reinterpret_cast<const std::uint8_t*>(shape.data());
  fence.shape.assign(first, first + shape.size());
  const auto [place, is_new] = standing_.try_emplace(name);
  if (!is_new) bytes_ -= place->second.bytes();
  bytes_ += fence.bytes();
  place->second = std::move(fence);
}

template <class IsChosen>
void FlightFences::remove_if(const IsChosen& is_chosen) {
  std::erase_if(standing_, [&](const auto& entry) {
    const bool is_gone = is_chosen(entry.first, entry.second);
    bytes_ -= is_gone ? entry.second.bytes() : 0;
    return is_gone;
  });
}

void FlightFences::remove(const std::string& glob, Kind kind) {
  // One name among many is looked up.
  const auto found = standing_.find(glob);
  if (found != standing_.end() && found->second.kind == kind) {
    bytes_ -= found->second.bytes();
    standing_.erase(found);
  }
  if (!glob.empty() && glob.find_first_of("*?[") == std::string::npos) return;
  remove_if([&](const std::string& name, const Standing& fence) {
    return fence.kind == kind && (glob.empty() || wire_contract::glob_matches(glob, name));
  });
}

void FlightFences::owner_gone(std::uint64_t client) {
  remove_if([&](const std::string&, const Standing& fence) { return fence.owner == client; });
}

void FlightFences::write(const std::function<void(Recorded, std::span<const std::byte>)>& put) const {
  std::map<std::uint64_t, const Standing*> by_age;
  for (const auto& [name, fence] : standing_) by_age[fence.number] = &fence;
  const bool are_few = by_age.size() <= kMostSingle;
  std::uint64_t owner = 0;
  std::vector<std::uint8_t> packed;
  const auto send = [&] {
    if (!packed.empty()) put(Recorded::query, query_of(owner, kMany, packed));
    packed.clear();
  };
  for (const auto& [number, fence] : by_age) {
    // Of a long polygon's corners there may be more than a text has room for; the bytes of many have.
    const bool is_single = are_few && fence->text.size() < sizeof(wire::Query::text);
    const bool is_full = packed.size() + fence->text.size() + fence->shape.size() > kMostPacked;
    if (is_single || is_full || fence->owner != owner) send();
    owner = fence->owner;
    if (is_single) put(Recorded::query, query_of(owner, fence->text, fence->shape));
    else wire_contract::pack_fence(packed, fence->text, fence->shape);
  }
  send();
}

}  // namespace collided::engine::service
