// C, because Cyclone's header of a domain does not compile as C++.
#include "idl/dds_builtin_guard.h"

#include <dds/ddsi/ddsi_domaingv.h>
#include <dds/ddsi/ddsi_proxy_participant.h>
#include <dds/ddsi/ddsi_serdata_plist.h>
#include <dds/ddsi/ddsi_serdata_pserop.h>
#include <dds/ddsi/q_bswap.h>
#include <dds/ddsi/q_rtps.h>
#include <dds/ddsrt/bswap.h>
#include <dds/ddsrt/endian.h>
#include <string.h>

static const int32_t kMaxLease_s = 30;

// Shared by all domains. This library is never unloaded, so Cyclone may call them as long as a domain lives.
static struct ddsi_serdata_ops message_ops;
static struct ddsi_serdata_ops announcement_ops;
static collided_judge_participant judge_participant;

static struct ddsi_serdata* message_from_ser(const struct ddsi_sertype* type, enum ddsi_serdata_kind kind,
                                             const struct nn_rdata* fragments, size_t byte_count) {
  return kind == SDK_DATA ? ddsi_serdata_ops_pserop.from_ser(type, kind, fragments, byte_count) : NULL;
}

static struct ddsi_serdata* message_from_keyhash(const struct ddsi_sertype* type, const struct ddsi_keyhash* keyhash) {
  (void)type;
  (void)keyhash;
  return NULL;
}

/// The value of a parameter, or null. Cyclone refuses announcements with a duplicate of these parameters.
static void* find_parameter(struct ddsi_serdata_plist* announcement, nn_parameterid_t id, size_t byte_count) {
  void* value = NULL;
  size_t found_byte_count = 0;
  const dds_return_t code = ddsi_plist_findparam_checking(announcement->data, announcement->pos,
                                                          announcement->identifier, id, &value, &found_byte_count);
  return code == DDS_RETCODE_OK && found_byte_count == byte_count ? value : NULL;
}

static void shorten_lease(struct ddsi_serdata_plist* announcement) {
  int32_t seconds_and_fraction[2];
  void* const lease = find_parameter(announcement, PID_PARTICIPANT_LEASE_DURATION, sizeof seconds_and_fraction);
  if (lease == NULL) return;
  memcpy(seconds_and_fraction, lease, sizeof seconds_and_fraction);
  const bool is_swapped = announcement->identifier != (DDSRT_ENDIAN == DDSRT_LITTLE_ENDIAN ? PL_CDR_LE : PL_CDR_BE);
  const int32_t seconds = is_swapped ? ddsrt_bswap4(seconds_and_fraction[0]) : seconds_and_fraction[0];
  if (seconds < kMaxLease_s) return;
  seconds_and_fraction[0] = is_swapped ? ddsrt_bswap4(kMaxLease_s) : kMaxLease_s;
  seconds_and_fraction[1] = 0;
  memcpy(lease, seconds_and_fraction, sizeof seconds_and_fraction);
}

static struct ddsi_serdata* announcement_from_ser(const struct ddsi_sertype* type, enum ddsi_serdata_kind kind,
                                                  const struct nn_rdata* fragments, size_t byte_count) {
  struct ddsi_serdata* const made = ddsi_serdata_ops_plist.from_ser(type, kind, fragments, byte_count);
  if (made == NULL) return NULL;
  made->ops = &ddsi_serdata_ops_plist;  // Cyclone recognizes parameter lists by this address
  struct ddsi_serdata_plist* const announcement = (struct ddsi_serdata_plist*)made;
  shorten_lease(announcement);
  struct ddsi_domaingv* const domain = (struct ddsi_domaingv*)ddsrt_atomic_ldvoidp(&type->gv);
  uint8_t own_guid[sizeof(ddsi_guid_t)];
  void* const guid = find_parameter(announcement, PID_PARTICIPANT_GUID, sizeof own_guid);
  if (guid != NULL && !judge_participant(domain, announcement->keyhash.value, own_guid))
    memcpy(guid, own_guid, sizeof own_guid);
  return made;
}

static bool is_type(const struct ddsi_sertype* type, const struct ddsi_serdata_ops* ops,
                    const struct ddsi_serdata_ops* ours, const char* name) {
  return type != NULL && (type->serdata_ops == ops || type->serdata_ops == ours) && strcmp(type->type_name, name) == 0;
}

bool collided_guard_domain(struct ddsi_domaingv* domain, collided_judge_participant judge) {
  struct ddsi_sertype* const handshake = domain->pgm_stateless_type;
  struct ddsi_sertype* const exchange = domain->pgm_volatile_type;
  struct ddsi_sertype* const announcement = domain->spdp_type;
  if (!is_type(handshake, &ddsi_serdata_ops_pserop, &message_ops, "ParticipantStatelessMessage") ||
      !is_type(exchange, &ddsi_serdata_ops_pserop, &message_ops, "ParticipantVolatileMessageSecure") ||
      !is_type(announcement, &ddsi_serdata_ops_plist, &announcement_ops, "ParticipantBuiltinTopicData"))
    return false;
  if (judge_participant == NULL) {
    judge_participant = judge;
    message_ops = ddsi_serdata_ops_pserop;
    message_ops.from_ser = message_from_ser;
    message_ops.from_keyhash = message_from_keyhash;
    announcement_ops = ddsi_serdata_ops_plist;
    announcement_ops.from_ser = announcement_from_ser;
  }
  // Cyclone's threads may be reading announcements.
  __atomic_store_n(&handshake->serdata_ops, &message_ops, __ATOMIC_RELEASE);
  __atomic_store_n(&exchange->serdata_ops, &message_ops, __ATOMIC_RELEASE);
  __atomic_store_n(&announcement->serdata_ops, &announcement_ops, __ATOMIC_RELEASE);
  return true;
}

void collided_drop_participant(struct ddsi_domaingv* domain, const uint8_t* prefix) {
  ddsi_guid_t guid;
  memcpy(&guid.prefix, prefix, sizeof guid.prefix);
  guid.entityid.u = 0;
  guid = nn_ntoh_guid(guid);
  guid.entityid.u = NN_ENTITYID_PARTICIPANT;
  (void)ddsi_delete_proxy_participant_by_guid(domain, &guid, ddsrt_time_wallclock(), true);
}
