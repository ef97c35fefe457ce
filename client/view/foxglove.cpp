#include "client/view/foxglove.hpp"

#include <algorithm>
#include <cstring>

#include <nlohmann/json.hpp>

#include "client/view/foxglove_scene.hpp"

namespace collided::view {
namespace {

using nlohmann::json;

constexpr std::string_view kProtocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
constexpr std::int64_t kTransformsPeriod_ns = 100'000'000;

WebMessage text_message(const json& message) {
  return {
      .bytes = make_bytes(message.dump(-1, ' ', false, json::error_handler_t::replace)), .is_text = true, .lane = 0};
}

WebMessage warning(const std::string& text) {
  return text_message({{"op", "status"}, {"level", 1}, {"message", text}});
}

std::optional<std::uint32_t> whole_number(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() > 0xffffffff)
    return std::nullopt;
  return found->get<std::uint32_t>();
}

json list(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? *found : json::array();
}

}  // namespace

std::optional<std::string> Foxglove::protocol(const std::vector<std::string>& offered) {
  for (const std::string_view known : kProtocols) {
    if (std::find(offered.begin(), offered.end(), known) != offered.end()) return std::string(known);
  }
  return std::nullopt;
}

void Foxglove::opened(Connection client) {
  json channels = json::array();
  const auto add = [&](Channel id, const char* topic, const FoxgloveSchema& schema) {
    channels.push_back({{"id", static_cast<std::uint32_t>(id)},
                        {"topic", topic},
                        {"encoding", "json"},
                        {"schemaName", schema.name},
                        {"schema", schema.json_schema},
                        {"schemaEncoding", "jsonschema"}});
  };
  add(kScene, "/scene", kSceneUpdateSchema);
  add(kTransforms, "/tf", kFrameTransformsSchema);
  add(kContacts, "/contacts", kSceneUpdateSchema);
  add(kEvents, "/events", kEventSchema);
  add(kStanding, "/fences", kSceneUpdateSchema);
  {
    const std::lock_guard lock(mutex_);
    clients_[client];
  }
  send_(
      client,
      text_message(
          {{"op", "serverInfo"}, {"name", "Collided"}, {"capabilities", json::array()}, {"metadata", json::object()}}));
  send_(client, text_message({{"op", "advertise"}, {"channels", channels}}));
}

void Foxglove::closed(Connection client) {
  const std::lock_guard lock(mutex_);
  clients_.erase(client);
}

void Foxglove::said(Connection client, std::string_view message, bool is_text) {
  if (!is_text) return send_(client, warning("this server takes no data"));
  for (const Outgoing& answer : subscribe(client, message)) send_(answer.to, answer.message);
}

std::vector<Foxglove::Outgoing> Foxglove::subscribe(Connection from, std::string_view text) {
  std::vector<Outgoing> answers;
  const auto warn = [&](const std::string& why) { answers.push_back({from, warning(why)}); };
  const json message = json::parse(text, nullptr, false);
  const auto op = message.is_object() ? message.find("op") : message.end();
  if (!message.is_object() || op == message.end()) {
    warn("this is not a message of the Foxglove WebSocket protocol");
    return answers;
  }
  const std::lock_guard lock(mutex_);
  std::vector<Subscription>& subscriptions = clients_[from].subscriptions;
  if (*op == "unsubscribe") {
    for (const json& id : list(message, "subscriptionIds")) {
      std::erase_if(subscriptions,
                    [&](const Subscription& known) { return id.is_number_unsigned() && id == known.number; });
    }
    return answers;
  }
  if (*op != "subscribe") {
    warn("this server offers subscriptions only");
    return answers;
  }
  for (const json& wish : list(message, "subscriptions")) {
    const std::optional<std::uint32_t> id = wish.is_object() ? whole_number(wish, "id") : std::nullopt;
    const std::optional<std::uint32_t> channel = wish.is_object() ? whole_number(wish, "channelId") : std::nullopt;
    const bool is_known = id && std::any_of(subscriptions.begin(), subscriptions.end(),
                                            [&](const Subscription& known) { return known.number == *id; });
    if (!id || !channel || *channel < kScene || *channel >= kChannelEnd || is_known ||
        subscriptions.size() >= kMostSubscriptions) {
      warn("a subscription without number, of an unknown channel, with a number in use, or one too many");
      continue;
    }
    const Subscription& subscription = subscriptions.emplace_back(
        Subscription{*id, static_cast<Channel>(*channel), free_lane(subscriptions, static_cast<Channel>(*channel))});
    const auto& newest = *channel == kScene ? scene_ : *channel == kStanding ? standing_ : nullptr;
    if (newest) answers.push_back({from, {make_bytes(data(*id, scene_time_ns_, *newest)), false, subscription.lane}});
  }
  return answers;
}

/// A lane of a subscription's own if a newer message makes an older one useless, which may be large; else none.
std::uint8_t Foxglove::free_lane(const std::vector<Subscription>& subscriptions, Channel channel) {
  if (channel == kContacts || channel == kEvents) return 0;
  std::uint8_t lane = 1;
  while (std::ranges::find(subscriptions, lane, &Subscription::lane) != subscriptions.end()) ++lane;
  return lane;
}

/// A binary message of the protocol: opcode 1, the subscription, nanoseconds, the message.
std::string Foxglove::data(std::uint32_t subscription, std::int64_t time_ns, std::string_view text) {
  std::string bytes(1 + sizeof(subscription) + sizeof(time_ns), '\1');
  std::memcpy(bytes.data() + 1, &subscription, sizeof(subscription));
  std::memcpy(bytes.data() + 1 + sizeof(subscription), &time_ns, sizeof(time_ns));
  bytes += text;
  return bytes;
}

void Foxglove::publish(Channel channel, std::int64_t time_ns, const std::string& text) {
  std::vector<Outgoing> outgoing;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [connection, client] : clients_) {
      for (const Subscription& subscription : client.subscriptions) {
        if (subscription.channel != channel) continue;
        outgoing.push_back(
            {connection, {make_bytes(data(subscription.number, time_ns, text)), false, subscription.lane}});
      }
    }
  }
  for (const Outgoing& one : outgoing) send_(one.to, one.message);
}

void Foxglove::objects(const std::shared_ptr<const ShownObjects>& shown) {
  {
    const std::lock_guard lock(mutex_);
    frames_.clear();
    still_.clear();
    for (const ShownObject& object : shown->objects) {
      if (object.moving) frames_.emplace(object.id, object.name);
      else still_.emplace(object.name, object.pose);
    }
    scene_.reset();
    scene_time_ns_ = shown->world_time.count();
  }
  const auto scene = std::make_shared<const std::string>(scene_update(*shown));
  {
    const std::lock_guard lock(mutex_);
    scene_ = scene;
  }
  publish(kScene, shown->world_time.count(), *scene);
}

void Foxglove::poses(const Poses& poses) {
  const std::int64_t now_ns = poses.world_time.count();
  std::map<std::uint64_t, std::string> names;
  {
    const std::lock_guard lock(mutex_);
    const bool is_wanted = std::any_of(clients_.begin(), clients_.end(), [](const auto& entry) {
      const auto& subscriptions = entry.second.subscriptions;
      return std::any_of(subscriptions.begin(), subscriptions.end(),
                         [](const Subscription& s) { return s.channel == kTransforms; });
    });
    const bool is_early = now_ns >= transforms_time_ns_ && now_ns - transforms_time_ns_ < kTransformsPeriod_ns;
    if (!is_wanted || is_early) return;
    transforms_time_ns_ = now_ns;
    names = frames_;
  }
  publish(kTransforms, now_ns, frame_transforms(poses, names));
}

void Foxglove::standing(std::span<const draw::StandingOutline> outlines) {
  std::shared_ptr<const std::string> update;
  std::int64_t time_ns = 0;
  {
    const std::lock_guard lock(mutex_);
    time_ns = scene_time_ns_;
    update = standing_ =
        std::make_shared<const std::string>(standing_update(outlines, still_, std::chrono::nanoseconds(time_ns)));
  }
  publish(kStanding, time_ns, *update);
}

void Foxglove::events(std::span<const Event> events) {
  {
    const std::lock_guard lock(mutex_);
    if (clients_.empty()) return;
  }
  const std::string contacts = contact_update(events);
  if (!contacts.empty()) publish(kContacts, events.back().world_time.count(), contacts);
  // If very many events come at once only some are sent, since they are for people to read.
  constexpr std::size_t kMostAtOnce = 50;
  for (const Event& event : events.subspan(events.size() - std::min(events.size(), kMostAtOnce))) {
    publish(kEvents, event.world_time.count(), event_json(event));
  }
}

}  // namespace collided::view
