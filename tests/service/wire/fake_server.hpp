#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "collided/client.hpp"
#include "idl/dds.hpp"
#include "tests/service/wire/network.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided::test {

/// Where a client finds the fake server.
inline ConnectOptions here() {
  return {.domain = own_domain(), .name_space = own_namespace(), .wait = std::chrono::seconds(5)};
}

/// Speaks a server's side of the wire with made-up answers, so that the client library is tested without an engine.
/// A ray from (x, y, z) hits object 7, "wall", at distance x, and misses for x < 0. What a question's `only` says:
/// "refuse", "busy" (three refusals with a time to wait, then answers), "silent" (no reply), "late" (reply when told),
/// "twice" (every reply two times), "nonsense".
class FakeServer {
 public:
  static constexpr std::uint64_t kWall = 7 + (std::uint64_t{3} << 32);

  /// beats  false: nothing is heard of it before `beating` is set
  explicit FakeServer(const std::string& name_space, std::uint64_t server = 1,
                      const dds::ParticipantOptions& options = far_side(), bool beats = true)
      : server_(server),
        participant_(options),
        query_topic_(participant_, name_space),
        reply_topic_(participant_, name_space),
        status_topic_(participant_, name_space),
        object_topic_(participant_, name_space),
        pose_topic_(participant_, name_space),
        event_topic_(participant_, name_space),
        persisted_topic_(participant_, name_space, wire_contract::kPersistedTopic),
        contact_topic_(participant_, name_space),
        status_writer_(status_topic_),
        event_writer_(event_topic_),
        persisted_writer_(persisted_topic_),
        contact_writer_(contact_topic_),
        pose_reader_(pose_topic_, {.data = [this](dds::Taker<wire::PoseBatch> taker) { take_poses(taker); }}),
        object_reader_(object_topic_,
                       {.data = [this](dds::Taker<wire::Definition> taker) { take_definitions(taker); }}),
        query_reader_(query_topic_, {.data = [this](dds::Taker<wire::Query> taker) { take_queries(taker); }}) {
    status->server = server_;
    status->epoch = 100 + server_;
    status->version = 5;
    status->state = static_cast<std::uint8_t>(wire_contract::ServerState::ready);
    status->pid = 4711;
    static_cast<void>(dds::set_text(status->namespace_name, name_space));
    static_cast<void>(dds::set_text(status->scenes, "warehouse\nyard"));
    beating = beats;
    helper_ = std::thread([this] { help(); });
  }
  ~FakeServer() {
    ending_ = true;
    helper_.join();
    if (slow_.joinable()) { slow_.join(); }
  }

  /// Change under `mutex`; sent twenty times a second while `beating`.
  std::mutex mutex;
  dds::Sample<wire::Status> status;
  std::atomic<bool> beating{true};
  /// Takes hello and questions while true.
  std::atomic<bool> answering{true};

  struct Pose {
    std::uint64_t sequence = 0;
    std::vector<double> numbers;
    bool teleported = false;
  };
  struct Batch {
    std::uint64_t sequence = 0;
    std::uint64_t definitions_through = 0;
    std::int64_t source_time_ns = 0;
    std::uint8_t flags = 0;
    std::vector<std::uint32_t> object_numbers;
    std::vector<double> poses;
    std::vector<double> velocities;
  };
  struct Received {
    std::vector<Batch> batches;
    std::size_t writers_at_first = 0;            // of poses, that were matched when the first batch came
    std::vector<std::uint64_t> sequences;        // of definitions and batches as they came
    std::map<std::uint32_t, std::string> names;  // of objects that are not removed
    std::vector<std::size_t> batch_sizes;
    std::vector<std::uint64_t> definitions_through;
    std::map<std::uint32_t, Pose> poses;
    std::size_t definition_count = 0;
    std::vector<double> gaps_s;  // that publishers gave
    std::size_t largest_shape = 0;
  };
  Received received() {
    const std::lock_guard lock(mutex);
    return received_;
  }
  std::vector<std::uint32_t> query_chunks() {
    const std::lock_guard lock(mutex);
    return query_chunks_;
  }
  wire::Query last_query() {
    const std::lock_guard lock(mutex);
    return last_query_;
  }
  /// Answers to the next commands, one each, whatever they ask; what they asked.
  void will_answer(std::deque<std::string> answers) {
    const std::lock_guard lock(mutex);
    answers_to_come_ = std::move(answers);
    commands_.clear();
  }
  std::vector<std::string> commands() {
    const std::lock_guard lock(mutex);
    return commands_;
  }
  std::size_t most_in_flight() const { return most_in_flight_; }
  std::atomic<int> delay_us{0};  // of every answer, on a thread of its own
  std::atomic<bool> hold_publisher_lost{false};
  std::atomic<std::int64_t> busy_ns{0};      // says that its world has been at one step for so long
  std::atomic<bool> missed_the_last{false};  // says that the newest sample of each publisher has not come

  void send_status() {
    const std::lock_guard lock(mutex);
    fill_publishers();
    static_cast<void>(status_writer_.write(*status));
  }
  dds::Writer<wire::EventFrame>& events() { return event_writer_; }
  dds::Writer<wire::EventFrame>& persisted() { return persisted_writer_; }
  dds::Writer<wire::ContactShard>& contacts() { return contact_writer_; }
  dds::Participant& participant() { return participant_; }
  std::uint64_t number() const { return server_; }
  void release_late() { release_late_ = true; }

 private:
  void take_poses(const dds::Taker<wire::PoseBatch>& taker) {
    dds::Sample<wire::PoseBatch> batch;
    while (taker.take(batch)) {
      if (!batch.info().valid_data) { continue; }
      const std::lock_guard lock(mutex);
      note_sequence(batch->publisher, batch->sequence_number);
      received_.batch_sizes.push_back(batch->object_numbers._length);
      received_.definitions_through.push_back(batch->definitions_through);
      const auto numbers = dds::view(batch->object_numbers);
      const std::vector<double> poses = poses_of(*batch);
      if (received_.batches.empty()) received_.writers_at_first = pose_reader_.matched_writers();
      received_.batches.push_back({batch->sequence_number,
                                   batch->definitions_through,
                                   batch->source_time_ns,
                                   batch->flags,
                                   {numbers.begin(), numbers.end()},
                                   poses,
                                   rows_of<wire::PoseBatch>(*batch, wire::kVelocityColumns)});
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto pose = std::span(poses).subspan(i * 7, 7);
        received_.poses[numbers[i]] = {batch->sequence_number, {pose.begin(), pose.end()}, (batch->flags & 1) != 0};
      }
    }
  }

  void take_definitions(const dds::Taker<wire::Definition>& taker) {
    dds::Sample<wire::Definition> definition;
    while (taker.take(definition)) {
      if (!definition.info().valid_data) { continue; }
      const std::lock_guard lock(mutex);
      note_sequence(definition->publisher, definition->sequence_number);
      ++received_.definition_count;
      received_.largest_shape = std::max<std::size_t>(received_.largest_shape, definition->shape._length);
      if (definition->object_number == wire_contract::kObjectPublisherItself) {
        received_.gaps_s.push_back(definition->position[0]);
        continue;
      }
      received_.names.erase(definition->object_number);
      if (!definition->removed) {
        received_.names[definition->object_number] = definition->name;
        // The two topics are not in order with each other.
        Pose& pose = received_.poses[definition->object_number];
        if (pose.sequence < definition->sequence_number) {
          pose = {definition->sequence_number, {definition->position, definition->position + 3}, false};
          pose.numbers.insert(pose.numbers.end(), definition->orientation, definition->orientation + 4);
        }
      }
    }
  }

  void note_sequence(std::uint64_t publisher, std::uint64_t sequence) {
    received_.sequences.push_back(sequence);
    applied_[publisher] = std::max(applied_[publisher], sequence);
  }

  void fill_publishers() {
    publishers_.clear();
    sequences_.clear();
    silent_.clear();
    std::vector<std::string> names;
    for (const auto& [publisher, sequence] : applied_) {
      publishers_.push_back(publisher);
      sequences_.push_back(sequence - (missed_the_last ? 1 : 0));
      silent_.push_back(0);
      names.push_back("publisher");
    }
    states_.assign(applied_.size(), hold_publisher_lost ? 2 : 0);
    if (busy_ns > 0) {
      publishers_.push_back(wire_contract::kPublisherBusyWorld);
      sequences_.push_back(0);
      silent_.push_back(busy_ns);
      states_.push_back(0);
      names.emplace_back();
    }
    names_ = wire_contract::pack_names(names);
    dds::borrow(status->publishers, publishers_);
    dds::borrow(status->applied_sequences, sequences_);
    dds::borrow(status->silent_ns, silent_);
    dds::borrow(status->publisher_states, states_);
    dds::borrow(status->publisher_names, names_);
  }

  void take_queries(const dds::Taker<wire::Query>& taker) {
    while (taker.take(query_)) {
      if (!query_.info().valid_data || !answering) { continue; }
      const auto kind = static_cast<wire_contract::QuestionKind>(query_->kind);
      const std::string only = query_->only;
      if (kind == wire_contract::QuestionKind::hello) {
        const std::lock_guard lock(mutex);
        hellos_.push_back({query_->client, query_->request});
        continue;
      }
      {
        const std::lock_guard lock(mutex);
        query_chunks_.push_back(wire::question_count(*query_).value_or(0));
        last_query_ = *query_;
        forget_questions(last_query_);
        last_query_.blob = {};
      }
      if (only == "silent") { continue; }
      most_in_flight_ = std::max<std::size_t>(most_in_flight_.load(), 1 + delayed_count_);
      if (delay_us > 0 || only == "late") {
        dds::Sample<wire::Query> copy;
        std::swap(copy, query_);
        const std::lock_guard lock(mutex);
        delayed_.push_back(std::move(copy));
        ++delayed_count_;
      } else {
        answer(query_);
      }
    }
  }

  void answer(const dds::Sample<wire::Query>& query) {
    dds::Writer<wire::Reply>* const writer = reply_writer(query->client);
    if (writer == nullptr) { return; }
    if (static_cast<wire_contract::QuestionKind>(query->kind) == wire_contract::QuestionKind::command) {
      answer_command(*query, *writer);
    } else {
      answer_questions(*query, *writer);
    }
  }

  static void start_reply(wire::Reply& reply, const wire::Query& query, std::uint64_t server) {
    reply = {};
    reply.client = query.client;
    reply.request = query.request;
    reply.chunk_index = query.chunk_index;
    reply.chunk_count = query.chunk_count;
    reply.first_question = query.first_question;
    reply.server = server;
    reply.epoch = 100 + server;
    reply.version = 5;
  }

  void answer_questions(const wire::Query& query, dds::Writer<wire::Reply>& writer) {
    const auto points = dds::view(query.points);
    Lists& lists = lists_;
    lists.clear();
    for (std::size_t i = 0; i < points.size(); i += 3) { lists.add(points[i]); }
    start_reply(reply_, query, server_);
    reply_.oldest_pose_age_ns = -1;
    reply_.compute_ns = 100;
    const std::string only = query.only;
    if (only == "refuse") {
      reply_.status = static_cast<std::uint8_t>(wire_contract::ReplyStatus::refused);
      dds::borrow(reply_.text, kRefusal);
    } else if (only == "busy" && busy_count_++ < 3) {
      reply_.status = static_cast<std::uint8_t>(wire_contract::ReplyStatus::refused);
      dds::borrow(reply_.text, kBusy);
    } else {
      lists.put_in(reply_);
    }
    if (only == "nonsense") { reply_.hit_counts._length = 0; }
    static_cast<void>(writer.write(reply_));
    if (only == "twice") { static_cast<void>(writer.write(reply_)); }
  }

  // On a thread of its own: the receive thread must not sleep, or nothing lost is sent again meanwhile.
  void load(const wire::Query& query, dds::Writer<wire::Reply>& writer) const {
    wire::Reply reply;
    start_reply(reply, query, server_);
    for (const char* const word : {R"({"fraction":0.25})", R"({"fraction":0.5})", R"({"fraction":0.75})"}) {
      std::this_thread::sleep_for(std::chrono::milliseconds(250));
      const std::string_view text(word);
      const std::vector<std::uint8_t> bytes(text.begin(), text.end());
      dds::borrow(reply.text, bytes);
      reply.status = static_cast<std::uint8_t>(wire_contract::ReplyStatus::progress);
      static_cast<void>(writer.write(reply));
    }
    const std::string_view text = R"({"scene":"warehouse"})";
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    dds::borrow(reply.text, bytes);
    reply.status = static_cast<std::uint8_t>(wire_contract::ReplyStatus::ok);
    static_cast<void>(writer.write(reply));
  }

  std::optional<std::string> answer_to_come(const std::string& text) {
    const std::lock_guard lock(mutex);
    commands_.push_back(text);
    if (answers_to_come_.empty()) return std::nullopt;
    std::string answer = std::move(answers_to_come_.front());
    answers_to_come_.pop_front();
    return answer;
  }

  // What was to come, else "long": a text in three chunks, the last first. "load": three words of progress, 250 ms apart.
  // "left_out", of a publisher: nothing. Else an echo.
  void answer_command(const wire::Query& query, dds::Writer<wire::Reply>& writer) {
    const std::string text = query.text;
    const auto send = [&](std::string_view part, std::uint32_t index, std::uint32_t count, std::uint8_t status_code) {
      start_reply(reply_, query, server_);
      reply_.chunk_index = index;
      reply_.chunk_count = count;
      reply_.status = status_code;
      const std::vector<std::uint8_t> bytes(part.begin(), part.end());
      dds::borrow(reply_.text, bytes);
      static_cast<void>(writer.write(reply_));
    };
    if (const std::optional<std::string> told = answer_to_come(text)) {
      send(*told, 0, 1, 0);
    } else if (text.find("\"long\"") != std::string::npos) {
      const std::string part(200'000, 'x');
      send("\"}", 2, 3, 0);
      send(part, 1, 3, 0);
      send("{\"answer\":\"" + part, 0, 3, 0);
    } else if (text.find("\"load\"") != std::string::npos) {
      wire::Query header = query;
      forget_questions(header);
      header.blob = {};
      slow_ = std::thread([this, header, &writer] { load(header, writer); });
    } else if (text.find("\"left_out\"") != std::string::npos) {
      send(R"({"objects":[]})", 0, 1, 0);
    } else if (text.find("\"refuse\"") != std::string::npos) {
      send(std::string_view(reinterpret_cast<const char*>(kRefusal.data()), kRefusal.size()), 0, 1, 1);
    } else {
      send(text.substr(0, text.size() - 1) + ",\"blob\":" + std::to_string(query.blob._length) + "}", 0, 1, 0);
    }
  }

  dds::Writer<wire::Reply>* reply_writer(std::uint64_t client) {
    const std::lock_guard lock(writers_mutex_);
    const auto found = reply_writers_.find(client);
    return found == reply_writers_.end() ? nullptr : found->second.get();
  }

  // Beats, greets and answers what is delayed: creating a writer does not belong into a callback.
  void help() {
    auto next_beat = std::chrono::steady_clock::now();
    while (!ending_) {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
      if (beating && std::chrono::steady_clock::now() >= next_beat) {
        next_beat += std::chrono::nanoseconds(wire_contract::kStatusPeriodNs);
        send_status();
      }
      greet();
      answer_delayed();
    }
  }

  void greet() {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> hellos;
    {
      const std::lock_guard lock(mutex);
      std::swap(hellos, hellos_);
    }
    for (const auto& [client, request] : hellos) {
      dds::Writer<wire::Reply>* writer = reply_writer(client);
      if (writer == nullptr) {
        auto made = std::make_unique<dds::Writer<wire::Reply>>(
            reply_topic_, dds::WriterOptions{.partition = wire_contract::reply_partition(client)});
        writer = made.get();
        const std::lock_guard lock(writers_mutex_);
        reply_writers_[client] = std::move(made);
      }
      dds::Sample<wire::Reply> reply;
      reply->client = client;
      reply->request = request;
      reply->chunk_count = 1;
      reply->server = server_;
      reply->epoch = 100 + server_;
      static_cast<void>(writer->write(*reply));
    }
  }

  void answer_delayed() {
    std::deque<dds::Sample<wire::Query>> due;
    {
      const std::lock_guard lock(mutex);
      std::deque<dds::Sample<wire::Query>> kept;
      for (auto& query : delayed_) {
        const bool waits = std::string_view(query->only) == "late" && !release_late_;
        (waits ? kept : due).push_back(std::move(query));
      }
      std::swap(delayed_, kept);
    }
    for (const auto& query : due) {
      std::this_thread::sleep_for(std::chrono::microseconds(delay_us));
      --delayed_count_;  // before the answer, which lets the client send the next one
      answer(query);
    }
  }

  struct Lists {
    std::vector<std::uint8_t> answers, reasons, levels, hit_flags;
    std::vector<std::uint32_t> hit_counts, nodes, exact_tests, triangles;
    std::vector<std::uint64_t> objects;
    std::vector<double> numbers, columns;
    std::vector<std::uint64_t> named_ids{kWall};
    std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"wall"});

    void clear() {
      for (auto* list : {&answers, &reasons, &levels, &hit_flags}) { list->clear(); }
      for (auto* list : {&hit_counts, &nodes, &exact_tests, &triangles}) { list->clear(); }
      objects.clear();
      numbers.clear();
    }
    void add(double x) {
      const bool hit = x >= 0;
      answers.push_back(hit ? 1 : 0);
      reasons.push_back(0);
      levels.push_back(1);
      hit_counts.push_back(hit ? 1 : 0);
      nodes.push_back(12);
      exact_tests.push_back(2);
      if (hit) {
        objects.push_back(kWall);
        triangles.push_back(118);
        hit_flags.push_back(wire_contract::kHitInside);
        for (const double number : {x, 4.4e-16, 2 * x, 1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 0.25, 0.25, 0.5, 8.8e-16}) {
          numbers.push_back(number);
        }
      }
    }
    void put_in(wire::Reply& reply) {
      dds::borrow(reply.answers, answers);
      dds::borrow(reply.reasons, reasons);
      dds::borrow(reply.levels, levels);
      dds::borrow(reply.hit_counts, hit_counts);
      dds::borrow(reply.nodes, nodes);
      dds::borrow(reply.exact_tests, exact_tests);
      dds::borrow(reply.objects, objects);
      dds::borrow(reply.triangles, triangles);
      dds::borrow(reply.hit_flags, hit_flags);
      wire::lend_columns<wire::Reply>(numbers, wire::kHitColumns, columns, reply);
      dds::borrow(reply.named_ids, named_ids);
      dds::borrow(reply.names, names);
    }
  };

  static inline const std::vector<std::uint8_t> kBusy = [] {
    const std::string text = R"({"error":"there is no room for it now","retry_after_ms":100})";
    return std::vector<std::uint8_t>(text.begin(), text.end());
  }();
  static inline const std::vector<std::uint8_t> kRefusal = [] {
    const std::string text = R"({"error":"'box' against 'octree' is not supported","hint":"collide plan"})";
    return std::vector<std::uint8_t>(text.begin(), text.end());
  }();

  std::uint64_t server_;
  std::atomic<bool> ending_{false};
  std::atomic<bool> release_late_{false};
  std::atomic<std::size_t> delayed_count_{0};
  std::atomic<std::size_t> most_in_flight_{0};
  Received received_;
  std::map<std::uint64_t, std::uint64_t> applied_;
  std::vector<std::uint64_t> publishers_;
  std::vector<std::uint64_t> sequences_;
  std::vector<std::int64_t> silent_;
  std::vector<std::uint8_t> states_;
  std::vector<std::uint8_t> names_;
  std::deque<std::string> answers_to_come_;
  std::vector<std::string> commands_;
  std::vector<std::uint32_t> query_chunks_;
  wire::Query last_query_{};
  std::vector<std::pair<std::uint64_t, std::uint64_t>> hellos_;
  std::deque<dds::Sample<wire::Query>> delayed_;
  dds::Sample<wire::Query> query_;
  wire::Reply reply_{};
  Lists lists_;
  std::mutex writers_mutex_;
  std::map<std::uint64_t, std::unique_ptr<dds::Writer<wire::Reply>>> reply_writers_;
  dds::Participant participant_;
  dds::Topic<wire::Query> query_topic_;
  dds::Topic<wire::Reply> reply_topic_;
  dds::Topic<wire::Status> status_topic_;
  dds::Topic<wire::Definition> object_topic_;
  dds::Topic<wire::PoseBatch> pose_topic_;
  dds::Topic<wire::EventFrame> event_topic_;
  dds::Topic<wire::EventFrame> persisted_topic_;
  dds::Topic<wire::ContactShard> contact_topic_;
  dds::Writer<wire::Status> status_writer_;
  dds::Writer<wire::EventFrame> event_writer_;
  dds::Writer<wire::EventFrame> persisted_writer_;
  dds::Writer<wire::ContactShard> contact_writer_;
  dds::Reader<wire::PoseBatch> pose_reader_;
  dds::Reader<wire::Definition> object_reader_;
  dds::Reader<wire::Query> query_reader_;
  std::thread helper_;
  int busy_count_ = 0;
  std::thread slow_;
};

}  // namespace collided::test
