#include <utility>
#include <vector>

#include "client/library/c/options.hpp"

using namespace collided;
using namespace collided::c;

struct collided_robot {
  Publisher* publisher;
  PublishedRobot robot;
};

extern "C" {

int collided_publish(collided_client* client, const char* name, const char* options, collided_publisher** publisher,
                     collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!publisher) return missing("publisher");
    *publisher = nullptr;
    const Result<PublishOptions> asked = options_of<PublishOptions>(options, "publish");
    if (!asked) return asked.error();
    Result<Publisher> made = client->client.publish(text(name), *asked);
    if (!made) return made.error();
    *publisher = new collided_publisher{std::move(*made)};
    return {};
  });
}

void collided_publisher_close(collided_publisher* publisher) { delete publisher; }

int collided_publisher_add(collided_publisher* publisher, const char* object, const collided_part* parts,
                           size_t part_count, uint32_t* handle, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    Result<PublishedObject> made = options_of<PublishedObject>(object, "add");
    if (!made) return made.error();
    Result<Shape> shape = shape_of(parts, part_count);
    if (!shape) return shape.error();
    if (made->claim && !shape->empty())
      return Error{ErrorCode::bad_input, "claim: object '" + made->name + "' keeps its shape, but parts were given",
                   "nothing was sent"};
    made->shape = std::move(*shape);
    const Result<Publisher::Object> added = made->claim
                                                ? publisher->publisher.claim(made->name, made->pose, made->lost_policy)
                                                : publisher->publisher.add(*made);
    if (!added) return added.error();
    if (handle) *handle = *added;
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

int collided_publisher_report(collided_publisher* publisher, int64_t timeout_ns, char** report, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    if (report) *report = nullptr;
    const Result<PublisherReport> found = publisher->publisher.report(std::chrono::nanoseconds(timeout_ns));
    if (!found) return found.error();
    return hand_out_json(*found, report);
  });
}

int collided_publisher_keep_alive(collided_publisher* publisher, int64_t source_time_ns, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    return publisher->publisher.keep_alive(std::chrono::nanoseconds(source_time_ns));
  });
}

void collided_publisher_stream(collided_publisher* publisher) {
  if (publisher) publisher->publisher.stream();
}

// ---- robots ----------------------------------------------------------------------------------------------------------

int collided_robot_claim(collided_client* client, collided_publisher* publisher, const char* options,
                         collided_robot** robot, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!publisher) return missing("publisher");
    if (!robot) return missing("robot");
    *robot = nullptr;
    const Result<ClaimedRobot> asked = options_of<ClaimedRobot>(options, "robot");
    if (!asked) return asked.error();
    Result<Robot> read = Robot::read(asked->urdf);
    if (!read) return read.error();
    Result<PublishedRobot> made = PublishedRobot::claim(client->client, publisher->publisher, std::move(*read), *asked);
    if (!made) return made.error();
    *robot = new collided_robot{&publisher->publisher, std::move(*made)};
    return {};
  });
}

int collided_robot_set(collided_robot* robot, const char* motion, char** warnings, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!robot) return missing("robot");
    if (warnings) *warnings = nullptr;
    const Result<RobotMotion> asked = options_of<RobotMotion>(motion, "robot");
    if (!asked) return asked.error();
    const auto set = robot->robot.set_joints(*robot->publisher, asked->joints, asked->teleport);
    if (!set) return set.error();
    if (asked->base) {
      if (Result<void> moved = robot->robot.set_base(*robot->publisher, *asked->base); !moved) return moved;
    }
    return hand_out_json(*set, warnings);
  });
}

void collided_robot_close(collided_robot* robot) { delete robot; }

}  // extern "C"
