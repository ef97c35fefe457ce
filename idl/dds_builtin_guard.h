#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct ddsi_domaingv;

/// Decides whether to admit a participant that announces itself. `prefix` is the beginning of its GUID, 12 bytes in
/// network order. If not, fills in the GUID (16 bytes) of the domain's own participant, with which Cyclone never starts
/// a handshake.
typedef bool (*collided_judge_participant)(struct ddsi_domaingv* domain, const uint8_t* prefix, uint8_t* own_guid);

/// Wraps two of Cyclone's deserializers that packets of strangers reach in a domain with keys:
///
///   handshake messages  A message with only a key deserializes to a null sample, which Cyclone 0.10 dereferences. It
///                       is refused like other malformed messages. Messages that exchange encryption keys have the same
///                       fault, but only proven participants can send them.
///   announcements       Cyclone would start a handshake with every participant that announces itself, and keep those
///                       with an infinite lease forever. Now `judge` decides, and a lease is at most 30 s.
///
/// judge    the same in every call
/// threads  one at a time
/// returns  false, with nothing changed, if the library at run time is not the Cyclone of the headers at compile time
bool collided_guard_domain(struct ddsi_domaingv* domain, collided_judge_participant judge);

/// Drops a participant as if its lease had expired. Only for `judge`: the calling thread must be one of Cyclone's.
void collided_drop_participant(struct ddsi_domaingv* domain, const uint8_t* prefix);

#ifdef __cplusplus
}
#endif
