#include "client/library/recordings/recorded_run.hpp"
#include "client/library/recordings/replay_times.hpp"
#include "idl/mcap/writer.hpp"
#include "tests/fuzz/framed.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/service/wire/rows.hpp"

// A recording from anywhere. What cannot be replayed is refused with a sentence; what can keeps to its own bytes.

namespace {

using namespace collided;

class Memory : public mcap::Output {
 public:
  bool append(std::span<const std::byte> bytes) override {
    file.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return true;
  }
  const std::string& problem() const override { return problem_; }
  std::string file;

 private:
  std::string problem_;
};

template <class T>
void write(mcap::FileWriter& writer, recording::Recorded topic, std::uint64_t time, const T& sample) {
  std::vector<std::byte> bytes(wire::cdr_size(sample));
  wire::write_cdr(sample, bytes);
  writer.write(static_cast<std::uint16_t>(topic), time, time, bytes);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(reinterpret_cast<const std::byte*>(data),
                               reinterpret_cast<const std::byte*>(data) + size);
  client::RecordedRun run;
  try {
    run = client::read_run(std::move(bytes), "fuzz.mcap");
  } catch (const std::runtime_error& refused) {
    fuzz::require(std::string(refused.what()).ends_with("Nothing was replayed"), "an error says its consequence");
    return 0;
  }
  const std::byte* const first = run.bytes.data();
  for (const client::RecordedItem& item : run.items) {
    fuzz::require(item.data.data() >= first && item.data.data() + item.data.size() <= first + run.bytes.size(),
                  "messages lie in the file");
  }
  const client::ReplayTimes times = client::replay_times(run);
  fuzz::require(times.of.size() == run.items.size() && times.order.size() == run.items.size(),
                "each item has its time");
  for (const auto& [state, requests] : run.requests) {
    for (const client::RecordedRequest& request : requests) {
      fuzz::require(!request.questions.empty() && !request.replies.empty(), "a request has both");
      for (const std::size_t index : request.questions) {
        dds::Sample<wire::Query> query;
        fuzz::require(index < run.items.size() && wire::read_cdr(run.items[index].data, query),
                      "its questions are questions");
      }
    }
  }
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  using recording::Recorded;
  Memory memory;
  mcap::FileWriter writer(memory, "fuzz", recording::channels_of("a"));
  writer.metadata("recording", {{"opening_messages", "1"}});
  dds::Sample<wire::Definition> definition;
  definition->publisher = 7;
  definition->sequence_number = 1;
  write(writer, Recorded::object, 1, *definition);
  dds::Sample<wire::PoseBatch> batch;
  batch->publisher = 7;
  batch->sequence_number = 2;
  write(writer, Recorded::pose, 2, *batch);
  dds::Sample<wire::Query> query;
  query->client = query->request = query->chunk_count = 1;
  query->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::ray);
  const std::vector<double> ray{0, 0, 5, 0, 0, -1, 10};
  test::put_questions(*query, ray);
  write(writer, Recorded::query, 3, *query);
  dds::Sample<wire::Reply> reply;
  reply->client = reply->request = reply->chunk_count = 1;
  reply->version = 4;
  write(writer, Recorded::reply, 4, *reply);
  query->request = 2;
  query->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::command);
  static_cast<void>(dds::set_text(query->text, R"({"command":"add","name":"crate"})"));
  write(writer, Recorded::query, 5, *query);
  reply->request = 2;
  const std::string text = R"({"version":4})";
  const std::vector<std::uint8_t> answer(text.begin(), text.end());
  dds::borrow(reply->text, answer);
  write(writer, Recorded::reply, 6, *reply);
  dds::Sample<wire::Status> status;
  status->version = 4;
  const std::vector<std::uint64_t> publishers{7}, applied{2};
  const std::vector<std::uint8_t> states{0};
  dds::borrow(status->publishers, publishers);
  dds::borrow(status->applied_sequences, applied);
  dds::borrow(status->publisher_states, states);
  write(writer, Recorded::step, 7, *status);
  writer.close();
  // Without the schemas, which are most of it, mutations meet the rest more often.
  Memory small;
  std::vector<mcap::ChannelDescription> channels = recording::channels_of("a");
  for (mcap::ChannelDescription& channel : channels) channel.schema.clear();
  mcap::FileWriter short_writer(small, "fuzz", channels);
  write(short_writer, Recorded::query, 3, *query);
  write(short_writer, Recorded::reply, 4, *reply);
  write(short_writer, Recorded::status, 5, *status);
  short_writer.close();
  return {memory.file, small.file, small.file.substr(0, small.file.size() / 2)};
}
