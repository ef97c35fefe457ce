#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <deque>
#include <filesystem>
#include <mutex>
#include <fmt/format.h>

#include "server/service/commands/command_family.hpp"

namespace collided::engine::service {

using nlohmann::json;
using wire_contract::ReplyStatus;

namespace {

constexpr std::uint64_t kPageBytes = std::uint64_t{1} << 20;

std::string page_of(const std::string& path, std::uint64_t offset) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::string page(kPageBytes, '\0');
  const ssize_t count = file < 0 ? -1 : ::pread(file, page.data(), page.size(), static_cast<off_t>(offset));
  if (file >= 0) ::close(file);
  if (count < 0) throw BadCommand("recording: " + path + " cannot be read any more", "ask for a new one");
  page.resize(static_cast<std::size_t>(count));
  return page;
}

class RecordingCommands : public CommandFamily {
 public:
  using CommandFamily::CommandFamily;
  std::vector<BoundCommand> commands() override;
  void forget() override;

 private:
  static constexpr std::size_t kMostRecordings = 4;  // files kept to be fetched

  void recording_later(CommandAsk ask, const Arguments& arguments);
  json write_recording(std::int64_t last_ns);
  std::string recording_path(std::uint64_t number);

  std::mutex recordings_mutex_;
  std::deque<std::pair<std::uint64_t, std::string>> recordings_;  // number and path, oldest first
  std::atomic<std::uint64_t> recordings_made_{0};
};

}  // namespace

std::unique_ptr<CommandFamily> recording_commands(CommandContext& context) {
  return std::make_unique<RecordingCommands>(context);
}

std::vector<BoundCommand> RecordingCommands::commands() {
  return {handed_on(wire_contract::command::kRecording, this, &RecordingCommands::recording_later)};
}

/// Writes a recording on the thread for costly pairs; a page of one is read and sent at once.
void RecordingCommands::recording_later(CommandAsk ask, const Arguments& arguments) {
  if (with_.flight == nullptr)
    throw BadCommand("the server keeps no flight recorder", "start it with --flight-recorder 30s");
  if (arguments.has("number")) {
    const std::uint64_t number = arguments.whole("number");
    const std::uint64_t offset = arguments.whole("offset");
    // A recording that contained earlier ones would double in length with each request.
    answers_.answering().send_text(ask.client, ask.request, ReplyStatus::ok, page_of(recording_path(number), offset),
                                   false);
    return;
  }
  const double last_s = arguments.number("last_s");
  if (!(last_s >= 0 && last_s <= 86'400)) throw BadCommand("recording: last_s is a time from 0 to a day");
  // About as costly as a pair with this many triangles.
  constexpr double kCost = 100'000;
  const auto shared = std::make_shared<CommandAsk>(std::move(ask));
  const auto last_ns = static_cast<std::int64_t>(last_s * 1e9);
  threads_.push_costly("recording", {.client = shared->client, .cost = kCost},
                       [this, shared, last_ns] { answers_.answer(*shared, [&] { return write_recording(last_ns); }); });
}

std::string RecordingCommands::recording_path(std::uint64_t number) {
  const std::lock_guard lock(recordings_mutex_);
  for (const auto& [known, path] : recordings_) {
    if (known == number) return path;
  }
  throw BadCommand(fmt::format("recording {} is not kept; the newest {} are", number, kMostRecordings),
                   "ask for a new one");
}

/// Writes a new file and removes the oldest if more than kMostRecordings are kept.
json RecordingCommands::write_recording(std::int64_t last_ns) {
  const std::uint64_t number = ++recordings_made_;
  const FlightFile file = with_.flight->write(fmt::format("{}", number % (2 * kMostRecordings)), last_ns);
  {
    const std::lock_guard lock(recordings_mutex_);
    recordings_.emplace_back(number, file.path);
    if (recordings_.size() > kMostRecordings) {
      std::error_code gone_already;
      std::filesystem::remove(recordings_.front().second, gone_already);
      recordings_.pop_front();
    }
  }
  return {{"number", number},  {"bytes", file.bytes},     {"messages", file.messages}, {"dropped", file.dropped},
          {"path", file.path}, {"from_ns", file.from_ns}, {"to_ns", file.to_ns}};
}

/// Removes the files made for clients to fetch; those written on a signal stay.
void RecordingCommands::forget() {
  const std::lock_guard lock(recordings_mutex_);
  for (const auto& [number, path] : recordings_) {
    std::error_code gone_already;
    std::filesystem::remove(path, gone_already);
  }
  recordings_.clear();
}

}  // namespace collided::engine::service
