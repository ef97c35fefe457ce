#pragma once

#include "client/library/connection/connection.hpp"

/// The calls Client::explain_...: the command `explain` (idl/commands.hpp), and its answers read. Any thread.
namespace collided::client {

Result<ExplainedRay> explain_ray(Connection& connection, const RayQuestion& ray, const ExplainOptions& options);
Result<ExplainedPair> explain_pair(Connection& connection, const std::string& a, const std::string& b,
                                   const ExplainOptions& options);
Result<ExplainedFence> explain_fence(Connection& connection, const std::string& name, const ExplainOptions& options);
Result<ExplainedNearest> explain_nearest(Connection& connection, const std::string& name,
                                         const ExplainOptions& options);
Result<ExplainedEvent> explain_event(Connection& connection, std::uint64_t sequence, EventsOf of,
                                     const ExplainOptions& options);

}  // namespace collided::client
