#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <nlohmann/json.hpp>

#include "client/library/connection/errors.hpp"
#include "client/library/recordings/asked_again.hpp"
#include "client/library/recordings/recorded_events.hpp"
#include "client/library/recordings/recorded_run.hpp"
#include "client/library/recordings/replay_times.hpp"
#include "client/library/recordings/replayed_standing.hpp"
#include "client/library/recordings/replayed_publishers.hpp"
#include "collided/recording.hpp"
#include "idl/clocks.hpp"
#include "idl/commands.hpp"

namespace collided {
namespace {

using client::Clock;
using client::ComparedAnswer;
using client::Connection;
using client::RecordedItem;
using client::RecordedRequest;
using client::RecordedRun;
using client::RecordedState;
using client::ReplayedPublishers;
using recording::Recorded;

constexpr std::chrono::milliseconds kAlivePeriod{100};

/// The name of the command in a query's text.
std::string command_of(const nlohmann::json& text) {
  return text.is_object() ? text.value("command", "") : std::string();
}

nlohmann::json parsed_text(const wire::Query& query) { return nlohmann::json::parse(query.text, nullptr, false); }

/// Thrown if a replay cannot go on.
struct ReplayFailure : std::runtime_error {
  explicit ReplayFailure(Error given) : std::runtime_error(given.message), error(std::move(given)) {}
  Error error;
};

/// The base of both kinds of replay: publishes recorded samples and repeats recorded commands.
class Replaying {
 public:
  Replaying(Connection& connection, const RecordedRun& run, const ReplayOptions& options)
      : connection_(connection), run_(run), options_(options), publishers_(connection), standing_(connection) {}

  ReplayReport take() {
    report_.standing = standing_.made();
    return std::move(report_);
  }

 protected:
  /// Publishes a definition or pose batch; ignores other samples. Velocities are adapted to the rate.
  /// source_time_ns  of the poses
  void publish(const RecordedItem& item, std::int64_t source_time_ns) {
    if (item.topic == Recorded::object && wire::read_cdr(item.data, definition_)) {
      report_.samples += publishers_.publish(*definition_) ? 1 : 0;
    } else if (item.topic == Recorded::pose && wire::read_cdr(item.data, batch_)) {
      if (options_.rate != 1) {
        for (auto* column : {&batch_->linear_velocities, &batch_->angular_velocities}) {
          for (std::uint32_t i = 0; i < column->_length; ++i) column->_buffer[i] *= options_.rate;
        }
      }
      report_.samples += publishers_.publish(*batch_, item.log_time, source_time_ns) ? 1 : 0;
    }
  }

  void give_command(std::size_t index) {
    if (run_.items[index].topic == Recorded::reply) return say_farewell(run_.items[index]);
    std::vector<dds::Sample<wire::Query>> query(1);
    if (!wire::read_cdr(run_.items[index].data, query[0])) return;
    const std::uint64_t recorded_client = query[0]->client;
    const nlohmann::json arguments = parsed_text(*query[0]);
    // The parent may belong to a publisher, whose definition arrives on another topic.
    if (command_of(arguments) == wire_contract::command::kAttach) wait_applied();
    std::string refusal;
    ask(query, [&](const wire::Reply& reply) {
      const auto text = dds::view(reply.text);
      if (reply.status == static_cast<std::uint8_t>(wire_contract::ReplyStatus::refused))
        refusal.assign(text.begin(), text.end());
    });
    ++report_.commands;
    if (!refusal.empty()) return warn(std::string("refused now: ") + query[0]->text + ": " + refusal);
    if (command_of(arguments) == wire_contract::command::kFence)
      standing_.done(recorded_client, arguments, dds::view(query[0]->blob));
  }

  void ask(std::vector<dds::Sample<wire::Query>>& queries, const std::function<void(const wire::Reply&)>& take) {
    if (auto error = client::ask_again(connection_, queries, take)) throw ReplayFailure(*error);
  }

  void lose_whom(const RecordedState& state) {
    for (const std::uint64_t publisher : state.lost) publishers_.lose(publisher);
  }

  /// Keeps the publishers alive. False if the caller wants to stop.
  bool go_on() {
    if (Clock::now() >= next_alive_) {
      publishers_.keep_alive();
      next_alive_ = Clock::now() + kAlivePeriod;
    }
    report_.stopped = report_.stopped || (options_.go_on && !options_.go_on());
    return !report_.stopped;
  }

  void warn(std::string sentence) {
    constexpr std::size_t kMost = 20;
    if (report_.warnings.size() < kMost) report_.warnings.push_back(std::move(sentence));
  }

  void wait_applied() {
    if (!publishers_.wait_applied(std::chrono::seconds(5))) {
      if (const std::string why = publishers_.why_refused(); !why.empty())
        throw ReplayFailure({ErrorCode::refused, "replay: the server takes nothing of a recorded publisher: " + why,
                             "none of its objects are in the world"});
      throw ReplayFailure({ErrorCode::timeout, "replay: the server has not taken all samples within 5 s",
                           "is its namespace also moved by others?"});
    }
  }

  Connection& connection_;
  const RecordedRun& run_;
  const ReplayOptions& options_;
  ReplayReport report_;
  ReplayedPublishers publishers_;
  client::ReplayedStanding standing_;

 private:
  void say_farewell(const RecordedItem& item) {
    if (wire::read_cdr(item.data, farewell_)) standing_.owner_gone(farewell_->client);
  }

  dds::Sample<wire::Definition> definition_;
  dds::Sample<wire::PoseBatch> batch_;
  dds::Sample<wire::Reply> farewell_;
  Clock::time_point next_alive_ = Clock::now();
};

/// Replays in the recording's time, scaled by the rate.
class TimedReplay : public Replaying {
 public:
  TimedReplay(Connection& connection, const RecordedRun& run, const ReplayOptions& options)
      : Replaying(connection, run, options), times_(client::replay_times(run)) {}

  void run() {
    if (times_.undated_publishers > 0)
      warn("the stamps of " + std::to_string(times_.undated_publishers) +
           " publishers stay half a second or more away from the times of their recording, as when a clock is set or a "
           "recorder is slow; their poses are dated by the latter, so events may be others");
    std::set<std::size_t> commands;
    for (const auto& [state, items] : run_.commands) commands.insert(items.begin(), items.end());
    const client::RecordedSpan span = client::span_of(run_);
    began_at_ = (options_.from ? client::resolved(*options_.from, span) : span.begin).count();
    const std::int64_t end = (options_.to ? client::resolved(*options_.to, span) : span.end).count();
    if (began_at_ > end)
      throw ReplayFailure(client::bad_input("replay: the end of what is asked for lies before its begin", ""));
    for (std::size_t place = 0; place < times_.order.size(); ++place) {
      const std::size_t i = times_.order[place];
      const RecordedItem& item = run_.items[i];
      expected_ = std::max(expected_, place);
      const std::int64_t due_ns = times_.of[i].due_ns;
      const bool is_before = item.opening || (options_.from && due_ns < began_at_);
      if (!item.opening && due_ns > end) break;
      if (!item.opening && (is_before ? !go_on() : !wait_until(due_ns))) return;
      if (commands.count(i) > 0) give_command(i);
      if (item.topic == Recorded::status || item.topic == Recorded::step) lose_lost(item);
      publish(item, is_before ? wire_contract::since_1970_ns() : replayed_at(times_.of[i].source_ns));
    }
    wait_applied();
    call_at_end();
  }

 private:
  std::chrono::nanoseconds after_begin(std::int64_t recorded_ns) const {
    const double after_ns = std::max(0.0, static_cast<double>(recorded_ns - began_at_));
    return std::chrono::nanoseconds(static_cast<std::int64_t>(std::min(after_ns / options_.rate, 9e18)));
  }
  /// Registers the publishers whose samples are due soon. A registration takes milliseconds; if many started together,
  /// the last ones would be so late that the server would date their samples itself.
  void expect_publishers(std::int64_t due_ns) {
    constexpr double kAheadNs = 2e9;
    for (; expected_ < times_.order.size(); ++expected_) {
      const std::size_t i = times_.order[expected_];
      if (static_cast<double>(times_.of[i].due_ns - due_ns) > kAheadNs * std::min(options_.rate, 100.0)) return;
      const client::RecordedOrigin& origin = run_.origins[i];
      if (origin.publisher != 0) publishers_.expect(origin.publisher, origin.incarnation);
    }
  }
  /// Starts the replay's clock, since the opening may take any time.
  void begin() {
    expect_publishers(began_at_);
    publishers_.wait_until_read();
    began_ = Clock::now();
    began_ns_ = wire_contract::since_1970_ns();
  }
  bool wait_until(std::int64_t recorded_ns) {
    constexpr std::chrono::milliseconds kLook{20};
    if (!began_) begin();
    expect_publishers(recorded_ns);
    const Clock::time_point when = *began_ + after_begin(recorded_ns);
    while (go_on()) {
      const Clock::time_point now = Clock::now();
      if (now >= when) return true;
      std::this_thread::sleep_for(std::min<Clock::duration>(when - now, kLook));
    }
    return false;
  }
  /// A recorded time on the replay's clock, since 1970.
  std::int64_t replayed_at(std::int64_t recorded_ns) const { return began_ns_ + after_begin(recorded_ns).count(); }
  /// Runs ReplayOptions::at_end while keeping the publishers alive.
  void call_at_end() {
    if (!options_.at_end) return;
    if (!began_) begin();
    const std::chrono::nanoseconds shift(began_ns_ - began_at_);
    std::future<void> asked = std::async(std::launch::async, [&] { options_.at_end(shift); });
    while (asked.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) go_on();
    asked.get();
  }
  void lose_lost(const RecordedItem& item) {
    if (!wire::read_cdr(item.data, status_)) return;
    const auto found = run_.states.find({status_->epoch, status_->version});
    if (found != run_.states.end()) lose_whom(found->second);
  }

  const client::ReplayTimes times_;
  std::size_t expected_ = 0;   // number of items, in the order of times_, whose publishers were registered
  std::int64_t began_at_ = 0;  // time in the recording
  std::optional<Clock::time_point> began_;
  std::int64_t began_ns_ = 0;  // that time on the replay's clock, since 1970
  dds::Sample<wire::Status> status_;
};

/// Replays state by state: publishes the samples that each recorded state adds to the one before, then repeats the
/// questions about that state while nothing else changes.
class AskedReplay : public Replaying {
 public:
  AskedReplay(Connection& connection, const RecordedRun& run, const ReplayOptions& options)
      : Replaying(connection, run, options) {
    sort_samples();
  }

  void run() {
    for (const RecordedItem& item : run_.items) {
      if (item.opening) publish(item, 0);
    }
    const auto opening_commands = run_.commands.find({0, 0});
    if (opening_commands != run_.commands.end())
      for (const std::size_t index : opening_commands->second) give_command(index);
    auto next_command = run_.commands.upper_bound({0, 0});
    for (const auto& [number, state] : run_.states) {
      if (!go_on()) return;
      publish_through(state);
      for (; next_command != run_.commands.end() && next_command->first <= number; ++next_command) {
        for (const std::size_t index : next_command->second) give_command(index);
      }
      lose_whom(state);
      const auto asked = run_.requests.find(number);
      if (asked == run_.requests.end()) continue;
      wait_applied();
      for (const RecordedRequest& request : asked->second) {
        if (!go_on()) return;
        if (lacks_opening(state)) leave_out(request, "asked before all of the opening was in the recorded world");
        else compare(number, request);
      }
    }
    for (const auto& [number, requests] : run_.requests) {
      if (run_.states.count(number) > 0) continue;
      for (const RecordedRequest& request : requests)
        leave_out(request, "asked of a state that the recording does not describe");
    }
    for (const auto& [why, count] : left_out_) {
      report_.not_compared += count;
      report_.why_not_compared.push_back(std::to_string(count) + ' ' + why);
    }
  }

 private:
  /// Sorts each publisher's samples by number, since samples of two topics may arrive out of order.
  void sort_samples() {
    for (std::size_t i = 0; i < run_.items.size(); ++i) {
      const RecordedItem& item = run_.items[i];
      if (item.opening) continue;
      if (item.topic == Recorded::object && wire::read_cdr(item.data, definition_)) {
        samples_[definition_->publisher].emplace(definition_->sequence_number, i);
      } else if (item.topic == Recorded::pose && wire::read_cdr(item.data, batch_) && batch_->sequence_number > 0) {
        samples_[batch_->publisher].emplace(batch_->sequence_number, i);
      }
    }
  }

  void publish_through(const RecordedState& state) {
    for (const auto& [publisher, applied] : state.applied) {
      const auto found = samples_.find(publisher);
      if (found == samples_.end()) continue;
      const auto end = found->second.upper_bound(applied);
      for (auto sample = found->second.begin(); sample != end && go_on(); ++sample)
        publish(run_.items[sample->second], wire_contract::since_1970_ns());
      found->second.erase(found->second.begin(), end);
    }
  }

  bool lacks_opening(const RecordedState& state) const {
    return std::any_of(state.applied.begin(), state.applied.end(), [&](const auto& publisher) {
      const auto opening = run_.opening_through.find(publisher.first);
      return opening != run_.opening_through.end() && publisher.second < opening->second;
    });
  }

  std::map<std::uint64_t, ComparedAnswer> recorded_answers(const RecordedRequest& request) {
    client::ComparedAnswers answers;
    for (const std::size_t index : request.replies) {
      if (wire::read_cdr(run_.items[index].data, reply_)) answers.add(*reply_);
    }
    return answers.take();
  }

  void leave_out(const RecordedRequest& request, const char* why) {
    left_out_[why] += recorded_answers(request).size();
  }

  void compare(const client::StateNumber& number, const RecordedRequest& request) {
    const std::map<std::uint64_t, ComparedAnswer> then = recorded_answers(request);
    std::vector<dds::Sample<wire::Query>> queries(request.questions.size());
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (!wire::read_cdr(run_.items[request.questions[i]].data, queries[i])) return;
    }
    const auto asked = static_cast<wire_contract::QuestionKind>(queries[0]->kind);
    const std::string kind = asked == wire_contract::QuestionKind::command ? command_of(parsed_text(*queries[0]))
                                                                           : std::string(wire_contract::name_of(asked));
    client::ComparedAnswers answers;
    ask(queries, [&](const wire::Reply& reply) { answers.add(reply); });
    const std::map<std::uint64_t, ComparedAnswer> now = answers.take();
    for (const auto& [question, answer] : then) {
      if (answer.by_clock) {
        ++left_out_["were answered by the clock: a deadline, or a server that was still recovering"];
        continue;
      }
      ++report_.questions;
      const auto again = now.find(question);
      if (again != now.end() && again->second.bytes == answer.bytes) {
        ++report_.equal;
      } else {
        tell(number, kind, question, answer, again == now.end() ? "no answer" : again->second.words);
      }
    }
  }

  void tell(const client::StateNumber& number, const std::string& kind, std::uint64_t question,
            const ComparedAnswer& then, const std::string& now) {
    constexpr std::size_t kMost = 20;
    if (report_.differences.size() >= kMost) return;
    const std::string unlike = then.words == now ? " (in bits that this does not show)" : "";
    report_.differences.push_back("version " + std::to_string(number.second) + ", " + kind + ' ' +
                                  std::to_string(question) + ": then " + then.words + ", now " + now + unlike);
  }

  std::map<std::uint64_t, std::multimap<std::uint64_t, std::size_t>> samples_;  // by publisher and number
  std::map<std::string, std::uint64_t> left_out_;
  dds::Sample<wire::Definition> definition_;
  dds::Sample<wire::PoseBatch> batch_;
  dds::Sample<wire::Reply> reply_;
};

/// Warnings about requirements of the replay that the recording does not contain.
std::vector<std::string> warnings_of(const RecordedRun& run, const Connection& connection, bool ask) {
  std::vector<std::string> warnings = run.warnings;
  const std::optional<ServerStatus> status = connection.pulse().status();
  std::istringstream scenes(run.scenes);
  for (std::string scene; std::getline(scenes, scene);) {
    const bool loaded = status && std::count(status->scenes.begin(), status->scenes.end(), scene) > 0;
    if (!loaded) warnings.push_back("scene '" + scene + "' was loaded then and is not now");
  }
  if (run.changing_files > 0) {
    warnings.push_back(std::to_string(run.changing_files) +
                       " commands load or clear are not given again; load first what they left");
  }
  if (!run.has_opening) warnings.push_back("the recording does not say what was in the world before it");
  if (ask && run.unanswered > 0)
    warnings.push_back(std::to_string(run.unanswered) + " requests are not whole in the recording; not asked");
  return warnings;
}

template <class Replay>
ReplayReport replay_by(Connection& connection, const RecordedRun& run, const ReplayOptions& options) {
  Replay replay(connection, run, options);
  replay.run();
  return replay.take();
}

}  // namespace

Result<ReplayReport> replay(const ConnectOptions& connect, const ReplayOptions& options) {
  if (!(options.rate > 0 && options.rate <= 1e6)) {
    return client::bad_input("replay: rate is " + client::words(options.rate) + "; allowed above 0 up to 1e6", "");
  }
  if (options.ask && (options.from || options.to || options.at_end))
    return client::bad_input("replay: asking again takes the whole recording; no from, to or at_end", "");
  try {
    const RecordedRun run = client::read_run(options.path);
    const Result<std::shared_ptr<Connection>> connection = Connection::open(connect);
    if (!connection) return connection.error();
    const Clock::time_point patience = Clock::now() + std::chrono::seconds(1);
    (*connection)->pulse().wait_for_status(patience);
    std::vector<std::string> warnings = warnings_of(run, **connection, options.ask);
    ReplayReport report = options.ask ? replay_by<AskedReplay>(**connection, run, options)
                                      : replay_by<TimedReplay>(**connection, run, options);
    report.warnings.insert(report.warnings.begin(), warnings.begin(), warnings.end());
    return report;
  } catch (const ReplayFailure& failed) { return failed.error; } catch (const dds::DdsError& failed) {
    return Error{ErrorCode::internal, failed.what(), ""};
  } catch (const std::runtime_error& failed) { return client::bad_input(failed.what(), ""); }
}

}  // namespace collided
