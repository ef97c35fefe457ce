#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "idl/dds.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided::testing_support {

/// A client nobody wrote a library for: it speaks the wire and sends whatever it is told to.
class WireAsker {
 public:
  /// What of a reply the tests look at.
  struct Heard {
    std::uint64_t request = 0;
    std::uint8_t status = 0;
    std::uint32_t first_question = 0;
    std::uint64_t version = 0;
    std::vector<std::uint8_t> answers, reasons;
    std::vector<std::uint32_t> hit_counts, triangles;
    std::vector<std::uint64_t> objects;
    std::vector<double> numbers;
    std::string text;
  };

  /// process_domain  for a second one in this process (dds.hpp)
  explicit WireAsker(int domain, std::uint64_t client = 0x1234, std::optional<int> process_domain = {})
      : client_(client),
        participant_({.domain = domain, .process_domain = process_domain}),
        query_topic_(participant_, "collided"),
        reply_topic_(participant_, "collided"),
        status_topic_(participant_, "collided"),
        object_topic_(participant_, "collided"),
        pose_topic_(participant_, "collided"),
        reply_reader_(reply_topic_, {.data = [this](dds::Taker<wire::Reply> taker) { take(taker); },
                                     .partition = wire_contract::reply_partition(client)}),
        status_reader_(status_topic_),
        object_writer_(object_topic_, {.lease_ns = 60'000'000'000}),
        pose_writer_(pose_topic_, {.lease_ns = 60'000'000'000}),
        query_writer_(query_topic_) {}

  /// Until the server reads what this writes and its reply to a hello came.
  bool greet() {
    for (int i = 0; i < 250; ++i) {
      dds::Sample<wire::Query> hello;
      const bool met = query_writer_.matched_readers() > 0 && pose_writer_.matched_readers() > 0 &&
                       object_writer_.matched_readers() > 0 && status_reader_.matched_writers() > 0;
      if (met && ask(*hello, std::chrono::milliseconds(500))) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }
  /// Sends it as a request of its own; the first reply.
  std::optional<Heard> ask(wire::Query& query, std::chrono::milliseconds wait = std::chrono::seconds(5)) {
    send(query);
    return reply_to(query.request, wait);
  }
  void send(wire::Query& query) {
    query.client = client_;
    if (query.request == 0) query.request = ++requests_;
    if (query.chunk_count == 0) query.chunk_count = 1;
    // A reader that is full makes a write wait; on a busy machine longer than one write does.
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!query_writer_.write(query)) {
      if (std::chrono::steady_clock::now() > until) throw std::runtime_error("the server reads no questions");
    }
  }
  std::optional<Heard> reply_to(std::uint64_t request, std::chrono::milliseconds wait) {
    std::unique_lock lock(mutex_);
    std::optional<Heard> found;
    came_.wait_for(lock, wait, [&] {
      const auto place =
          std::find_if(heard_.begin(), heard_.end(), [&](const Heard& heard) { return heard.request == request; });
      if (place == heard_.end()) return false;
      found = std::move(*place);
      heard_.erase(place);
      return true;
    });
    return found;
  }
  /// The replies to one message of questions, by their first question: they may come in any order.
  using Replies = std::map<std::uint32_t, Heard>;
  /// Sends a message of so many questions; all its replies, or those that came in time.
  Replies ask_all(wire::Query& query, std::size_t question_count,
                  std::chrono::milliseconds wait = std::chrono::seconds(30)) {
    send(query);
    Replies replies;
    for (std::size_t answered = 0; answered < question_count;) {
      std::optional<Heard> heard = reply_to(query.request, wait);
      if (!heard) break;
      answered += heard->answers.size();
      const std::uint32_t first = heard->first_question;
      replies.emplace(first, std::move(*heard));
    }
    return replies;
  }
  /// As one reply. A question without an answer, or with two, leaves out what follows.
  static Heard whole(const Replies& replies) {
    Heard all;
    for (const auto& [first, part] : replies) {
      if (first != all.answers.size()) break;
      const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
      append(all.answers, part.answers);
      append(all.reasons, part.reasons);
      append(all.hit_counts, part.hit_counts);
      append(all.triangles, part.triangles);
      append(all.objects, part.objects);
      append(all.numbers, part.numbers);
    }
    return all;
  }
  /// Replies that nobody will ask for.
  void forget_replies() {
    const std::lock_guard lock(mutex_);
    heard_.clear();
  }
  void define(wire::Definition& definition) { write(object_writer_, definition); }
  void pose(wire::PoseBatch& batch) { write(pose_writer_, batch); }
  /// The next status that fulfils the condition.
  template <class Condition>
  bool status_becomes(Condition&& condition, std::chrono::milliseconds wait = std::chrono::seconds(5)) {
    const auto until = std::chrono::steady_clock::now() + wait;
    dds::Sample<wire::Status> status;
    while (std::chrono::steady_clock::now() < until) {
      while (status_reader_.take(status)) {
        if (status.info().valid_data && condition(*status)) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

 private:
  template <class T>
  static void write(dds::Writer<T>& writer, const T& sample) {
    if (!writer.write(sample)) throw std::runtime_error("the server does not read");
  }
  template <class Sequence>
  static auto copy(const Sequence& sequence) {
    const auto view = dds::view(sequence);
    return std::vector<std::remove_const_t<typename decltype(view)::element_type>>(view.begin(), view.end());
  }
  void take(const dds::Taker<wire::Reply>& taker) {
    while (taker.take(incoming_)) {
      if (!incoming_.info().valid_data) continue;
      const wire::Reply& r = *incoming_;
      const auto text = dds::view(r.text);
      const std::lock_guard lock(mutex_);
      heard_.push_back({r.request, r.status, r.first_question, r.version, copy(r.answers), copy(r.reasons),
                        copy(r.hit_counts), copy(r.triangles), copy(r.objects), collided::test::hits_of(r),
                        std::string(text.begin(), text.end())});
      came_.notify_all();
    }
  }

  const std::uint64_t client_;
  std::uint64_t requests_ = 0;
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<Heard> heard_;
  dds::Sample<wire::Reply> incoming_;
  dds::Participant participant_;
  dds::Topic<wire::Query> query_topic_;
  dds::Topic<wire::Reply> reply_topic_;
  dds::Topic<wire::Status> status_topic_;
  dds::Topic<wire::Definition> object_topic_;
  dds::Topic<wire::PoseBatch> pose_topic_;
  dds::Reader<wire::Reply> reply_reader_;
  dds::Reader<wire::Status> status_reader_;
  dds::Writer<wire::Definition> object_writer_;
  dds::Writer<wire::PoseBatch> pose_writer_;
  dds::Writer<wire::Query> query_writer_;
};

}  // namespace collided::testing_support
