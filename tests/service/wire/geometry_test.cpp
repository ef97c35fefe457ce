// A long answer comes in pages of whatever the server says; only those that follow each other make an answer.
#include <gtest/gtest.h>

#include "collided/client.hpp"
#include "idl/geometry_generated.h"
#include "tests/service/wire/fake_server.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ClientPages : public testing::Test {
 protected:
  void SetUp() override {
    Result<Client> connected =
        Client::connect({.domain = test::own_domain(), .name_space = test::own_namespace(), .wait = 5s});
    ASSERT_TRUE(connected) << connected.error().message;
    client_.emplace(std::move(*connected));
  }
  static std::string text_of(const flatbuffers::FlatBufferBuilder& builder) {
    return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
  }
  static std::string page(std::uint64_t total, std::uint64_t first, const std::string& bytes,
                          std::uint64_t transfer = 9) {
    flatbuffers::FlatBufferBuilder builder;
    const std::vector<std::uint8_t> vector(bytes.begin(), bytes.end());
    builder.Finish(format::CreatePageDirect(builder, transfer, total, first, &vector));
    return text_of(builder);
  }
  static std::string no_objects() {
    flatbuffers::FlatBufferBuilder builder;
    const std::vector<flatbuffers::Offset<format::ShownObject>> objects;
    const auto list = builder.CreateVector(objects);
    format::ShownObjectsBuilder shown(builder);
    shown.add_epoch(3);
    shown.add_version(44);
    shown.add_table_version(5);
    shown.add_world_time_ns(6'000);
    shown.add_objects(list);
    builder.Finish(shown.Finish());
    return text_of(builder);
  }
  std::string refusal(std::deque<std::string> pages) {
    server_.will_answer(std::move(pages));
    const Result<ShownObjects> shown = client_->shapes({});
    return shown ? "taken" : shown.error().message;
  }
  test::FakeServer server_{test::own_namespace()};
  std::optional<Client> client_;
};

TEST_F(ClientPages, ArePutTogetherAndAskedForFromWhereTheLastOneEnded) {
  const std::string whole = no_objects();
  const std::uint64_t size = whole.size();
  server_.will_answer(
      {page(size, 0, whole.substr(0, 10)), page(size, 10, whole.substr(10, 1)), page(size, 11, whole.substr(11))});
  const Result<ShownObjects> shown = client_->shapes({});
  ASSERT_TRUE(shown) << shown.error().message;
  EXPECT_EQ(shown->epoch, 3U);
  EXPECT_EQ(shown->version, 44U);
  EXPECT_EQ(shown->table_version, 5U);
  EXPECT_EQ(shown->world_time, 6us);
  EXPECT_TRUE(shown->objects.empty());
  const std::vector<std::string> asked = server_.commands();
  ASSERT_EQ(asked.size(), 3U);
  EXPECT_EQ(asked[0], R"({"command":"shapes","mask":4294967295,"only":"","skip":""})");
  EXPECT_EQ(asked[1], R"({"command":"more","first":10,"transfer":9})");
  EXPECT_EQ(asked[2], R"({"command":"more","first":11,"transfer":9})");
}

TEST_F(ClientPages, ThatDoNotFollowEachOtherAreRefused) {
  const std::string whole = no_objects();
  const std::uint64_t size = whole.size();
  const std::string start = whole.substr(0, 10), rest = whole.substr(10);
  const std::string unfit = "shapes: the server's answer does not fit: its pages do not follow each other";
  EXPECT_EQ(refusal({page(size, 1, whole)}), unfit) << "begins behind the beginning";
  EXPECT_EQ(refusal({page(size - 1, 0, whole)}), unfit) << "more than it has";
  EXPECT_EQ(refusal({page(size, 0, start), page(size, 11, rest)}), unfit) << "a gap";
  EXPECT_EQ(refusal({page(size, 0, start), page(size, 9, rest)}), unfit) << "an overlap";
  EXPECT_EQ(refusal({page(size, 0, start), page(size, 10, rest + "x")}), unfit) << "one byte too many";
  EXPECT_EQ(refusal({page(size, 0, start), page(size, 10, "")}), unfit) << "would never end";
  EXPECT_EQ(refusal({page(size, 0, start), page(size + 1, 10, rest)}), unfit) << "another length";
  EXPECT_EQ(refusal({page((std::uint64_t{1} << 30) + 1, 0, start)}), unfit) << "more than anybody tells";
  EXPECT_NE(refusal({"no page"}), "taken");
}

// What it was telling has gone meanwhile: asked anew, five times in all.
TEST_F(ClientPages, AnAnswerThatIsForgottenIsAskedForAgain) {
  const std::string whole = no_objects();
  const std::string gone = page(0, 0, "");
  EXPECT_EQ(refusal({gone, gone, gone, gone, page(whole.size(), 0, whole)}), "taken");
  EXPECT_EQ(server_.commands().size(), 5U);
  EXPECT_EQ(refusal({page(whole.size(), 0, whole.substr(0, 10)), gone, page(whole.size(), 0, whole)}), "taken");
  EXPECT_EQ(refusal({gone, gone, gone, gone, gone, page(whole.size(), 0, whole)}),
            "shapes: the server forgot what it was telling, 5 times");
}

}  // namespace
}  // namespace collided
