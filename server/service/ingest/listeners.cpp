#include "server/service/ingest/listeners.hpp"

#include <new>

#include "server/service/ingest/decoding.hpp"
#include "server/service/runtime/out_of_memory.hpp"

namespace collided::engine::service {
namespace {

/// Ends the process where memory runs out in a callback: a taken sample does not come again, and no exception may pass
/// through DDS, which is C.
template <class Take>
void take_or_end(Take&& take) {
  try {
    take();
  } catch (const std::bad_alloc&) { end_out_of_memory("samples that come in"); }
}

}  // namespace

void PublisherLiveliness::heard(std::uint64_t writer, std::uint64_t publisher) {
  const std::lock_guard lock(mutex_);
  publishers_[writer] = publisher;
}

void PublisherLiveliness::liveliness(const dds::Liveliness& change) {
  const std::lock_guard lock(mutex_);
  const bool alive = change.alive > alive_;
  // A writer whose lease ran out counts as not alive and may return under the same handle; one that is gone counts as
  // neither.
  const bool is_gone = !alive && change.not_alive <= not_alive_;
  alive_ = change.alive;
  not_alive_ = change.not_alive;
  const auto found = publishers_.find(change.last_writer);
  if (found == publishers_.end()) return;
  inbox_.push(WriterNews{.publisher = found->second, .kind = kind_, .alive = alive});
  // DDS names only the last of several changes at once, so some writers that are gone stay in the map; its size is
  // bounded by dropping silent ones too.
  constexpr std::size_t kMost = 10'000;
  if (is_gone || (!alive && publishers_.size() > kMost)) publishers_.erase(found);
}

void PublisherLiveliness::lost(std::uint64_t publisher) {
  inbox_.push(WriterNews{.publisher = publisher, .kind = kind_, .alive = false});
}

Listeners::Listeners(const dds::Participant& participant, const std::string& name_space, const WorldClock& clock,
                     Inbox& inbox, Answering& answering, FlightRecorder* flight)
    : clock_(clock),
      inbox_(inbox),
      flight_(flight),
      object_writers_(inbox, WriterKind::object),
      pose_writers_(inbox, WriterKind::pose),
      object_topic_(participant, name_space),
      pose_topic_(participant, name_space),
      query_topic_(participant, name_space),
      object_reader_(
          object_topic_,
          {.data = [this](dds::Taker<wire::Definition> taker) { take_or_end([&] { take_definitions(taker); }); },
           .liveliness =
               [this](const dds::Liveliness& change) { take_or_end([&] { object_writers_.liveliness(change); }); }}),
      pose_reader_(
          pose_topic_,
          {.data = [this](dds::Taker<wire::PoseBatch> taker) { take_or_end([&] { take_poses(taker); }); },
           .liveliness =
               [this](const dds::Liveliness& change) { take_or_end([&] { pose_writers_.liveliness(change); }); }}),
      query_reader_(query_topic_, {.data = [&answering](dds::Taker<wire::Query> taker) {
                      take_or_end([&] { answering.listen(taker); });
                    }}) {}

void Listeners::take_left_definitions() {
  if (definitions_left_.exchange(false)) take_definitions(object_reader_.taker());
}

void Listeners::take_definitions(const dds::Taker<wire::Definition>& taker) {
  const std::lock_guard lock(taking_definitions_);
  while (true) {
    // What is left with DDS is taken by take_left_definitions() later.
    if (!inbox_.has_room_for_definitions()) {
      definitions_left_.store(true);
      return;
    }
    const auto loans = taker.take_loans();
    if (loans.size() == 0) return;
    for (std::size_t i = 0; i < loans.size(); ++i) {
      if (!loans.info(i).valid_data) continue;
      if (flight_) flight_->note(recording::Recorded::object, loans[i], loans.info(i).source_timestamp);
      object_writers_.heard(loans.info(i).publication_handle, loans[i].publisher);
      inbox_.push(decoded(loans[i]));
    }
  }
}

void Listeners::take_poses(const dds::Taker<wire::PoseBatch>& taker) {
  while (true) {
    const auto loans = taker.take_loans();
    if (loans.size() == 0) return;
    const std::int64_t now_ns = clock_.now_ns();
    for (std::size_t i = 0; i < loans.size(); ++i) {
      if (loans.info(i).valid_data) {
        if (flight_) flight_->note(recording::Recorded::pose, loans[i], loans.info(i).source_timestamp);
        pose_writers_.heard(loans.info(i).publication_handle, loans[i].publisher);
        std::unique_ptr<PoseSample> sample = inbox_.spare();
        decode(loans[i], *sample);
        sample->received_ns = now_ns;
        inbox_.push(std::move(sample));
      }
      // The topic's key is the publisher, so an instance without writers is a publisher that has gone.
      if (loans.info(i).instance_state == DDS_NOT_ALIVE_NO_WRITERS_INSTANCE_STATE)
        pose_writers_.lost(loans[i].publisher);
    }
  }
}

}  // namespace collided::engine::service
