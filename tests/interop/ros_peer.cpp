// A program of another vendor's DDS that speaks as ROS 2's rmw_fastrtps does, by ros.idl alone:
//   ros_peer DOMAIN chain FRAMES HZ MESSAGES   a static frame, then a chain of frames that turn, all in each message
//   ros_peer DOMAIN into MESSAGES              one frame that goes to and fro along x, 1 m at 5 cm a message
//   ros_peer DOMAIN odd                        transforms that cannot be meant, then a good one
//   ros_peer DOMAIN joints                     a robot's description and one state of its joints
//   ros_peer DOMAIN pose                       a PoseStamped in a frame that stands still, best effort
//   ros_peer DOMAIN contacts                   waits for contacts as markers and prints their points
// Each says "ready" once it has a reader, sends at SIGUSR1, since what comes before the reader has met the writer is lost, says
// what it has sent, and stays until SIGTERM.

#include <signal.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "rosPubSubTypes.h"
#include "tests/interop/fastdds_link.hpp"

namespace collided::interop {
namespace {

using tf2_msgs::msg::dds_::TFMessage_;
using tf2_msgs::msg::dds_::TFMessage_PubSubType;
using Transform = geometry_msgs::msg::dds_::TransformStamped_;
using visualization_msgs::msg::dds_::MarkerArray_;
using visualization_msgs::msg::dds_::MarkerArray_PubSubType;

constexpr double kStepOfTurn = 0.001;  // rad a message, of each frame of the chain

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

builtin_interfaces::msg::dds_::Time_ stamp_of(std::int64_t time_ns) {
  builtin_interfaces::msg::dds_::Time_ stamp;
  stamp.sec(static_cast<std::int32_t>(time_ns / 1'000'000'000));
  stamp.nanosec(static_cast<std::uint32_t>(time_ns % 1'000'000'000));
  return stamp;
}

Transform transform(const std::string& parent, const std::string& child, std::int64_t time_ns, double x,
                    double turn = 0) {
  Transform made;
  made.header().stamp(stamp_of(time_ns));
  made.header().frame_id(parent);
  made.child_frame_id(child);
  made.transform().translation().x(x);
  made.transform().rotation().w(std::cos(turn / 2));
  made.transform().rotation().z(std::sin(turn / 2));
  return made;
}

void send(fast::DataWriter* writer, const std::vector<Transform>& transforms) {
  TFMessage_ message;
  message.transforms(transforms);
  if (!writer->write(&message)) throw std::runtime_error("nobody takes transforms");
}

sigset_t both_signals() {
  sigset_t both;
  sigemptyset(&both);
  sigaddset(&both, SIGTERM);
  sigaddset(&both, SIGUSR1);
  return both;
}

/// Waits for one of the signals; SIGTERM ends what is under way.
void wait_for_signal() {
  std::fflush(stdout);
  const sigset_t both = both_signals();
  int signal = 0;
  sigwait(&both, &signal);
  if (signal == SIGTERM) throw std::runtime_error("ended");
}

void wait_for_go(fast::DataWriter* writer, const std::string& what) {
  wait_for_match(writer, what);
  std::printf("ready\n");
  wait_for_signal();
}

void stay() { wait_for_signal(); }

const TopicSettings kTf{.suffix = "tf", .prefix = "rt/"};
const TopicSettings kTfStatic{.suffix = "tf_static", .is_durable = true, .prefix = "rt/"};

/// Each message has every frame at one instant: frame i stands 0.25 m along x in frame i - 1 and turns.
void chain(int domain, int frames, int rate_hz, int messages) {
  Link link(domain);
  fast::DataWriter* fixed = link.writer<TFMessage_PubSubType>(kTfStatic);
  send(fixed, {transform("world", "f0", 0, 1)});
  fast::DataWriter* tf = link.writer<TFMessage_PubSubType>(kTf);
  wait_for_go(tf, "/tf");
  auto due = std::chrono::steady_clock::now();
  for (int message = 1; message <= messages; ++message) {
    std::vector<Transform> transforms;
    const std::int64_t time_ns = now_ns();
    for (int frame = 1; frame <= frames; ++frame)
      transforms.push_back(transform("f" + std::to_string(frame - 1), "f" + std::to_string(frame), time_ns, 0.25,
                                     kStepOfTurn * message));
    send(tf, transforms);
    due += std::chrono::microseconds(1'000'000 / rate_hz);
    std::this_thread::sleep_until(due);
  }
  std::printf("sent %d messages\n", messages);
  stay();
}

void into(int domain, int messages) {
  Link link(domain);
  fast::DataWriter* tf = link.writer<TFMessage_PubSubType>(kTf);
  wait_for_go(tf, "/tf");
  for (int message = 1; message <= messages; ++message) {
    send(tf, {transform("world", "cart", now_ns(), 0.05 * message)});
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf("sent %d messages\n", messages);
  stay();
}

void odd(int domain) {
  Link link(domain);
  fast::DataWriter* tf = link.writer<TFMessage_PubSubType>(kTf);
  wait_for_go(tf, "/tf");
  const std::int64_t time_ns = now_ns();
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  Transform none = transform("world", "a", time_ns, 0);
  none.transform().rotation().w(0.5);
  send(tf, {transform("", "a", time_ns, 0), transform("a", "a", time_ns, 0), none,
            transform("world", "a", time_ns, std::numeric_limits<double>::quiet_NaN()),
            transform("world", "b", time_ns, 0), transform("b", "c", time_ns, 0), transform("c", "b", time_ns, 0),
            transform("world", "d", time_ns, 0), transform("world", "d", time_ns - 20 * kSecondNs, 0),
            transform("world", "e", 0, 1), transform("world", "g", time_ns + 3'600 * kSecondNs, 2)});
  send(tf, {transform("world", "good", time_ns, 3)});
  std::printf("sent 2 messages\n");
  stay();
}

void joints(int domain) {
  using sensor_msgs::msg::dds_::JointState_;
  using sensor_msgs::msg::dds_::JointState_PubSubType;
  using std_msgs::msg::dds_::String_;
  using std_msgs::msg::dds_::String_PubSubType;
  Link link(domain);
  fast::DataWriter* robots =
      link.writer<String_PubSubType>({.suffix = "robot_description", .is_durable = true, .prefix = "rt/"});
  String_ robot;
  robot.data(
      "<robot name='arm'><link name='base'/><link name='hand'/><joint name='slide' type='prismatic'>"
      "<parent link='base'/><child link='hand'/><axis xyz='0 0 1'/><limit lower='0' upper='1'/></joint></robot>");
  robots->write(&robot);
  fast::DataWriter* fixed = link.writer<TFMessage_PubSubType>(kTfStatic);
  send(fixed, {transform("world", "base", 0, 2)});
  fast::DataWriter* states = link.writer<JointState_PubSubType>({.suffix = "joint_states", .prefix = "rt/"});
  wait_for_go(states, "/joint_states");
  for (int i = 0; i < 200; ++i) {
    JointState_ state;
    state.header().stamp(stamp_of(now_ns()));
    state.name({"slide"});
    state.position({0.5});
    states->write(&state);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf("sent 200 messages\n");
  stay();
}

void pose(int domain) {
  using geometry_msgs::msg::dds_::PoseStamped_;
  using geometry_msgs::msg::dds_::PoseStamped_PubSubType;
  Link link(domain);
  fast::DataWriter* fixed = link.writer<TFMessage_PubSubType>(kTfStatic);
  send(fixed, {transform("world", "camera", 0, 1)});
  fast::DataWriter* poses = link.writer<PoseStamped_PubSubType>({.suffix = "tracker/pose", .prefix = "rt/"});
  wait_for_go(poses, "/tracker/pose");
  for (int i = 1; i <= 100; ++i) {
    PoseStamped_ message;
    message.header().stamp(stamp_of(now_ns()));
    message.header().frame_id("camera");
    message.pose().position().z(0.01 * i);
    message.pose().orientation().w(1);
    poses->write(&message);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf("sent 100 messages\n");
  stay();
}

void contacts(int domain) {
  Link link(domain);
  fast::DataReader* reader = link.reader<MarkerArray_PubSubType>({.suffix = "collided/contacts", .prefix = "rt/"});
  wait_for_match(reader, "/collided/contacts");
  std::printf("ready\n");
  std::fflush(stdout);
  wait_until(
      [&] {
        MarkerArray_ array;
        fast::SampleInfo info;
        if (reader->take_next_sample(&array, &info) != ReturnCode_t::RETCODE_OK || !info.valid_data) return false;
        for (const auto& marker : array.markers()) {
          std::printf("marker %s %d type %d action %d frame %s points %zu", marker.ns().c_str(), marker.marker_id(),
                      marker.type(), marker.action(), marker.header().frame_id().c_str(), marker.points().size());
          for (const auto& point : marker.points()) std::printf(" (%.9g %.9g %.9g)", point.x(), point.y(), point.z());
          std::printf("\n");
        }
        std::fflush(stdout);
        return !array.markers().empty() && !array.markers().front().points().empty();
      },
      "contacts");
  stay();
}

int run(const std::vector<std::string>& words) {
  const sigset_t both = both_signals();
  pthread_sigmask(SIG_BLOCK, &both, nullptr);  // before there are threads that would take it
  const int domain = std::stoi(words.at(0));
  const std::string& what = words.at(1);
  if (what == "chain") chain(domain, std::stoi(words.at(2)), std::stoi(words.at(3)), std::stoi(words.at(4)));
  else if (what == "into") into(domain, std::stoi(words.at(2)));
  else if (what == "odd") odd(domain);
  else if (what == "joints") joints(domain);
  else if (what == "pose") pose(domain);
  else if (what == "contacts") contacts(domain);
  else throw std::runtime_error("unknown: " + what);
  return 0;
}

}  // namespace
}  // namespace collided::interop

int main(int count, char** words) {
  try {
    return collided::interop::run({words + 1, words + count});
  } catch (const std::exception& failed) {
    std::fprintf(stderr, "ros_peer: %s\n", failed.what());
    return 2;
  }
}
