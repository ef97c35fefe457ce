#include "collided/snapshot.hpp"
#include "tests/cli/fakes/fake_client.hpp"

namespace collided {

struct Recording::State {};
Recording::Recording(std::unique_ptr<State> state) : state_(std::move(state)) {}
Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;
RecordingCounts Recording::counts() const { return fake::server().recording; }
Result<RecordingCounts> Recording::finish() {
  if (fake::server().recording_error) return *fake::server().recording_error;
  return fake::server().recording;
}

Client Recording::client() const { return Client::over(nullptr); }
Result<void> Recording::write(const OwnChannel& channel, std::string_view message) {
  fake::server().own_messages.emplace_back(channel.topic, message);
  return {};
}

Result<Recording> record(const ConnectOptions& options, const std::string& path) {
  fake::server().connected_with = options;
  if (fake::server().connect_error) return *fake::server().connect_error;
  fake::server().recorded_to = path;
  return Recording(std::make_unique<Recording::State>());
}

Result<std::uint64_t> fetch_recording(const ConnectOptions& options, std::chrono::nanoseconds last,
                                      const std::string& path) {
  fake::server().connected_with = options;
  fake::server().fetched = last;
  fake::server().recorded_to = path;
  return std::uint64_t{1'234'567};
}

Result<WrittenSnapshot> write_snapshot(const ConnectOptions& options, const std::string& path,
                                       const std::function<bool(double)>& progress) {
  fake::server().connected_with = options;
  if (fake::server().connect_error) return *fake::server().connect_error;
  if (progress && !progress(1)) return Error{ErrorCode::refused, "snapshot: called off", "nothing was kept"};
  fake::server().recorded_to = path;
  return WrittenSnapshot{.version = 38,
                         .world_time = std::chrono::nanoseconds(5),
                         .parts = 25,
                         .objects = 1,
                         .triangles = 300,
                         .bytes = 2'345'678,
                         .lacks = {"48 velocities"}};
}

Result<ReplayReport> replay(const ConnectOptions& connect, const ReplayOptions& options) {
  fake::Server& server = fake::server();
  server.connected_with = connect;
  server.replayed_with = options;
  if (server.replays.empty())
    return Error{ErrorCode::bad_input, options.path + ": is no MCAP file. Nothing was replayed", ""};
  const ReplayReport report = server.replays.front();
  if (server.replays.size() > 1) server.replays.pop_front();
  return report;
}

Result<RecordedPicture> recorded_picture(const std::string& path, const PictureOptions&,
                                         const std::function<void(const PictureChange&)>&) {
  return Error{ErrorCode::bad_input, path + ": is no MCAP file. Nothing is shown", ""};
}

std::vector<Finding> diagnose(const ConnectOptions& options) {
  fake::server().connected_with = options;
  return fake::server().findings;
}

Result<Fleet> fleet(const ConnectOptions& options) {
  fake::Server& server = fake::server();
  server.connected_with = options;
  if (server.members.empty()) return Error{ErrorCode::no_server, "no collided heard in 1.5 s", ""};
  return Fleet{.members = server.members, .findings = fleet_findings(server.members)};
}

}  // namespace collided
