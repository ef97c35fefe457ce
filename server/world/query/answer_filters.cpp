#include "server/world/query/answer_filters.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "server/world/query/query.hpp"
#include "server/world/query/unknown_space.hpp"

namespace collided::engine {
namespace {

/// True if layers and name patterns let the object count.
bool is_asked_about(const ObjectInfo& info, const Questions& asked) {
  if ((info.filter.layers & asked.mask) == 0) return false;
  if (!asked.only.empty() && !glob_matches(asked.only, info.name)) return false;
  return asked.skip.empty() || !glob_matches(asked.skip, info.name);
}

bool is_filter_of(const AnswerFilter& filter, const Questions& asked) {
  return filter.mask == asked.mask && filter.only == asked.only && filter.skip == asked.skip;
}

/// Marks the unknown objects that count. A pattern for what may answer does not make other objects known; objects
/// excluded by name do not count.
void follow_unknown(const Snapshot& snapshot, const Questions& asked, std::shared_ptr<UnknownSpace>& unknown) {
  if (snapshot.objects.counts().unknown == 0) {
    if (unknown) unknown->is_any = false;
    return;
  }
  if (!unknown) unknown = std::make_shared<UnknownSpace>();
  Questions counting = asked;
  counting.only = {};
  unknown->objects.follow(snapshot.objects,
                          [&](const ObjectInfo& info) { return info.is_unknown && is_asked_about(info, counting); });
  const std::vector<std::uint8_t>& marks = unknown->objects.by_slot();
  unknown->is_any = std::find(marks.begin(), marks.end(), 1) != marks.end();
  unknown->scenes.assign(snapshot.scenes.size(), 0);
}

void follow_scenes(const Snapshot& snapshot, AnswerFilter& filter) {
  mark_open_scenes(snapshot.scenes, filter.allowed.by_slot(), filter.open_scenes);
  filter.all_open = std::all_of(filter.open_scenes.begin(), filter.open_scenes.end(), std::identity());
  filter.has_solids = std::any_of(snapshot.scenes.begin(), snapshot.scenes.end(),
                                  [](const auto& scene) { return !scene->solid_parts.empty(); });
  filter.parts_version = snapshot.objects.parts_version();
}

}  // namespace

bool may_answer(const ObjectInfo& info, const Questions& asked) {
  return !info.is_unknown && is_asked_about(info, asked);
}

void mark_open_scenes(const SceneList& scenes, const std::vector<std::uint8_t>& marks,
                      std::vector<std::uint8_t>& open) {
  open.clear();
  for (const auto& scene : scenes) {
    const bool is_open = std::all_of(scene->part_objects.begin(), scene->part_objects.end(),
                                     [&](ObjectId part) { return marks[slot_of(part)] != 0; });
    open.push_back(is_open ? 1 : 0);
  }
}

std::size_t AnswerFilter::bytes() const { return allowed.bytes() + (unknown ? unknown->objects.bytes() : 0); }

void AnswerFilters::take(const Snapshot& snapshot, const Questions& asked) {
  if (!is_filter_of(current_, asked)) switch_to(asked);
  AnswerFilter& filter = current_;
  if (filter.table_version == snapshot.objects.version()) return;
  filter.allowed.follow(snapshot.objects, [&](const ObjectInfo& info) { return may_answer(info, asked); });
  if (filter.parts_version != snapshot.objects.parts_version()) follow_scenes(snapshot, filter);
  follow_unknown(snapshot, asked, filter.unknown);
  filter.table_version = snapshot.objects.version();
  keep_within_bytes();
}

/// A new filter replaces the least recently used one and takes over its memory.
void AnswerFilters::switch_to(const Questions& asked) {
  current_.used_at = ++uses_;
  const auto known = std::find_if(others_.begin(), others_.end(),
                                  [&](const AnswerFilter& other) { return is_filter_of(other, asked); });
  if (known != others_.end()) return std::swap(current_, *known);
  if (count() >= kMost) {
    const auto oldest = std::ranges::min_element(others_, {}, &AnswerFilter::used_at);
    std::swap(current_, *oldest);
    ++dropped_;
  } else if (count() > others_.size()) {
    others_.push_back(std::exchange(current_, AnswerFilter{}));
  }
  current_.allowed.forget();
  if (current_.unknown) current_.unknown->objects.forget();
  current_.table_version = current_.parts_version = AnswerFilter::kNoVersion;
  current_.mask = asked.mask;
  current_.only = asked.only;
  current_.skip = asked.skip;
}

void AnswerFilters::keep_within_bytes() {
  while (!others_.empty() && bytes() - current_.bytes() > kMostBytes) {
    others_.erase(std::ranges::min_element(others_, {}, &AnswerFilter::used_at));
    ++dropped_;
  }
}

std::size_t AnswerFilters::bytes() const {
  std::size_t sum = current_.bytes();
  for (const AnswerFilter& other : others_) sum += other.bytes();
  return sum;
}

}  // namespace collided::engine
