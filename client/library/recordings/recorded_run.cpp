#include "client/library/recordings/recorded_run.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "idl/command_table.hpp"

namespace collided::client {
namespace {

using recording::Recorded;
using wire_contract::QuestionKind;
using wire_contract::ReplyStatus;
namespace names = wire_contract::command;

/// Parses a text as JSON; a discarded value if it is not JSON.
nlohmann::json parsed(std::string_view text) { return nlohmann::json::parse(text, nullptr, false); }

std::string word_of(const nlohmann::json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

class Sorting {
 public:
  explicit Sorting(RecordedRun& run) : run_(run) {}

  void sort() {
    run_.origins.resize(run_.items.size());
    // Questions first, since a reply, on another topic, may have been received before its question.
    for (const bool replies : {false, true}) {
      for (std::size_t i = 0; i < run_.items.size(); ++i) {
        if ((run_.items[i].topic == Recorded::reply) == replies) look_at(i);
      }
    }
    settle_requests();
    if (broken_ > 0)
      run_.warnings.push_back(std::to_string(broken_) + " messages hold no sample of their topic; left out");
  }

 private:
  struct Request {
    std::map<std::uint32_t, std::size_t> questions;  // by chunk
    std::vector<std::size_t> replies;
    std::uint32_t chunk_count = 0;
    std::uint8_t kind = 0;
    std::set<std::uint32_t> answered;  // chunks
    std::optional<StateNumber> state;
    std::uint32_t reply_chunks = 0;
    std::map<std::uint32_t, std::string> text;  // of a command's reply, by chunk
    bool changes = false;                       // a command that changes the world; else a question
    bool changes_files = false;                 // loads or clears scenes, which is not replayed
    bool refused = false;
    bool opening = false;
  };

  void look_at(std::size_t index) {
    const RecordedItem& item = run_.items[index];
    switch (item.topic) {
      case Recorded::object:
        return read(item, definition_, [&] {
          run_.origins[index] = {definition_->publisher, definition_->incarnation, 0};
          if (item.opening) note_opening(definition_->publisher, definition_->sequence_number);
        });
      case Recorded::pose:
        return read(item, batch_, [&] {
          run_.origins[index] = {batch_->publisher, batch_->incarnation, batch_->source_time_ns};
          if (item.opening) note_opening(batch_->publisher, batch_->sequence_number);
        });
      case Recorded::query: return read(item, query_, [&] { take_query(index); });
      case Recorded::reply: return read(item, reply_, [&] { take_reply(index); });
      case Recorded::status:
        return read(item, status_, [&] {
          run_.scenes = status_->scenes;
          take_state();
        });
      case Recorded::step: return read(item, status_, [&] { take_state(); });
      default: return;
    }
  }

  template <class T, class Then>
  void read(const RecordedItem& item, dds::Sample<T>& sample, const Then& then) {
    if (wire::read_cdr(item.data, sample)) {
      then();
    } else {
      ++broken_;
    }
  }

  void note_opening(std::uint64_t publisher, std::uint64_t sequence) {
    std::uint64_t& through = run_.opening_through[publisher];
    through = std::max(through, sequence);
  }

  void take_state() {
    RecordedState state;
    const auto publishers = dds::view(status_->publishers);
    const auto applied = dds::view(status_->applied_sequences);
    const auto states = dds::view(status_->publisher_states);
    for (std::size_t i = 0; i < std::min({publishers.size(), applied.size(), states.size()}); ++i) {
      state.applied[publishers[i]] = applied[i];
      if (states[i] == static_cast<std::uint8_t>(wire_contract::PublisherState::lost)) state.lost.insert(publishers[i]);
    }
    // The newest status of a version counts: it may add samples that changed nothing and lost publishers without
    // objects.
    newest_ = {status_->epoch, status_->version};
    run_.states[newest_] = std::move(state);
  }

  void take_query(std::size_t index) {
    if (query_->kind == static_cast<std::uint8_t>(QuestionKind::hello)) return;
    // Questions about past instants cannot be replayed.
    if (query_->instant != 0) return;
    const bool command = query_->kind == static_cast<std::uint8_t>(QuestionKind::command);
    const std::string what = command ? word_of(parsed(query_->text), "command") : std::string();
    const names::CommandSpec* const spec = names::find_command(what);
    const bool changes_files = spec != nullptr && spec->changes == names::Changes::scenes;
    const bool is_change = spec != nullptr && spec->is_recorded_change() && !changes_files;
    if (changes_files) ++run_.changing_files;
    const bool is_asked_again = (what == names::kPair || what == names::kClearance) && !run_.items[index].opening &&
                                word_of(parsed(query_->text), "as_of").empty();
    if (command && !is_asked_again && !is_change && !changes_files) return;
    const bool needs_no_reply = query_->client == 0 || run_.items[index].opening;
    if ((is_change || changes_files) && needs_no_reply) run_.carried_out[index] = {index, {}};
    if (changes_files && needs_no_reply) return;
    // Commands that the server repeated after a restart have no reply.
    if (query_->client == 0 && !run_.items[index].opening) return note_command(index, following_newest());
    Request& request = requests_[{query_->client, query_->request}];
    request.questions.emplace(query_->chunk_index, index);
    request.chunk_count = query_->chunk_count;
    request.kind = query_->kind;
    request.changes = is_change;
    request.changes_files = changes_files;
    request.opening = run_.items[index].opening;
    if (request.opening) settle_opening(request);
  }

  /// Takes a command of the opening. It has a reply in the recording only if it was in flight at the start. Two
  /// commands that the server has composed may have the same number.
  void settle_opening(Request& request) {
    const std::size_t index = request.questions.begin()->second;
    note_command(index, {0, 0});
    opening_commands_[{query_->client, query_->request}] = index;
    requests_.erase({query_->client, query_->request});
  }

  void note_command(std::size_t index, const StateNumber& state) { run_.commands[state].push_back(index); }
  /// The state that follows those read so far.
  StateNumber following_newest() const { return {newest_.first, newest_.second + 1}; }

  void take_reply(std::size_t index) {
    if (is_farewell(*reply_)) return note_command(index, {reply_->epoch, reply_->version});
    const auto found = requests_.find({reply_->client, reply_->request});
    const bool is_refused = reply_->status == static_cast<std::uint8_t>(ReplyStatus::refused);
    if (is_refused) forget_opening_command();
    if (found == requests_.end() || reply_->status == static_cast<std::uint8_t>(ReplyStatus::progress)) return;
    Request& request = found->second;
    request.refused = request.refused || is_refused;
    request.replies.push_back(index);
    request.answered.insert(reply_->chunk_index);
    request.state = {reply_->epoch, reply_->version};
    const auto text = dds::view(reply_->text);
    request.reply_chunks = reply_->chunk_count;
    request.text[reply_->chunk_index].assign(text.begin(), text.end());
  }

  /// Drops a command that was in flight when the recording began and was then refused.
  void forget_opening_command() {
    const auto found = opening_commands_.find({reply_->client, reply_->request});
    if (found == opening_commands_.end()) return;
    std::erase(run_.commands[{0, 0}], found->second);
    run_.carried_out.erase(found->second);
  }

  static std::string text_of(const Request& request) {
    std::string text;
    for (const auto& [chunk, part] : request.text) text += part;
    return text;
  }
  static std::uint64_t reported_version(const Request& request) {
    const nlohmann::json answer = parsed(text_of(request));
    const auto version = answer.is_object() ? answer.find("version") : answer.end();
    const bool told = answer.is_object() && version != answer.end() && version->is_number_unsigned();
    return told ? version->get<std::uint64_t>() : request.state->second;
  }

  void settle_requests() {
    for (auto& [who, request] : requests_) {
      const bool command = request.kind == static_cast<std::uint8_t>(QuestionKind::command);
      const bool whole = request.state && request.questions.size() == request.chunk_count &&
                         request.answered.size() == (command ? request.reply_chunks : request.chunk_count);
      if (request.refused) continue;
      if (!whole) {
        run_.unanswered += request.changes_files ? 0 : 1;
        continue;
      }
      if (request.changes || request.changes_files)
        run_.carried_out[request.replies.back()] = {request.questions.begin()->second, text_of(request)};
      if (request.changes_files) continue;
      // A command's answer has the state that it made or was about; the reply's own version may be later.
      const StateNumber state{request.state->first, command ? reported_version(request) : request.state->second};
      if (request.changes) {
        note_command(request.questions.begin()->second, state);
      } else {
        RecordedRequest about{.questions = {}, .replies = request.replies};
        for (const auto& [chunk, index] : request.questions) about.questions.push_back(index);
        run_.requests[state].push_back(std::move(about));
      }
    }
  }

  RecordedRun& run_;
  dds::Sample<wire::Definition> definition_;
  dds::Sample<wire::PoseBatch> batch_;
  dds::Sample<wire::Query> query_;
  dds::Sample<wire::Reply> reply_;
  dds::Sample<wire::Status> status_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, Request> requests_;              // client, number
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::size_t> opening_commands_;  // items, by client and number
  StateNumber newest_;                                                               // of those read so far
  std::uint64_t broken_ = 0;
};

}  // namespace

bool is_farewell(const wire::Reply& reply) {
  const auto text = dds::view(reply.text);
  return reply.request == 0 && std::ranges::equal(text, std::string_view(names::kClientGone));
}

RecordedRun read_run(const std::string& path) { return read_run(read_recording(path), path); }

RecordedRun read_run(std::vector<std::byte> bytes, const std::string& name, const char* consequence) {
  RecordedRun run;
  static_cast<RecordedItems&>(run) = read_items(std::move(bytes), name, consequence);
  Sorting(run).sort();
  return run;
}

}  // namespace collided::client
