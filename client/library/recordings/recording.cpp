#include "client/library/recordings/recording.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "client/library/commands/fetching.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/connection/wait_until.hpp"
#include "idl/clocks.hpp"
#include "idl/commands.hpp"
#include "idl/mcap/reader.hpp"

namespace collided {

using client::Clock;
using client::RecordingQueue;
using recording::Recorded;

namespace {

/// Time between chunks. If the process is killed, the samples since the last chunk are missing.
constexpr std::chrono::seconds kChunkPeriod{1};

/// The topic of questions with a best-effort reader, on which no writer waits.
constexpr wire_contract::TopicQos kOverheardQuestions{wire_contract::kQueryTopic.suffix,
                                                      wire_contract::Reliability::best_effort,
                                                      wire_contract::Durability::volatile_data,
                                                      0,
                                                      0,
                                                      false};
/// Matches every client's partition.
constexpr const char* kAllClients = "client_*";
/// With keys, each right to send queries is a partition.
constexpr const char* kAllRights = "*";

}  // namespace

struct Recording::State::Readers {
  dds::Reader<wire::Definition> object;
  dds::Reader<wire::PoseBatch> pose;
  dds::Reader<wire::Query> query;
  dds::Reader<wire::Reply> reply;
  dds::Reader<wire::EventFrame> event;
  dds::Reader<wire::ContactShard> contact;
  dds::Reader<wire::ProbeFrame> probe;
  dds::Reader<wire::Status> status, step;
  dds::Reader<wire::StandingFrame> standing_event;
  dds::Reader<wire::StandingShard> standing_state;
};

template <class T>
dds::ReaderOptions<T> Recording::State::into(Recorded topic, std::string partition) {
  return {.data =
              [this, topic](dds::Taker<T> taker) {
                while (true) {
                  const auto loans = taker.take_loans();
                  if (loans.size() == 0) return;
                  const auto now = static_cast<std::uint64_t>(wire_contract::since_1970_ns());
                  const std::lock_guard lock(mutex_);
                  for (std::size_t i = 0; i < loans.size(); ++i) {
                    if (!loans.info(i).valid_data) continue;
                    if constexpr (requires {
                                    { hear(loans[i]) } -> std::same_as<bool>;
                                  }) {
                      if (!hear(loans[i])) continue;
                    } else if constexpr (requires { hear(loans[i]); }) {
                      hear(loans[i]);
                    }
                    ++given_[static_cast<std::size_t>(topic) - 1];
                    queue_.put(topic, loans[i], now, static_cast<std::uint64_t>(loans.info(i).source_timestamp));
                  }
                }
              },
          .partition = std::move(partition)};
}

void Recording::State::hear(const wire::Definition& sample) {
  loss_.hear_definition(sample.publisher, sample.incarnation, sample.sequence_number);
}
void Recording::State::hear(const wire::PoseBatch& sample) {
  if (sample.sequence_number > 0) loss_.hear_poses(sample.publisher, sample.incarnation, sample.sequence_number);
}
void Recording::State::hear(const wire::EventFrame& sample) {
  loss_.hear_events(sample.server, sample.epoch, sample.first_sequence, sample.kinds._length);
}
void Recording::State::hear(const wire::StandingFrame& sample) {
  standing_loss_.hear_events(sample.server, sample.epoch, sample.first_sequence, sample.kinds._length);
  ++written_.standing_changes;
}
/// The sum comes 20 times a second even without changes. It is not recorded before the first event.
bool Recording::State::hear(const wire::StandingShard& sample) {
  if (sample.as_of_sequence == 0) return false;
  if (sample.shard != wire_contract::kStandingSum) ++written_.standing_changes;
  return true;
}
/// A restarted server restores its kept standing questions.
void Recording::State::hear(const wire::Status& sample) {
  if (std::exchange(epoch_, sample.epoch) != sample.epoch) ++written_.standing_changes;
}
/// The requests of the recording's own connection are not recorded.
bool Recording::State::hear(const wire::Query& sample) {
  if (sample.client == connection_->client()) return false;
  loss_.hear_question(sample.client, sample.request, Clock::now());
  note_standing_command(sample);
  return true;
}
bool Recording::State::hear(const wire::Reply& sample) {
  if (sample.client == connection_->client()) return false;
  // A client has disconnected with its standing questions; this reply has no request.
  if (sample.request == 0) return ++written_.standing_changes, true;
  loss_.hear_reply(sample.client, sample.request, Clock::now());
  if (std::erase(standing_commands_, std::pair(sample.client, sample.request)) > 0) ++written_.standing_changes;
  return true;
}
/// Its answer may change the standing questions.
void Recording::State::note_standing_command(const wire::Query& sample) {
  constexpr std::size_t kMostCommands = 1'000;
  if (sample.kind != static_cast<std::uint8_t>(wire_contract::QuestionKind::command)) return;
  if (std::string_view(sample.text).find('"' + std::string(wire_contract::command::kFence) + '"') ==
      std::string_view::npos)
    return;
  if (standing_commands_.size() == kMostCommands) standing_commands_.pop_front();
  standing_commands_.emplace_back(sample.client, sample.request);
}

Recording::State::State(std::shared_ptr<client::Connection> connection, const std::string& path)
    : connection_(std::move(connection)),
      output_(path),
      writer_(output_, recording::library_name(), recording::channels_of(connection_->options().name_space)),
      object_topic_(connection_->participant(), connection_->options().name_space),
      pose_topic_(connection_->participant(), connection_->options().name_space),
      query_topic_(connection_->participant(), connection_->options().name_space, kOverheardQuestions),
      reply_topic_(connection_->participant(), connection_->options().name_space),
      event_topic_(connection_->participant(), connection_->options().name_space),
      contact_topic_(connection_->participant(), connection_->options().name_space),
      probe_topic_(connection_->participant(), connection_->options().name_space),
      status_topic_(connection_->participant(), connection_->options().name_space),
      step_topic_(connection_->participant(), connection_->options().name_space, wire_contract::kStepTopic),
      standing_event_topic_(connection_->participant(), connection_->options().name_space),
      standing_state_topic_(connection_->participant(), connection_->options().name_space) {
  for (const recording::RecordedTopic& topic : recording::kRecordedTopics) {
    written_.channels.push_back({.topic = topic.row.suffix, .samples = 0, .lost = 0});
  }
  // The readers are made before the opening is fetched, so that nothing in between is missed.
  readers_.reset(new Readers{
      .object = dds::Reader<wire::Definition>(object_topic_, into<wire::Definition>(Recorded::object)),
      .pose = dds::Reader<wire::PoseBatch>(pose_topic_, into<wire::PoseBatch>(Recorded::pose)),
      .query = dds::Reader<wire::Query>(
          query_topic_, into<wire::Query>(Recorded::query, connection_->options().keys.empty() ? "" : kAllRights)),
      .reply = dds::Reader<wire::Reply>(reply_topic_, into<wire::Reply>(Recorded::reply, kAllClients)),
      .event = dds::Reader<wire::EventFrame>(event_topic_, into<wire::EventFrame>(Recorded::event)),
      .contact = dds::Reader<wire::ContactShard>(contact_topic_, into<wire::ContactShard>(Recorded::contact)),
      .probe = dds::Reader<wire::ProbeFrame>(probe_topic_, into<wire::ProbeFrame>(Recorded::probe)),
      .status = dds::Reader<wire::Status>(status_topic_, into<wire::Status>(Recorded::status)),
      .step = dds::Reader<wire::Status>(step_topic_, into<wire::Status>(Recorded::step)),
      .standing_event =
          dds::Reader<wire::StandingFrame>(standing_event_topic_, into<wire::StandingFrame>(Recorded::standing_event)),
      .standing_state = dds::Reader<wire::StandingShard>(standing_state_topic_,
                                                         into<wire::StandingShard>(Recorded::standing_state))});
}

Result<std::unique_ptr<Recording::State>> Recording::State::start(std::shared_ptr<client::Connection> connection,
                                                                  const std::string& path) {
  try {
    std::unique_ptr<State> state(new State(std::move(connection), path));
    state->wait_until_heard();
    state->written_.no_opening = state->begin_with_opening();
    state->thread_ = std::thread([raw = state.get()] { raw->run(); });
    return state;
  } catch (const dds::DdsError& failed) {
    return client::failure_of(failed);
  } catch (const std::runtime_error& failed) { return client::bad_input(failed.what()); }
}

Recording::State::~State() { static_cast<void>(finish()); }

/// Waits until all writers have matched the readers; earlier samples are not received. The server, the publishers and
/// the clients announce themselves every second.
void Recording::State::wait_until_heard() const {
  constexpr std::chrono::milliseconds kEverybody{1'100};
  const Clock::time_point start = Clock::now();
  const auto heard = [&] {
    return readers_->step.matched_writers() > 0 && readers_->event.matched_writers() > 0 &&
           readers_->standing_event.matched_writers() > 0;
  };
  client::wait_until(start + 2 * kEverybody, [&] { return Clock::now() >= start + kEverybody && heard(); });
}

/// Writes the existing world of publishers' and commands' objects. Returns the reason if that is not possible.
std::string Recording::State::begin_with_opening() {
  const Result<std::vector<std::byte>> file = client::fetch_recorded(*connection_, std::chrono::nanoseconds(0));
  if (!file) return file.error().message;
  const mcap::Contents contents = mcap::read(*file);
  const auto about = contents.metadata.find("recording");
  if (about != contents.metadata.end() && about->second.contains(recording::kOpeningCommands)) {
    const auto noted = recording::command_numbers(about->second.at(recording::kOpeningCommands));
    opening_commands_ = {noted.begin(), noted.end()};
  }
  writer_.metadata("recording", {{"opening_messages", std::to_string(contents.messages.size())}});
  for (const mcap::Message& message : contents.messages) {
    const auto topic = recording::recorded_topic(contents.channels.at(message.head.channel), contents);
    if (!topic) continue;
    writer_.write(static_cast<std::uint16_t>(*topic), message.head.log_time, message.head.publish_time, message.data);
    const std::lock_guard lock(mutex_);
    ++given_[static_cast<std::size_t>(*topic) - 1];
    dds::Sample<wire::PoseBatch> batch;
    if (*topic == Recorded::pose && wire::read_cdr(message.data, batch)) hear(*batch);
  }
  writer_.flush();
  return {};
}

/// The readers exist before the opening, so commands in between are received as well.
bool Recording::State::is_in_opening(const RecordingQueue::Entry& entry) {
  if (entry.client == 0 || opening_commands_.erase({entry.client, entry.request}) == 0) return false;
  const std::lock_guard lock(mutex_);
  --given_[entry.channel - std::size_t{1}];
  return true;
}

void Recording::State::run() {
  RecordingQueue::Batch batch;
  Clock::time_point next_chunk = Clock::now() + kChunkPeriod;
  bool last = false;
  while (!last) {
    last = stopping_.load();  // earlier samples are still written
    queue_.take(batch, std::chrono::milliseconds(100));
    add_own_channels();
    for (const RecordingQueue::Entry& entry : batch.entries) {
      if (is_in_opening(entry)) continue;
      writer_.write(entry.channel, entry.log_time, entry.publish_time,
                    std::span(batch.bytes).subspan(entry.begin, entry.size));
    }
    if (Clock::now() >= next_chunk) {
      writer_.flush();
      next_chunk = Clock::now() + kChunkPeriod;
    }
    note_written();
  }
}

/// Channels that were new to write() follow the topics, in the same order.
void Recording::State::add_own_channels() {
  const std::lock_guard lock(mutex_);
  while (own_in_file_ < own_.size()) {
    const OwnChannel& channel = own_[own_in_file_++];
    writer_.add_channel({.topic = channel.topic,
                         .encoding = channel.encoding,
                         .schema_name = channel.schema_name,
                         .schema_encoding = channel.schema_encoding,
                         .schema = channel.schema,
                         .metadata = {},
                         .is_only_when_used = true});
  }
}

Result<void> Recording::State::write(const OwnChannel& channel, std::string_view message) {
  const std::lock_guard lock(mutex_);
  const auto is_known = [&](const OwnChannel& known) { return known.topic == channel.topic; };
  const auto known = std::find_if(own_.begin(), own_.end(), is_known);
  const auto place = static_cast<std::size_t>(known - own_.begin());
  if (finished_) return client::bad_input("the recording has ended", "Nothing was written");
  if (known == own_.end()) {
    if (own_.size() == RecordingQueue::kMostOwn)
      return client::bad_input("a recording has at most 8 channels of its own", "Nothing was written");
    own_.push_back(channel);
    written_.channels.push_back({.topic = channel.topic, .samples = 0, .lost = 0});
  }
  ++given_[RecordingQueue::kTopics + place];
  queue_.put(static_cast<std::uint16_t>(RecordingQueue::kTopics + place + 1), message,
             static_cast<std::uint64_t>(wire_contract::since_1970_ns()));
  return {};
}

void Recording::State::note_written() {
  const auto dropped = queue_.dropped();
  const std::lock_guard lock(mutex_);
  loss_.settle(Clock::now());
  written_.samples = writer_.messages_written();
  written_.bytes = output_.size();
  written_.problem = output_.problem();
  written_.unanswered = loss_.unanswered();
  written_.lost = 0;
  for (std::size_t i = 0; i < written_.channels.size(); ++i) {
    RecordedChannel& channel = written_.channels[i];
    const auto topic = static_cast<Recorded>(i + 1);
    channel.samples = given_[i] - dropped[i];
    channel.lost = dropped[i];
    if (topic == Recorded::pose) channel.lost += loss_.poses();
    if (topic == Recorded::event) channel.lost += loss_.events();
    if (topic == Recorded::standing_event) channel.lost += standing_loss_.events();
    if (topic == Recorded::query) channel.lost += loss_.questions();
    written_.lost += channel.lost;
  }
}

RecordingCounts Recording::State::counts() const {
  const std::lock_guard lock(mutex_);
  return written_;
}

Result<RecordingCounts> Recording::State::finish() {
  {
    const std::lock_guard lock(mutex_);
    if (finished_) return written_;
    finished_ = true;
  }
  readers_.reset();
  stopping_.store(true);
  queue_.wake();
  if (thread_.joinable()) thread_.join();
  {
    const std::lock_guard lock(mutex_);
    loss_.settle(Clock::now(), true);
  }
  const bool whole = writer_.close();
  note_written();
  if (whole) return counts();
  return Error{ErrorCode::refused, "recording stopped: " + output_.problem(),
               "what was written before can be read: " + std::to_string(writer_.messages_written()) + " samples"};
}

// ---- the public side

Recording::Recording(std::unique_ptr<State> state) : state_(std::move(state)) {}
Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;
RecordingCounts Recording::counts() const { return state_->counts(); }
Result<RecordingCounts> Recording::finish() { return state_->finish(); }
Client Recording::client() const { return Client::over(state_->connection()); }
Result<void> Recording::write(const OwnChannel& channel, std::string_view message) {
  return state_->write(channel, message);
}

Result<Recording> record(const ConnectOptions& options, const std::string& path) {
  Result<std::shared_ptr<client::Connection>> connection = client::Connection::open(options, dds::Role::server);
  if (!connection) return connection.error();
  Result<std::unique_ptr<Recording::State>> state = Recording::State::start(std::move(*connection), path);
  if (!state) return state.error();
  return Recording(std::move(*state));
}

}  // namespace collided
