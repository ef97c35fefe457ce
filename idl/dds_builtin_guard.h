#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct ddsi_domaingv;

/// Decides whether to meet a participant that announces itself. `prefix` is the beginning of its GUID, 12 bytes in network
/// order. If not, fills in the GUID (16 bytes) of the domain's own participant, which Cyclone never meets.
typedef bool (*collided_judge_participant)(struct ddsi_domaingv* domain, const uint8_t* prefix, uint8_t* own_guid);

/// Puts our functions in front of two of Cyclone's deserializers that packets of strangers reach in a domain with keys:
///
///   handshake messages  A message that consists of a key alone deserializes to a null sample, which Cyclone 0.10
///                       dereferences. It is refused like other malformed messages. The messages that exchange keys of
///                       encryption have the same fault, but only proven participants can send them.
///   announcements       Cyclone would begin a handshake with every participant that announces itself, and keep those
///                       with an endless lease forever. `judge` decides, and a lease is at most 30 s.
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
