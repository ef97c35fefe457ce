#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/view/follower.hpp"
#include "client/view/web_server.hpp"

namespace collided::view {

/// Shows the world to programs that speak the Foxglove WebSocket protocol, as JSON: channels /scene
/// (foxglove.SceneUpdate), /tf (foxglove.FrameTransforms, 10 a second at most), /contacts and /fences
/// (foxglove.SceneUpdate) and /events. Every moving object is a frame with its name, within the frame "world".
///
/// threads  any; `send` is called without a lock held
/// source   github.com/foxglove/ws-protocol, docs/spec.md; schemas: github.com/foxglove/foxglove-sdk,
///          schemas/jsonschema
class Foxglove : public Observer {
 public:
  using Connection = WebServer::Connection;
  using Send = std::function<void(Connection, const WebMessage&)>;
  explicit Foxglove(Send send) : send_(std::move(send)) {}

  /// The name of the protocol, if a client offers it.
  static std::optional<std::string> protocol(const std::vector<std::string>& offered);

  void opened(Connection client);
  void said(Connection client, std::string_view message, bool is_text);
  void closed(Connection client);

  void objects(const std::shared_ptr<const ShownObjects>& shown) override;
  void poses(const Poses& poses) override;
  void status(const ServerStatus&, const std::optional<Figures>&) override {}
  void standing(std::span<const draw::StandingOutline> outlines) override;
  void silent(double) override {}
  void events(std::span<const Event> events) override;

 private:
  enum Channel : std::uint32_t { kScene = 1, kTransforms, kContacts, kEvents, kStanding, kChannelEnd };
  static constexpr std::size_t kMostSubscriptions = 64;

  struct Subscription {
    std::uint32_t number = 0;  // the client's number for it
    Channel channel = kScene;
    std::uint8_t lane = 0;  // of the WebMessages for it
  };
  struct Client {
    std::vector<Subscription> subscriptions;
  };
  struct Outgoing {
    Connection to = 0;
    WebMessage message;
  };

  static std::uint8_t free_lane(const std::vector<Subscription>& subscriptions, Channel channel);
  static std::string data(std::uint32_t subscription, std::int64_t time_ns, std::string_view json);
  void publish(Channel channel, std::int64_t time_ns, const std::string& json);
  std::vector<Outgoing> subscribe(Connection client, std::string_view message);

  const Send send_;
  std::mutex mutex_;
  std::map<Connection, Client> clients_;
  std::map<std::uint64_t, std::string> frames_;  // names of moving objects by id
  std::map<std::string, Pose> still_;            // poses of the other objects, by name
  std::shared_ptr<const std::string> scene_;     // this and the next: for clients that subscribe later
  std::shared_ptr<const std::string> standing_;
  std::int64_t scene_time_ns_ = 0;
  std::int64_t transforms_time_ns_ = 0;
};

}  // namespace collided::view
