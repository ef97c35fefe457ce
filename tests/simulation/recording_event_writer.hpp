#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "server/service/events/event_writer.hpp"
#include "server/service/events/untold_events.hpp"
#include "tests/simulation/record.hpp"

namespace collided::simulation {
using namespace engine;

/// speaks: what it writes is what watchers hear. is_silent: of a server that stands by. is_expected: what is to be told.
enum class Voice { speaks, is_silent, is_expected };

/// What a server writes, for the record; and the contract of events checked as it is written: no gap in the sequence,
/// began and ended alternate, every end has a reason and the episode that it ends, brackets are in order.
class RecordingEventWriter : public service::EventWriter {
 public:
  using Violation = std::function<void(const std::string&)>;
  RecordingEventWriter(std::uint64_t epoch, Voice voice, std::FILE* to, Violation violation)
      : epoch_(epoch), voice_(voice), to_(to), violation_(std::move(violation)) {}

  void set_time(std::int64_t now_ns) { now_ns_ = now_ns; }
  const std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint64_t>& open() const { return open_; }

  void fall_silent() override { voice_ = Voice::is_silent; }
  std::uint64_t speak(const service::SpokenBefore& before) override;
  bool contacts_wanted() const override { return true; }
  bool persisted_wanted() const override { return false; }
  bool probes_wanted() const override { return false; }
  void write_events(const service::EventColumns& events, const service::Stamp& stamp) override;
  void write_persisted(const service::EventColumns&, const service::Stamp&) override {}
  void write_probes(const service::ProbeColumns&, const service::Stamp&) override {}
  void write_contacts(const service::ContactColumns& contacts, const service::Stamp& stamp,
                      std::uint64_t as_of_sequence) override;
  void write_status(const service::StatusColumns& status) override;

 private:
  void check(const service::EventColumns& events, std::size_t i);
  template <class Columns>
  void put_columns(const Columns& columns);
  void write_frame(const service::EventColumns& events, const service::Stamp& stamp, bool is_again);

  std::uint64_t epoch_;
  Voice voice_;
  service::UntoldEvents<service::EventColumns> untold_;
  std::FILE* to_;
  Violation violation_;
  std::int64_t now_ns_ = 0;
  std::uint64_t last_sequence_ = 0;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint64_t> open_;  // pair to episode
  Payload payload_;
};

}  // namespace collided::simulation
