#include <gtest/gtest.h>

#include <dds/ddsi/ddsi_serdata.h>

#include <cstring>
#include <random>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/messages.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/wire/network.hpp"

namespace collided {
namespace {

using test::eventually;

/// Fills a sample with anything that its type can hold; sequences are empty as often as not, since padding differs there.
class Filler {
 public:
  explicit Filler(std::mt19937_64& random) : random_(random) {}

  template <class Number>
  requires std::is_arithmetic_v<Number>
  void operator()(Number& number) {
    if constexpr (std::is_same_v<Number, bool>) number = random_() % 2 == 1;
    else if constexpr (std::is_same_v<Number, double>) number = std::ldexp(static_cast<double>(random_()), -40);
    else number = static_cast<Number>(random_());
  }
  template <std::size_t kRoom>
  void operator()(char (&text)[kRoom]) {
    const std::size_t length = random_() % std::min<std::size_t>(kRoom, 40);
    for (std::size_t i = 0; i < length; ++i) text[i] = static_cast<char>('a' + random_() % 26);
    text[length] = 0;
  }
  template <std::size_t kCount>
  void operator()(double (&numbers)[kCount]) {
    for (double& number : numbers) (*this)(number);
  }
  template <class S>
  requires requires(S& s) { s._buffer; }
  void operator()(S& sequence) {
    using Element = std::remove_pointer_t<decltype(sequence._buffer)>;
    const auto length = static_cast<std::uint32_t>(random_() % 2 == 0 ? 0 : random_() % 9);
    if (sequence._release) dds_free(sequence._buffer);
    sequence._buffer = static_cast<Element*>(dds_alloc(sizeof(Element) * std::max(length, 1U)));
    for (std::uint32_t i = 0; i < length; ++i) (*this)(sequence._buffer[i]);
    sequence._length = sequence._maximum = length;
    sequence._release = true;
  }

 private:
  std::mt19937_64& random_;
};

template <class T>
std::vector<std::byte> cdr_of(const T& sample) {
  std::vector<std::byte> bytes(wire::cdr_size(sample));
  wire::write_cdr(sample, bytes);
  return bytes;
}

/// The bytes in which the DDS library keeps a sample that it received.
std::vector<std::byte> take_as_bytes(dds_entity_t reader) {
  ddsi_serdata* data = nullptr;
  dds_sample_info_t info;
  if (dds_takecdr(reader, &data, 1, &info, DDS_ANY_STATE) <= 0) return {};
  std::vector<std::byte> bytes(ddsi_serdata_size(data));
  ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
  ddsi_serdata_unref(data);
  return bytes;
}

template <class T>
class WireCdr : public ::testing::Test {};
using WireTypes =
    ::testing::Types<wire::Definition, wire::PoseBatch, wire::Query, wire::Reply, wire::EventFrame, wire::ContactShard,
                     wire::StandingFrame, wire::StandingShard, wire::ProbeFrame, wire::Status>;
TYPED_TEST_SUITE(WireCdr, WireTypes);

// Field by field and padding by padding, from a reader on the other side of the network stack.
TYPED_TEST(WireCdr, BytesAreThoseOfTheDdsLibrary) {
  std::mt19937_64 random = oracle::seeded(20);
  Filler filler(random);
  dds::Participant here(test::near_side());
  dds::Participant there(test::far_side());
  dds::Topic<TypeParam> topic(here, test::own_namespace()), far_topic(there, test::own_namespace());
  dds::Reader<TypeParam> reader(far_topic);
  dds::Writer<TypeParam> writer(topic);
  ASSERT_TRUE(eventually([&] { return writer.matched_readers() == 1; }));
  for (int round = 0; round < 50; ++round) {
    dds::Sample<TypeParam> sample;
    wire::for_each_field(*sample, filler);
    ASSERT_TRUE(writer.write(*sample));
    std::vector<std::byte> theirs;
    ASSERT_TRUE(eventually([&] { return !(theirs = take_as_bytes(reader.get())).empty(); }));
    ASSERT_EQ(cdr_of(*sample), theirs) << "round " << round;
    dds::Sample<TypeParam> again;
    ASSERT_TRUE(wire::read_cdr(std::span<const std::byte>(theirs), again));
    ASSERT_EQ(cdr_of(*again), theirs) << "round " << round;
  }
}

// No prefix is a sample, however short.
TYPED_TEST(WireCdr, CutBytesAreRefused) {
  dds::Sample<TypeParam> sample;
  std::mt19937_64 random = oracle::seeded(21);
  Filler filler(random);
  wire::for_each_field(*sample, filler);
  const std::vector<std::byte> bytes = cdr_of(*sample);
  for (std::size_t size = 0; size + 4 <= bytes.size(); ++size) {
    dds::Sample<TypeParam> cut;
    EXPECT_FALSE(wire::read_cdr(std::span(bytes).first(size), cut)) << size << " of " << bytes.size();
  }
}

TEST(WireCdrBorder, WhatNoSampleHoldsIsRefused) {
  dds::Sample<wire::Definition> sample;
  ASSERT_TRUE(dds::set_text(sample->name, "crate"));
  const std::vector<std::byte> good = cdr_of(*sample);
  dds::Sample<wire::Definition> read;
  ASSERT_TRUE(wire::read_cdr(std::span(good), read));
  const auto with = [&](std::size_t at, int value) {
    std::vector<std::byte> bytes = good;
    bytes[at] = static_cast<std::byte>(value);
    return bytes;
  };
  constexpr std::size_t kRemoved = 4 + 32, kPublisherName = 4 + 36, kName = kPublisherName + 8;
  EXPECT_FALSE(wire::read_cdr(std::span<const std::byte>(with(kRemoved, 2)), read)) << "a truth of 2";
  EXPECT_FALSE(wire::read_cdr(std::span<const std::byte>(with(1, 0)), read)) << "big-endian";
  EXPECT_FALSE(wire::read_cdr(std::span<const std::byte>(with(kName + 3, 0x7f)), read)) << "a text of 2 GB";
  EXPECT_FALSE(wire::read_cdr(std::span<const std::byte>(with(kName + 4 + 5, 'x')), read)) << "a text without its zero";
  EXPECT_FALSE(wire::read_cdr(std::span<const std::byte>(with(kName + 4 + 2, 0)), read)) << "a text with a zero within";
  std::vector<std::byte> longer = good;
  longer.resize(good.size() + 4);
  EXPECT_FALSE(wire::read_cdr(std::span<const std::byte>(longer), read)) << "bytes left over";
}

}  // namespace
}  // namespace collided
