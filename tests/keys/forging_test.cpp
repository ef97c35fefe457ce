// The server tells participants apart by their GUIDs. Whoever has keys of the same authority must not be able to take
// another's.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/keys/key_folders.hpp"
#include "tests/service/eventually.hpp"
#include "tests/service/wire/network.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using keys::KeyRole;

/// A publisher's program that writes a batch again and again.
class Intruder {
 public:
  Intruder(const std::string& keys, const std::string& handshake)
      : participant_({.domain = test::own_domain(), .keys = keys, .handshake = handshake, .process_domain = 1}),
        topic_(participant_, test::own_namespace()),
        writer_(topic_) {
    batch_->publisher = 7;
  }
  void write() {
    ++batch_->sequence_number;
    static_cast<void>(writer_.write(*batch_));
  }

 private:
  dds::Participant participant_;
  dds::Topic<wire::PoseBatch> topic_;
  dds::Writer<wire::PoseBatch> writer_;
  dds::Sample<wire::PoseBatch> batch_;
};

/// The server's side: how many samples of others it gets within `patience` from one that joins.
class Forging : public testing::Test {
 protected:
  std::size_t accepted(const std::string& keys, const std::string& handshake, std::chrono::milliseconds patience,
                       const std::string& server_handshake = COLLIDED_HANDSHAKE) {
    const dds::Participant server({.domain = test::own_domain(),
                                   .role = dds::Role::server,
                                   .keys = folders_.of("brain", {KeyRole::server}),
                                   .handshake = server_handshake});
    const dds::Topic<wire::PoseBatch> topic(server, test::own_namespace());
    dds::Reader<wire::PoseBatch> reader(topic);
    Intruder intruder(keys, handshake);
    std::size_t count = 0;
    dds::Sample<wire::PoseBatch> sample;
    test::eventually(
        [&] {
          intruder.write();
          while (reader.take(sample)) count += sample.info().valid_data ? 1 : 0;
          std::this_thread::sleep_for(5ms);
          return count > 0;
        },
        patience);
    return count;
  }

  /// With keys of its own and the beginning of robot1's GUID.
  std::size_t accepted_forged(bool lies_in_handshake, const std::string& server_handshake = COLLIDED_HANDSHAKE) {
    const auto victim = folders_.of("robot1", {KeyRole::publisher});
    const auto facts = keys::facts_of(keys::read_key_file(victim + '/' + keys::kCertificate), victim);
    void* const library = dlopen(COLLIDED_FORGING_HANDSHAKE, RTLD_NOW);
    const auto forge = reinterpret_cast<void (*)(const std::uint8_t*, bool)>(dlsym(library, "collided_forge"));
    forge(facts.guid_beginning.data(), lies_in_handshake);
    return accepted(folders_.of("mallory", {KeyRole::publisher}), COLLIDED_FORGING_HANDSHAKE, 3s, server_handshake);
  }

  test::KeyFolders folders_;
};

TEST_F(Forging, HonestKeysAreAccepted) {
  EXPECT_GT(accepted(folders_.of("robot1", {KeyRole::publisher}), "", 10s), 0U);
}

TEST_F(Forging, AGuidThatDoesNotFitItsCertificateIsRefused) { EXPECT_EQ(accepted_forged(false), 0U); }

// What the handshake says fits the certificate; only the packets come from another GUID.
TEST_F(Forging, AGuidThatTheHandshakeHidesIsRefused) { EXPECT_EQ(accepted_forged(true), 0U); }

// So it is the server's own check that refuses it, and the forger forges well. Where this fails, DDS has learnt to look,
// and idl/dds_handshake_library.cpp need not compare any more.
TEST_F(Forging, DdsAloneWouldAcceptIt) { EXPECT_GT(accepted_forged(true, ""), 0U); }

}  // namespace
}  // namespace collided
