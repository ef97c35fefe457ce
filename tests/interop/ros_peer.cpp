// A program of another vendor's DDS that speaks as ROS 2's rmw_fastrtps does, by ros.idl alone:
//   ros_peer DOMAIN chain FRAMES HZ MESSAGES   a static frame, then a chain of frames that turn, all in each message
//   ros_peer DOMAIN into MESSAGES              one frame that goes to and fro along x, 1 m at 5 cm a message
//   ros_peer DOMAIN odd                        transforms that cannot be meant, then a good one
//   ros_peer DOMAIN joints                     a robot's description and one state of its joints
//   ros_peer DOMAIN pose                       a PoseStamped in a frame that stands still, best effort
//   ros_peer DOMAIN big_cloud COUNT            a cloud of so many points, twice a second
//   ros_peer DOMAIN clouds                     clouds of points of several layouts, and some that cannot be meant
//   ros_peer DOMAIN octomap                    a map of an occupied, a free and an unknown cell
//   ros_peer DOMAIN markers                    markers that are things, and some that are not
//   ros_peer DOMAIN clock                      /clock, and a frame stamped by it
//   ros_peer DOMAIN outputs                    prints what comes of clearance, diagnostics, contacts, objects and /tf
//   ros_peer DOMAIN raw                        the same and contacts as markers, as the bytes that came: "raw TYPE HEX"
//   ros_peer DOMAIN contacts                   waits for contacts as markers and prints their points
// Each says "ready" once it has a reader, sends at SIGUSR1, since what comes before the reader has met the writer is lost, says
// what it has sent, and stays until SIGTERM.

#include <signal.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "rosPubSubTypes.h"
#include "tests/interop/big_cloud.hpp"
#include "tests/interop/fastdds_link.hpp"

namespace collided::interop {
namespace {

using diagnostic_msgs::msg::dds_::DiagnosticArray_;
using diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType;
using ros_gz_interfaces::msg::dds_::Contacts_;
using ros_gz_interfaces::msg::dds_::Contacts_PubSubType;
using std_msgs::msg::dds_::Float64_;
using std_msgs::msg::dds_::Float64_PubSubType;
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

using sensor_msgs::msg::dds_::PointCloud2_;
using sensor_msgs::msg::dds_::PointCloud2_PubSubType;
using visualization_msgs::msg::dds_::Marker_;

/// A cloud of numbers of one type, x y z at offset 4 of each point.
template <class Number>
PointCloud2_ cloud(const std::string& frame, std::int64_t time_ns, std::uint8_t datatype,
                   const std::vector<std::array<Number, 3>>& points, bool is_bigendian) {
  PointCloud2_ message;
  message.header().frame_id(frame);
  message.header().stamp(stamp_of(time_ns));
  message.height(1);
  message.width(static_cast<std::uint32_t>(points.size()));
  message.is_bigendian(is_bigendian);
  constexpr std::uint32_t kStep = 4 + 3 * sizeof(Number) + 2;
  message.point_step(kStep);
  message.row_step(kStep * message.width());
  const char* names[] = {"intensity", "x", "y", "z"};
  for (std::uint32_t i = 0; i < 4; ++i) {
    sensor_msgs::msg::dds_::PointField_ field;
    field.name(names[i]);
    field.offset(i == 0 ? 0 : 4 + (i - 1) * static_cast<std::uint32_t>(sizeof(Number)));
    field.datatype(i == 0 ? 7 : datatype);
    field.count(1);
    message.fields().push_back(field);
  }
  for (const auto& point : points) {
    std::vector<std::uint8_t> bytes(kStep, 0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<std::uint8_t, sizeof(Number)> own;
      std::memcpy(own.data(), &point[axis], sizeof(Number));
      if (is_bigendian) std::reverse(own.begin(), own.end());
      std::copy(own.begin(), own.end(), bytes.begin() + 4 + static_cast<std::ptrdiff_t>(axis * sizeof(Number)));
    }
    message.data().insert(message.data().end(), bytes.begin(), bytes.end());
  }
  return message;
}

void clouds(int domain) {
  Link link(domain);
  fast::DataWriter* fixed = link.writer<TFMessage_PubSubType>(kTfStatic);
  send(fixed, {transform("world", "lidar", 0, 10)});
  fast::DataWriter* writer = link.writer<PointCloud2_PubSubType>({.suffix = "points", .prefix = "rt/"});
  wait_for_go(writer, "/points");
  const std::int64_t time_ns = now_ns();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<PointCloud2_> messages;
  messages.push_back(cloud<float>("lidar", time_ns, 7, {{2.25F, 0.25F, 0.25F}, {nan, 0, 0}}, false));
  messages.push_back(cloud<std::int16_t>("lidar", time_ns, 3, {{0, 4, 0}}, true));
  messages.push_back(cloud<double>("world", 0, 8, {{10.25, -3.75, 0.25}}, false));
  messages.push_back(cloud<float>("lidar", time_ns + 3'600'000'000'000, 7, {{0.25F, 0.25F, 5.25F}}, false));
  messages.push_back(cloud<float>("", time_ns, 7, {{0, 0, 0}}, false));
  messages.push_back(cloud<float>("nowhere", time_ns, 7, {{0, 0, 0}}, false));
  messages.push_back(cloud<float>("lidar", time_ns, 9, {{0, 0, 0}}, false));  // a datatype that there is not
  messages.push_back(cloud<float>("lidar", time_ns, 7, {{0, 0, 0}}, false));
  messages.back().data().resize(3);  // less than the points take
  messages.push_back(cloud<float>("lidar", time_ns, 7, {{0, 0, 0}}, false));
  messages.back().fields().pop_back();  // no z
  for (PointCloud2_& message : messages) {
    writer->write(&message);
    // The reader is that of sensors, at best effort with a short queue.
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  std::printf("sent %zu messages\n", messages.size());
  stay();
}

/// A large cloud, again and again until it is told to stop: readers of sensors take what comes, and ask for nothing again.
void big_cloud(int domain, int count) {
  Link link(domain);
  fast::DataWriter* writer = link.writer<PointCloud2_PubSubType>({.suffix = "points", .prefix = "rt/"});
  std::vector<std::array<float, 3>> points;
  for (int i = 0; i < count; ++i) points.push_back(big_cloud_point(i));
  wait_for_go(writer, "/points");
  std::atomic<bool> is_over = false;
  std::thread sending([&] {
    while (!is_over) {
      PointCloud2_ message = cloud<float>("world", now_ns(), 7, points, false);
      writer->write(&message);
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
    }
  });
  std::printf("sent %d points\n", count);
  stay();
  is_over = true;
  sending.join();
}

void octomap(int domain) {
  using octomap_msgs::msg::dds_::Octomap_;
  using octomap_msgs::msg::dds_::Octomap_PubSubType;
  Link link(domain);
  fast::DataWriter* writer = link.writer<Octomap_PubSubType>({.suffix = "map", .prefix = "rt/"});
  wait_for_go(writer, "/map");
  Octomap_ message;
  message.header().frame_id("world");
  message.header().stamp(stamp_of(now_ns()));
  message.binary(true);
  message.kind("OcTree");
  message.resolution(0.5);
  // Child 7 is that above the origin along each axis. Down to the last level it is child 0; there 0 is occupied, 1 free.
  message.data({0x00, 0xc0});
  for (int level = 2; level <= 15; ++level) message.data().insert(message.data().end(), {0x03, 0x00});
  message.data().insert(message.data().end(), {0x06, 0x00});
  writer->write(&message);
  message.kind("ColorOcTree");
  writer->write(&message);
  message.kind("OcTree");
  message.data().pop_back();
  writer->write(&message);
  std::printf("sent 3 messages\n");
  stay();
}

Marker_ marker(const std::string& frame, std::int64_t time_ns, std::int32_t number, std::int32_t type, double x) {
  Marker_ made;
  made.header().frame_id(frame);
  made.header().stamp(stamp_of(time_ns));
  made.ns("things");
  made.marker_id(number);
  made.type(type);
  made.pose().position().x(x);
  made.pose().orientation().w(1);
  made.scale().x(0.5);
  made.scale().y(0.5);
  made.scale().z(0.5);
  return made;
}

void markers(int domain) {
  Link link(domain);
  fast::DataWriter* fixed = link.writer<TFMessage_PubSubType>(kTfStatic);
  send(fixed, {transform("world", "table", 0, 10)});
  fast::DataWriter* writer = link.writer<MarkerArray_PubSubType>({.suffix = "things", .prefix = "rt/"});
  wait_for_go(writer, "/things");
  const std::int64_t time_ns = now_ns();
  MarkerArray_ array;
  array.markers({marker("table", time_ns, 1, 1, 0), marker("table", 0, 2, 2, 2), marker("world", time_ns, 3, 3, 20),
                 marker("table", time_ns + 3'600'000'000'000, 4, 1, 30), marker("table", time_ns, 5, 99, 0),
                 marker("table", time_ns, 6, 9, 0), marker("", time_ns, 7, 1, 0), marker("nowhere", time_ns, 8, 1, 0),
                 marker("table", time_ns, 9, 1, std::numeric_limits<double>::infinity()),
                 marker("table", time_ns, 10, 1, 40)});
  writer->write(&array);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  Marker_ gone = marker("table", time_ns, 10, 1, 40);
  gone.action(2);
  array.markers({gone, marker("table", now_ns(), 1, 1, 1)});
  writer->write(&array);
  std::printf("sent 2 messages\n");
  stay();
}

void simulated(int domain) {
  using rosgraph_msgs::msg::dds_::Clock_;
  using rosgraph_msgs::msg::dds_::Clock_PubSubType;
  Link link(domain);
  fast::DataWriter* clock = link.writer<Clock_PubSubType>({.suffix = "clock", .prefix = "rt/"});
  fast::DataWriter* tf = link.writer<TFMessage_PubSubType>(kTf);
  wait_for_match(clock, "/clock");
  wait_for_go(tf, "/tf");
  for (int i = 1; i <= 100; ++i) {
    const std::int64_t time_ns = 5'000'000'000 + i * 10'000'000LL;
    Clock_ message;
    message.clock(stamp_of(time_ns));
    clock->write(&message);
    send(tf, {transform("world", "cart", time_ns, 0.01 * i)});
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf("sent 100 messages\n");
  stay();
}

/// Takes one message, where there is one, and hands it to `print`.
template <class Message, class Print>
void print_next(fast::DataReader* reader, const Print& print) {
  Message message;
  fast::SampleInfo info;
  if (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK && info.valid_data) print(message);
  std::fflush(stdout);
}

void outputs(int domain) {
  Link link(domain);
  fast::DataReader* clearance = link.reader<Float64_PubSubType>({.suffix = "collided/clearance", .prefix = "rt/"});
  fast::DataReader* diagnostics = link.reader<DiagnosticArray_PubSubType>({.suffix = "diagnostics", .prefix = "rt/"});
  fast::DataReader* states = link.reader<Contacts_PubSubType>({.suffix = "collided/contact_states", .prefix = "rt/"});
  fast::DataReader* objects = link.reader<MarkerArray_PubSubType>({.suffix = "collided/objects", .prefix = "rt/"});
  fast::DataReader* tf = link.reader<TFMessage_PubSubType>({.suffix = "tf", .prefix = "rt/"});
  wait_for_match(clearance, "/collided/clearance");
  std::printf("ready\n");
  std::fflush(stdout);
  for (int i = 0; i < 1'000; ++i) {
    print_next<Float64_>(clearance, [](const Float64_& m) { std::printf("clearance %.9g\n", m.data()); });
    print_next<DiagnosticArray_>(diagnostics, [](const DiagnosticArray_& m) {
      for (const auto& one : m.status())
        std::printf("diagnostic %d %s: %s\n", one.level(), one.name().c_str(), one.message().c_str());
    });
    print_next<Contacts_>(states, [](const Contacts_& m) {
      for (const auto& one : m.contacts())
        std::printf("contact %s %s depth %.9g\n", one.collision1().name().c_str(), one.collision2().name().c_str(),
                    one.depths().at(0));
    });
    print_next<MarkerArray_>(objects, [](const MarkerArray_& m) {
      for (const auto& one : m.markers())
        std::printf("object %s type %d at %.9g\n", one.ns().c_str(), one.type(), one.pose().position().x());
    });
    print_next<TFMessage_>(tf, [](const TFMessage_& m) {
      for (const auto& one : m.transforms())
        std::printf("transform %s to %s at %.9g\n", one.header().frame_id().c_str(), one.child_frame_id().c_str(),
                    one.transform().translation().x());
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  stay();
}

std::vector<std::uint8_t> newest_payload;  // of the thread that takes

/// Keeps the bytes of what is read.
template <class Type>
class RawType : public Type {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  bool deserialize(Payload* payload, void* data) override {
    newest_payload.assign(payload->data, payload->data + payload->length);
    return Type::deserialize(payload, data);
  }
};

template <class Message>
void print_raw(fast::DataReader* reader, const char* type) {
  print_next<Message>(reader, [type](const Message&) {
    std::printf("raw %s ", type);
    for (const std::uint8_t byte : newest_payload) std::printf("%02x", byte);
    std::printf("\n");
  });
}

void raw(int domain) {
  Link link(domain);
  const auto at = [](const char* suffix) { return TopicSettings{.suffix = suffix, .prefix = "rt/"}; };
  fast::DataReader* clearance = link.reader<RawType<Float64_PubSubType>>(at("collided/clearance"));
  fast::DataReader* diagnostics = link.reader<RawType<DiagnosticArray_PubSubType>>(at("diagnostics"));
  fast::DataReader* states = link.reader<RawType<Contacts_PubSubType>>(at("collided/contact_states"));
  fast::DataReader* contacts = link.reader<RawType<MarkerArray_PubSubType>>(at("collided/contacts"));
  fast::DataReader* objects = link.reader<RawType<MarkerArray_PubSubType>>(at("collided/objects"));
  fast::DataReader* tf = link.reader<RawType<TFMessage_PubSubType>>(at("tf"));
  wait_for_match(clearance, "/collided/clearance");
  std::printf("ready\n");
  std::fflush(stdout);
  for (int i = 0; i < 3'000; ++i) {
    print_raw<Float64_>(clearance, "std_msgs/Float64");
    print_raw<DiagnosticArray_>(diagnostics, "diagnostic_msgs/DiagnosticArray");
    print_raw<Contacts_>(states, "ros_gz_interfaces/Contacts");
    for (fast::DataReader* markers : {contacts, objects})
      print_raw<MarkerArray_>(markers, "visualization_msgs/MarkerArray");
    print_raw<TFMessage_>(tf, "tf2_msgs/TFMessage");
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
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
  else if (what == "clouds") clouds(domain);
  else if (what == "big_cloud") big_cloud(domain, std::stoi(words.at(2)));
  else if (what == "octomap") octomap(domain);
  else if (what == "markers") markers(domain);
  else if (what == "clock") simulated(domain);
  else if (what == "outputs") outputs(domain);
  else if (what == "raw") raw(domain);
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
