#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "client/view/follower.hpp"
#include "client/view/web_server.hpp"

namespace collided::view {

/// Makes the messages for pages: changes as they come, and the full state for a page that connects later.
///
/// threads  any; `tell` is called without a lock held
class PageFeed : public Observer {
 public:
  using Tell = std::function<void(const WebMessage&)>;  // sends to every page
  explicit PageFeed(Tell tell) : tell_(std::move(tell)) {}

  void objects(const std::shared_ptr<const ShownObjects>& shown) override;
  void poses(const Poses& poses) override;
  void status(const ServerStatus& status, const std::optional<Figures>& recent) override;
  void standing(std::span<const draw::StandingOutline> outlines) override;
  void silent(double seconds) override;
  void events(std::span<const Event> events) override;

  /// The messages for a page that has just connected.
  std::vector<WebMessage> first_words() const;
  /// "/objects" or "/surface?number=N" of the newest table; nothing if there is no such page.
  std::optional<WebPage> page(std::string_view target) const;
  /// The newest table of objects; null before the first.
  std::shared_ptr<const ShownObjects> shown() const;
  /// The numbers of all surfaces in the newest table.
  std::vector<std::uint64_t> surfaces() const;

 private:
  /// Limits: a world may have more contacts than a page can show or a viewer should keep.
  static constexpr std::size_t kMostContacts = 20'000;
  static constexpr std::size_t kMostContactsReported = 2'000;
  static constexpr std::size_t kMostEventsReported = 500;

  struct KnownSurface {
    std::shared_ptr<const Surface> surface;
    mutable Bytes bytes;  // made at the first request
  };

  const Tell tell_;
  mutable std::mutex mutex_;
  std::shared_ptr<const ShownObjects> shown_;
  Bytes objects_;
  std::map<std::uint64_t, KnownSurface> surfaces_;
  Bytes poses_;
  Bytes status_;
  Bytes standing_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, Event> contacts_;
};

}  // namespace collided::view
