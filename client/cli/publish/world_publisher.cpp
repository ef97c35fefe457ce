#include "client/cli/publish/world_publisher.hpp"

#include <utility>

#include "client/cli/failure.hpp"
#include "client/cli/shards_away.hpp"

namespace collided::cli {
namespace {

std::variant<Publisher, ShardedPublisher> begin_publishing(Session& session, const Globals& globals,
                                                           const std::string& name, const PublishOptions& options) {
  if (globals.shards.empty()) return take(session.client(globals).publish(name, options));
  ShardedPublisher publisher = take(session.sharded(globals).publish(name, options));
  warn_of_shards_away(session, globals, "it gets its objects when it is there");
  return publisher;
}

}  // namespace

WorldPublisher::WorldPublisher(Session& session, const Globals& globals, const std::string& publisher_name,
                               const PublishOptions& options)
    : publisher_(begin_publishing(session, globals, publisher_name, options)) {}

Result<WorldPublisher::Object> WorldPublisher::add(const ObjectOptions& options) {
  return std::visit([&](auto& publisher) { return publisher.add(options); }, publisher_);
}

Result<void> WorldPublisher::move(Object object, const Pose& pose, bool teleport) {
  return std::visit([&](auto& publisher) { return publisher.move(object, pose, teleport); }, publisher_);
}

Result<FlushReport> WorldPublisher::flush(std::chrono::nanoseconds source_time) {
  return std::visit([&](auto& publisher) { return publisher.flush(source_time); }, publisher_);
}

void WorldPublisher::stream() {
  if (std::holds_alternative<ShardedPublisher>(publisher_))
    throw bad_use("a frame leaves objects out, so --shards is not for it: each frame says where all of them are",
                  "give every object a row at every time");
  std::get<Publisher>(publisher_).stream();
}

Result<void> WorldPublisher::keep_alive(std::chrono::nanoseconds source_time) {
  return std::visit([&](auto& publisher) { return publisher.keep_alive(source_time); }, publisher_);
}

Result<void> WorldPublisher::wait_applied(std::chrono::nanoseconds timeout) {
  return std::visit([&](auto& publisher) { return publisher.wait_applied(timeout); }, publisher_);
}

Result<void> WorldPublisher::wait_entered(std::chrono::nanoseconds timeout) {
  // With shards, objects enter with an instant.
  if (auto* const sharded = std::get_if<ShardedPublisher>(&publisher_)) {
    if (const Result<FlushReport> sent = sharded->flush(); !sent) return sent.error();
  }
  return wait_applied(timeout);
}

Result<PublisherReport> WorldPublisher::report(std::chrono::nanoseconds timeout) {
  return std::visit([&](auto& publisher) { return publisher.report(timeout); }, publisher_);
}

}  // namespace collided::cli
