#include "client/library/c/publisher.hpp"

using namespace collided;
using namespace collided::c;

namespace {

collided_publish_options default_publish_options() {
  const PublishOptions defaults;
  collided_publish_options options{};
  options.lease_ns = defaults.lease.count();
  options.gap_ns = defaults.gap.count();
  return options;
}

}  // namespace

extern "C" {

int collided_publish(collided_client* client, const char* name, collided_publisher** publisher, collided_error* error) {
  return collided_publish_leased(client, name, 0, publisher, error);
}

int collided_publish_leased(collided_client* client, const char* name, int64_t lease_ns, collided_publisher** publisher,
                            collided_error* error) {
  collided_publish_options options = default_publish_options();
  options.size = sizeof options;
  if (lease_ns != 0) options.lease_ns = lease_ns;
  return collided_publish_with(client, name, &options, publisher, error);
}

void collided_publish_defaults(collided_publish_options* options, uint32_t size) {
  if (!options) return;
  options->size = size;
  give(default_publish_options(), options);
}

int collided_publish_with(collided_client* client, const char* name, const collided_publish_options* options,
                          collided_publisher** publisher, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!publisher) return missing("publisher");
    *publisher = nullptr;
    const collided_publish_options asked = taken(options, default_publish_options());
    Result<Publisher> made = client->client.publish(
        text(name), {.lease = std::chrono::nanoseconds(asked.lease_ns), .gap = std::chrono::nanoseconds(asked.gap_ns)});
    if (!made) return made.error();
    *publisher = new collided_publisher{std::move(*made)};
    return {};
  });
}

void collided_publisher_close(collided_publisher* publisher) { delete publisher; }

int collided_publisher_add(collided_publisher* publisher, const collided_object* object, uint32_t* handle,
                           collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    const Result<ObjectOptions> options = object_options(object);
    if (!options) return options.error();
    const Result<Publisher::Object> added = publisher->publisher.add(*options);
    if (!added) return added.error();
    if (handle) *handle = *added;
    return {};
  });
}

int collided_publisher_claim(collided_publisher* publisher, const char* name, const double* position,
                             const double* orientation, collided_lost_policy lost, uint32_t* handle,
                             collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    if (!position) return missing("position");
    if (lost < COLLIDED_LOST_REMOVE || lost > COLLIDED_LOST_HOLD)
      return Error{ErrorCode::bad_input, "lost policy " + std::to_string(lost) + "; allowed 0 to 2",
                   "nothing was sent"};
    const Pose pose{vector(position), rotation(orientation)};
    const Result<Publisher::Object> claimed =
        publisher->publisher.claim(text(name), pose, static_cast<LostPolicy>(lost));
    if (!claimed) return claimed.error();
    if (handle) *handle = *claimed;
    return {};
  });
}

int collided_publisher_remove(collided_publisher* publisher, uint32_t handle, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    return publisher->publisher.remove(handle);
  });
}

int collided_publisher_move(collided_publisher* publisher, size_t count, const uint32_t* handles,
                            const double* positions, const double* orientations, int32_t teleport,
                            collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    if (count > 0 && (!handles || !positions)) return missing("handles or positions");
    for (std::size_t i = 0; i < count; ++i) {
      const Pose pose{vector(positions + 3 * i), rotation(orientations ? orientations + 4 * i : nullptr)};
      if (Result<void> moved = publisher->publisher.move(handles[i], pose, teleport != 0); !moved) return moved;
    }
    return {};
  });
}

int collided_publisher_flush(collided_publisher* publisher, int64_t source_time_ns, uint64_t* sequence,
                             collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    const Result<FlushReport> sent = publisher->publisher.flush(std::chrono::nanoseconds(source_time_ns));
    if (!sent) return sent.error();
    if (sequence) *sequence = sent->sequence;
    note(sent->lost, error);
    return {};
  });
}

int collided_publisher_wait_applied(collided_publisher* publisher, int64_t timeout_ns, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    return publisher->publisher.wait_applied(std::chrono::nanoseconds(timeout_ns));
  });
}

int collided_publisher_report(collided_publisher* publisher, int64_t timeout_ns, collided_report* report,
                              collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    Result<PublisherReport> found = publisher->publisher.report(std::chrono::nanoseconds(timeout_ns));
    if (!found) return found.error();
    publisher->report = std::move(*found);
    publisher->names.clear();
    publisher->reasons.clear();
    for (const PublisherReport::MissingObject& object : publisher->report.left_out) {
      publisher->names.push_back(object.name.c_str());
      publisher->reasons.push_back(object.why.c_str());
    }
    collided_report told{};
    told.refused = publisher->report.refused.c_str();
    told.names = publisher->names.data();
    told.reasons = publisher->reasons.data();
    told.name_count = publisher->names.size();
    told.left_out_count = publisher->report.left_out_count;
    told.merged_poses = publisher->report.merged_poses;
    give(told, report);
    return {};
  });
}

int collided_publisher_keep_alive(collided_publisher* publisher, collided_error* error) {
  return collided_publisher_keep_alive_at(publisher, 0, error);
}

int collided_publisher_keep_alive_at(collided_publisher* publisher, int64_t source_time_ns, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    return publisher->publisher.keep_alive(std::chrono::nanoseconds(source_time_ns));
  });
}

void collided_publisher_stream(collided_publisher* publisher) {
  if (publisher) publisher->publisher.stream();
}

}  // extern "C"
