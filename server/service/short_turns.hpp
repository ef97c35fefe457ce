#pragma once

namespace collided::service {

/// Asks the kernel to let this thread, and those that it starts from then on, run in turns of 0.1 ms where processors are
/// short: whoever wants short turns waits less for one (EEVDF; Linux 6.12 and later, earlier ones pay no heed). Takes
/// nothing from others: the share of time stays the same.
///
/// returns  whether the kernel took it
/// source   Stoica, Abdel-Wahab, "Earliest Eligible Virtual Deadline First", 1995; sched_setattr(2)
bool ask_for_short_turns();

}  // namespace collided::service
