#include "server/world/objects/attachments.hpp"

#include <algorithm>

namespace collided::engine {

const AttachedObject* Attachments::find(ObjectId child) const {
  const auto found = std::ranges::find(attached_, child, &AttachedObject::child);
  return found == attached_.end() ? nullptr : &*found;
}

bool Attachments::is_parent(ObjectId id) const {
  return std::ranges::find(attached_, id, &AttachedObject::parent) != attached_.end();
}

bool Attachments::follows(ObjectId id, ObjectId other) const {
  while (id != other) {
    const AttachedObject* attached = find(id);
    if (attached == nullptr) return false;
    id = attached->parent;
  }
  return true;
}

void Attachments::add(AttachedObject attached) {
  attached_.push_back(std::move(attached));
  index();
}

void Attachments::replace(std::size_t index_of, ObjectId child, ObjectId parent) {
  attached_[index_of].child = child;
  attached_[index_of].parent = parent;
  index();
}

void Attachments::remove(ObjectId child) {
  std::erase_if(attached_, [&](const AttachedObject& attached) { return attached.child == child; });
  index();
}

void Attachments::index() {
  for (auto& children : children_) children.clear();
  auto table = std::make_shared<ParentOf>();
  for (std::uint32_t i = 0; i < attached_.size(); ++i) {
    const std::uint32_t slot = slot_of(attached_[i].parent);
    if (slot >= children_.size()) children_.resize(slot + 1);
    children_[slot].push_back(i);
    table->emplace(attached_[i].child, attached_[i].parent);
  }
  table_ = table->empty() ? nullptr : std::move(table);
}

}  // namespace collided::engine
