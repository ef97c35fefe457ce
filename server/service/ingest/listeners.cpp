#include "server/service/ingest/listeners.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <new>
#include <set>
#include <utility>

#include "idl/peers.hpp"
#include "server/service/ingest/decoding.hpp"
#include "server/service/runtime/out_of_memory.hpp"

namespace collided::engine::service {
namespace {

/// Ends the process if memory runs out in a callback: a taken sample does not come again, and no exception may pass
/// through DDS, which is C.
template <class Take>
void take_or_end(Take&& take) {
  try {
    take();
  } catch (const std::bad_alloc&) { end_out_of_memory("samples that come in"); }
}

void drop_all(const dds::Taker<wire::Query>& taker) {
  while (taker.take_loans().size() > 0) {}
}

}  // namespace

bool PublisherLiveliness::admits(std::uint64_t handle, std::uint64_t publisher, FunctionRef<NumberOwner()> owner_of) {
  const std::lock_guard lock(mutex_);
  auto found = writers_.find(handle);
  if (found == writers_.end()) {
    NumberOwner owner = owner_of();
    // A writer that is gone owns nothing: its claim of a number would last for ever.
    if (owner.participant == 0) return false;
    found = writers_.emplace(handle, Writer{.owner = std::move(owner), .publishers = {}}).first;
  }
  Writer& writer = found->second;
  const bool is_known = std::ranges::find(writer.publishers, publisher) != writer.publishers.end();
  if (is_known && writer.is_alive) return true;
  if (!owners_.claim(publisher, writer.owner, handle)) return false;
  if (!is_known) writer.publishers.push_back(publisher);
  return true;
}

void PublisherLiveliness::let_go(std::uint64_t handle, const Writer& writer) {
  for (const std::uint64_t publisher : writer.publishers) {
    owners_.release(publisher, handle);
    inbox_.push(WriterNews{.publisher = publisher, .kind = kind_, .alive = false});
  }
}

void PublisherLiveliness::liveliness(const dds::Liveliness& change) {
  const std::lock_guard lock(mutex_);
  const bool alive = change.alive > alive_;
  // A writer whose lease ran out counts as not alive and may return under the same handle; a departed one counts as
  // neither.
  const bool is_gone = !alive && change.not_alive <= not_alive_;
  alive_ = change.alive;
  not_alive_ = change.not_alive;
  const auto found = writers_.find(change.last_writer);
  if (found == writers_.end()) return;
  Writer& writer = found->second;
  if (alive) {
    writer.is_alive = true;
    // Another participant may have acquired a number meanwhile.
    std::erase_if(writer.publishers,
                  [&](std::uint64_t publisher) { return !owners_.claim(publisher, writer.owner, change.last_writer); });
    for (const std::uint64_t publisher : writer.publishers)
      inbox_.push(WriterNews{.publisher = publisher, .kind = kind_, .alive = true});
    return;
  }
  writer.is_alive = false;
  let_go(change.last_writer, writer);
  if (is_gone) writers_.erase(found);
}

void PublisherLiveliness::keep_only(std::span<const std::uint64_t> matched) {
  const std::lock_guard lock(mutex_);
  const std::set<std::uint64_t> there(matched.begin(), matched.end());
  for (auto at = writers_.begin(); at != writers_.end();) {
    const auto here = at++;
    auto& [handle, writer] = *here;
    const bool is_missing = !there.contains(handle);
    // A writer that was first heard while the handles were listed is missing once, but not the next time.
    if (!std::exchange(writer.is_missed, is_missing) || !is_missing) continue;
    let_go(handle, writer);
    writers_.erase(here);
  }
}

void PublisherLiveliness::lost(std::uint64_t publisher) {
  inbox_.push(WriterNews{.publisher = publisher, .kind = kind_, .alive = false});
}

Listeners::Listeners(const dds::Participant& participant, const std::string& name_space, const WorldClock& clock,
                     Inbox& inbox, Answering& answering, FlightRecorder* flight, KeyedPeers* peers, const Place& place)
    : clock_(clock),
      inbox_(inbox),
      flight_(flight),
      peers_(peers),
      definers_(peers),
      posers_(peers),
      query_writers_(peers),
      object_writers_(inbox, owners_, WriterKind::object),
      pose_writers_(inbox, owners_, WriterKind::pose),
      object_topic_(participant, name_space),
      pose_topic_(participant, name_space),
      query_topic_(participant, place.asked_as()),
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
      query_reader_(query_topic_, {.data =
                                       [&answering, &place](dds::Taker<wire::Query> taker) {
                                         const bool listens = place.may_answer() || answering.holds();
                                         take_or_end([&] { listens ? answering.listen(taker) : drop_all(taker); });
                                       },
                                   // With keys, each right to send queries is a partition.
                                   .partition = peers == nullptr ? "" : "*"}) {
  // A callback before its reader existed has left the samples in it.
  has_readers_.store(true);
  take_definitions(object_reader_.taker());
  take_poses(pose_reader_.taker());
}

std::vector<std::uint64_t> Listeners::query_owners() {
  std::vector<std::uint64_t> owners = query_reader_.matched_writer_handles();
  if (peers_ == nullptr) return owners;
  for (std::uint64_t& owner : owners) owner = query_writers_.of(query_reader_.get(), owner).participant;
  return owners;
}

/// The owner of a writer of definitions or poses. With keys, a writer that has proved nothing owns nothing.
NumberOwner Listeners::owner_of(Participants& known, dds_entity_t reader, std::uint64_t writer) const {
  const QuerySender& from = known.of(reader, writer);
  if (peers_ == nullptr) return from.participant;
  return from.peer ? NumberOwner(from.participant, from.peer->name) : NumberOwner(0);
}

/// Why the writer's keys do not allow this object; empty: they do.
std::string Listeners::why_not_allowed(const wire::Definition& definition, std::uint64_t writer) {
  if (peers_ == nullptr || definition.removed) return {};
  const QuerySender& from = definers_.of(object_reader_.get(), writer);
  if (!from.peer) return "whoever publishes it has not proved who it is";
  if (from.peer->may_name(definition.name)) return {};
  return fmt::format("the keys of '{}' are for {}", from.peer->name, fmt::join(from.peer->objects, ", "));
}

void Listeners::drop_unmatched_writers() {
  object_writers_.keep_only(object_reader_.matched_writer_handles());
  pose_writers_.keep_only(pose_reader_.matched_writer_handles());
}

void Listeners::take_left_definitions() {
  if (definitions_left_.exchange(false)) take_definitions(object_reader_.taker());
}

void Listeners::take_definitions(const dds::Taker<wire::Definition>& taker) {
  const std::lock_guard lock(taking_definitions_);
  while (has_readers_.load()) {
    // take_left_definitions() later takes the definitions left with DDS.
    if (!inbox_.has_room_for_definitions()) {
      definitions_left_.store(true);
      return;
    }
    const auto loans = taker.take_loans();
    if (loans.size() == 0) return;
    for (std::size_t i = 0; i < loans.size(); ++i) {
      if (!loans.info(i).valid_data) continue;
      const std::uint64_t writer = loans.info(i).publication_handle;
      const auto owner = [&] { return owner_of(definers_, object_reader_.get(), writer); };
      if (!object_writers_.admits(writer, loans[i].publisher, owner)) continue;
      if (flight_) flight_->note(recording::Recorded::object, loans[i], loans.info(i).source_timestamp);
      std::unique_ptr<DefinitionSample> sample = decoded(loans[i]);
      sample->not_allowed = why_not_allowed(loans[i], writer);
      inbox_.push(std::move(sample));
    }
  }
}

void Listeners::take_poses(const dds::Taker<wire::PoseBatch>& taker) {
  const std::lock_guard lock(taking_poses_);
  while (has_readers_.load()) {
    const auto loans = taker.take_loans();
    if (loans.size() == 0) return;
    const std::int64_t now_ns = clock_.now_ns();
    for (std::size_t i = 0; i < loans.size(); ++i) {
      if (loans.info(i).valid_data) {
        const std::uint64_t writer = loans.info(i).publication_handle;
        const auto owner = [&] { return owner_of(posers_, pose_reader_.get(), writer); };
        if (pose_writers_.admits(writer, loans[i].publisher, owner)) {
          if (flight_) flight_->note(recording::Recorded::pose, loans[i], loans.info(i).source_timestamp);
          std::unique_ptr<PoseSample> sample = inbox_.spare();
          decode(loans[i], *sample);
          sample->received_ns = now_ns;
          inbox_.push(std::move(sample));
        }
      }
      // The topic's key is the publisher, so an instance without writers is a publisher that has gone.
      if (loans.info(i).instance_state == DDS_NOT_ALIVE_NO_WRITERS_INSTANCE_STATE)
        pose_writers_.lost(loans[i].publisher);
    }
  }
}

}  // namespace collided::engine::service
