#include "server/service/events/frames.hpp"

#include <algorithm>

#include "idl/columns.hpp"
#include "idl/topics.hpp"
#include "server/world/fences/fences.hpp"

namespace collided::engine::service {
namespace {

/// -0 is reported as 0.
void append(std::vector<double>& numbers, double value) { numbers.push_back(value + 0.0); }

void append(std::vector<double>& numbers, const Vec3& vector) {
  for (const double value : vector) append(numbers, value);
}

void append(std::vector<double>& numbers, const OpenContact& open) {
  append(numbers, open.contact.point);
  for (const Contact* contact : {&open.contact, &open.surface}) {
    append(numbers, contact->normal);
    append(numbers, contact->depth_m);
    append(numbers, contact->depth_error_m);
  }
}

std::uint32_t triangle_of_a(const OpenContact& of, const NameBook& book) {
  return of.contained == Contained::a_in_b ? wire_contract::kWithin : book.triangle(of.a, of.a_triangle);
}

std::uint32_t triangle_of_b(const OpenContact& of, const NameBook& book) {
  return of.contained == Contained::b_in_a ? wire_contract::kWithin : book.triangle(of.b, of.b_triangle);
}

}  // namespace

void NameBook::note(ObjectId id, const World& world) {
  Entry& entry = entries_[id];
  if (entry.contacts++ > 0) return;
  if (is_fence(id)) entry.name = world.fences()->name(id);
  if (const ObjectInfo* info = world.info(id)) {
    entry.name = info->name;
    entry.cut = info->rare->cut;
    entry.part_triangles = info->part_triangles;
  }
}

void NameBook::forget(ObjectId id) {
  const auto found = entries_.find(id);
  if (found != entries_.end() && --found->second.contacts == 0) entries_.erase(found);
}

void NameBook::note(const OpenContact& contact, const World& world) {
  note(contact.a, world);
  note(contact.b, world);
}

void NameBook::forget(const OpenContact& contact) {
  forget(contact.a);
  forget(contact.b);
}

std::string_view NameBook::name(ObjectId id) const {
  const auto found = entries_.find(id);
  return found == entries_.end() ? std::string_view() : found->second.name;
}

std::uint32_t NameBook::triangle(ObjectId id, std::uint32_t triangle) const {
  const auto found = entries_.find(id);
  return found == entries_.end() ? triangle : found->second.cut.told(triangle, found->second.part_triangles);
}

void NameTable::clear() {
  ids.clear();
  names.clear();
}

void NameTable::keep_each_once() {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

void NameTable::append(std::string_view name) {
  names.insert(names.end(), name.begin(), name.end());
  names.push_back(0);
}

void EventColumns::clear() {
  first_sequence = 0;
  for (auto* column : {&kinds, &reasons, &doubts, &shards}) column->clear();
  for (auto* column : {&a, &b, &episodes}) column->clear();
  for (auto* column : {&a_triangles, &b_triangles}) column->clear();
  numbers.clear();
  named.clear();
}

void EventColumns::add(const Event& event, const NameBook& book, bool is_merged) {
  if (kinds.empty()) first_sequence = event.sequence;
  kinds.push_back(static_cast<std::uint8_t>(event.kind));
  reasons.push_back(static_cast<std::uint8_t>(event.reason));
  const std::uint8_t merged = is_merged ? wire_contract::kPosesMerged : 0;
  doubts.push_back(static_cast<std::uint8_t>(static_cast<std::uint8_t>(event.of.doubt) | merged));
  shards.push_back(wire_contract::contact_shard(event.of.a, event.of.b));
  a.push_back(event.of.a);
  b.push_back(event.of.b);
  a_triangles.push_back(triangle_of_a(event.of, book));
  b_triangles.push_back(triangle_of_b(event.of, book));
  episodes.push_back(event.of.episode);
  append(numbers, event.of);
  append(numbers, event.bracket_low_s);
  append(numbers, event.bracket_high_s);
  append(numbers, event.relative_velocity);
  append(numbers, event.velocity_error);
  named.add_id(event.of.a);
  named.add_id(event.of.b);
}

void ProbeColumns::clear() {
  states.clear();
  for (auto* column : {&objects, &met}) column->clear();
  triangles.clear();
  numbers.clear();
  probe_names.clear();
  named.clear();
}

void ProbeColumns::add(std::string_view probe_name, const ProbeReading& reading) {
  states.push_back(static_cast<std::uint8_t>(reading.state));
  objects.push_back(reading.object);
  met.push_back(reading.met);
  triangles.push_back(reading.triangle);
  append(numbers, reading.clearance_m);
  append(numbers, reading.error_m);
  append(numbers, reading.point);
  append(numbers, reading.normal);
  probe_names.insert(probe_names.end(), probe_name.begin(), probe_name.end());
  probe_names.push_back(0);
  if (reading.object != 0) named.add_id(reading.object);
  if (reading.met != 0) named.add_id(reading.met);
}

void ContactColumns::clear() {
  doubts.clear();
  for (auto* column : {&a, &b, &episodes}) column->clear();
  for (auto* column : {&a_triangles, &b_triangles}) column->clear();
  began_ns.clear();
  numbers.clear();
  named.clear();
}

std::size_t ContactColumns::bytes() const {
  constexpr std::size_t kBytesPerContact =
      1 + 3 * 8 + 2 * 4 + 8 + 8 * wire::width_of<wire::ContactShard>(wire::kContactColumns);
  return size() * kBytesPerContact + named.ids.size() * sizeof(ObjectId) + named.names.size();
}

void ContactColumns::add(const OpenContact& contact, const NameBook& book) {
  doubts.push_back(static_cast<std::uint8_t>(contact.doubt));
  a.push_back(contact.a);
  b.push_back(contact.b);
  episodes.push_back(contact.episode);
  a_triangles.push_back(triangle_of_a(contact, book));
  b_triangles.push_back(triangle_of_b(contact, book));
  began_ns.push_back(contact.began_ns);
  append(numbers, contact);
  named.add_id(contact.a);
  named.add_id(contact.b);
}

}  // namespace collided::engine::service
