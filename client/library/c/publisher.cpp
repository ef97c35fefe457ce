#include "client/library/c/publisher.hpp"

using namespace collided;
using namespace collided::c;

extern "C" {

int collided_publish(collided_client* client, const char* name, collided_publisher** publisher, collided_error* error) {
  return collided_publish_leased(client, name, 0, publisher, error);
}

int collided_publish_leased(collided_client* client, const char* name, int64_t lease_ns, collided_publisher** publisher,
                            collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!publisher) return missing("publisher");
    *publisher = nullptr;
    PublishOptions options;
    if (lease_ns != 0) options.lease = std::chrono::nanoseconds(lease_ns);
    Result<Publisher> made = client->client.publish(text(name), options);
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
                             const double* orientation, int32_t lost, uint32_t* handle, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    if (!position) return missing("position");
    if (lost < 0 || lost > 2)
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
    const Result<std::uint64_t> sent = publisher->publisher.flush(std::chrono::nanoseconds(source_time_ns));
    if (!sent) return sent.error();
    if (sequence) *sequence = *sent;
    return {};
  });
}

int collided_publisher_wait_applied(collided_publisher* publisher, int64_t timeout_ns, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    return publisher->publisher.wait_applied(std::chrono::nanoseconds(timeout_ns));
  });
}

int collided_publisher_keep_alive(collided_publisher* publisher, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    return publisher->publisher.keep_alive();
  });
}

void collided_publisher_stream(collided_publisher* publisher) {
  if (publisher) publisher->publisher.stream();
}

}  // extern "C"
