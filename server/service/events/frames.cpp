#include "server/service/events/frames.hpp"

#include "idl/columns.hpp"
#include "idl/topics.hpp"

namespace collided::engine::service {
namespace {

/// The common part of events and contacts.
template <class Columns>
void put_contact(Columns& columns, const OpenContact& of, const NameBook& book, std::uint8_t marks) {
  wire::put_row(columns, of);
  wire::put_row(columns, of.contact);
  columns.doubts.back() = static_cast<std::uint8_t>(columns.doubts.back() | marks);
  static_assert(kNoTriangle == wire_contract::kNoTriangle);
  const auto triangle = [&](ObjectId id, std::uint32_t own, Contained within) {
    return of.contained == within ? wire_contract::kTriangleWithin : book.triangle(id, own);
  };
  columns.a_triangles.back() = triangle(of.a, of.a_triangle, Contained::a_in_b);
  columns.b_triangles.back() = triangle(of.b, of.b_triangle, Contained::b_in_a);
  put(columns.surface_normals, of.surface.normal);
  put(columns.surface_depths, of.surface.depth_m);
  put(columns.surface_depth_errors, of.surface.depth_error_m);
  columns.named_ids.insert(columns.named_ids.end(), {of.a, of.b});
}

}  // namespace

void NameBook::note(ObjectId id, const World& world) {
  Entry& entry = entries_[id];
  if (entry.contacts++ > 0) return;
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

void put(std::vector<std::uint8_t>& names, std::string_view name) {
  names.insert(names.end(), name.begin(), name.end());
  names.push_back(0);
}

void EventColumns::add(const Event& event, const NameBook& book, bool is_merged) {
  if (kinds.empty()) first_sequence = event.sequence;
  wire::put_row(*this, event);
  shards.push_back(wire_contract::contact_shard(event.of.a, event.of.b));
  put_contact(*this, event.of, book, is_merged ? wire_contract::kDoubtPosesMerged : 0);
  put(velocities, event.relative_velocity);
}

void ContactColumns::add(const OpenContact& contact, const NameBook& book) { put_contact(*this, contact, book, 0); }

std::size_t ContactColumns::bytes() const {
  return size() * wire::bytes_of_row<ContactShardColumns>() + named_ids.size() * sizeof(ObjectId) + names.size();
}

void ProbeColumns::add(std::string_view probe_name, const ProbeReading& reading) {
  wire::put_row(*this, reading);
  put(clearance_errors, reading.error_m);
  put(probe_names, probe_name);
  for (const ObjectId id : {reading.object, reading.met}) {
    if (id != 0) named_ids.push_back(id);
  }
}

}  // namespace collided::engine::service
