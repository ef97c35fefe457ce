#include "client/view/page_feed.hpp"

#include <charconv>

#include "client/view/page_messages.hpp"

namespace collided::view {
namespace {

enum Lane : std::uint8_t { kEveryOne, kPoses, kStatus, kTable, kStanding };

WebMessage text_message(std::string text, Lane lane = kEveryOne) {
  return {.bytes = make_bytes(std::move(text)), .is_text = true, .lane = lane};
}

}  // namespace

void PageFeed::objects(const std::shared_ptr<const ShownObjects>& shown) {
  Bytes text = make_bytes(objects_text(*shown));
  {
    const std::lock_guard lock(mutex_);
    shown_ = shown;
    objects_ = std::move(text);
    std::map<std::uint64_t, KnownSurface> surfaces;
    for (const ShownObject& object : shown->objects) {
      for (const SurfaceRun& run : object.runs) {
        if (!run.surface) continue;
        const auto known = surfaces_.find(run.surface->number);
        const bool is_same = known != surfaces_.end() && known->second.surface == run.surface;
        surfaces.try_emplace(run.surface->number, is_same ? known->second : KnownSurface{run.surface, {}});
      }
    }
    surfaces_ = std::move(surfaces);
  }
  tell_(text_message(table_text(*shown), kTable));
}

void PageFeed::poses(const Poses& poses) {
  const Bytes bytes = make_bytes(poses_bytes(poses));
  {
    const std::lock_guard lock(mutex_);
    poses_ = bytes;
  }
  tell_({.bytes = bytes, .is_text = false, .lane = kPoses});
}

void PageFeed::status(const ServerStatus& status, const std::optional<Figures>& recent) {
  const WebMessage message = text_message(status_text(status, recent), kStatus);
  {
    const std::lock_guard lock(mutex_);
    status_ = message.bytes;
  }
  tell_(message);
}

void PageFeed::standing(std::span<const draw::StandingOutline> outlines) {
  const WebMessage message = text_message(standing_text(outlines), kStanding);
  {
    const std::lock_guard lock(mutex_);
    standing_ = message.bytes;
  }
  tell_(message);
}

void PageFeed::silent(double seconds) { tell_(text_message(silent_text(seconds), kStatus)); }

void PageFeed::events(std::span<const Event> events) {
  {
    const std::lock_guard lock(mutex_);
    for (const Event& event : events) {
      const std::pair pair(event.a_id, event.b_id);
      if (event.kind == EventKind::ended) contacts_.erase(pair);
      else if (contacts_.size() < kMostContacts) contacts_.insert_or_assign(pair, event);
    }
  }
  tell_(text_message(events_text(events, kMostEventsReported)));
}

std::vector<WebMessage> PageFeed::first_words() const {
  const std::lock_guard lock(mutex_);
  std::vector<WebMessage> words;
  if (status_) words.push_back({status_, true, kStatus});
  if (shown_) words.push_back(text_message(table_text(*shown_), kTable));
  if (standing_) words.push_back({standing_, true, kStanding});
  std::vector<Event> contacts;
  for (const auto& [pair, contact] : contacts_) contacts.push_back(contact);
  words.push_back(text_message(contacts_text(contacts, kMostContactsReported)));
  if (poses_) words.push_back({poses_, false, kPoses});
  return words;
}

std::optional<WebPage> PageFeed::page(std::string_view target) const {
  const std::lock_guard lock(mutex_);
  if (target == "/objects") return objects_ ? std::optional(WebPage{"application/json", objects_}) : std::nullopt;
  constexpr std::string_view kSurface = "/surface?number=";
  if (!target.starts_with(kSurface)) return std::nullopt;
  const std::string_view text = target.substr(kSurface.size());
  std::uint64_t number = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failed != std::errc() || end != text.data() + text.size()) return std::nullopt;
  const auto found = surfaces_.find(number);
  if (found == surfaces_.end()) return std::nullopt;
  const KnownSurface& known = found->second;
  if (!known.bytes) known.bytes = make_bytes(surface_bytes(*known.surface));
  return WebPage{"application/octet-stream", known.bytes};
}

std::shared_ptr<const ShownObjects> PageFeed::shown() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

std::vector<std::uint64_t> PageFeed::surfaces() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::uint64_t> numbers;
  for (const auto& [number, surface] : surfaces_) numbers.push_back(number);
  return numbers;
}

}  // namespace collided::view
