#pragma once

#include <string>
#include <vector>

#include "client/ros/ros_link.hpp"
#include "idl/ros_types.hpp"

namespace collided::ros {

// Each writes one message; false if a reader accepts no more.

/// Balls at contacts and lines along their normals, as long as the contacts are deep.
bool write_contacts(dds::Writer<MarkerArray>& writer, const std::vector<ShownContact>& contacts,
                    const std::string& frame, std::int64_t stamp_ns);
bool write_contacts(dds::Writer<GzContacts>& writer, const std::vector<ShownContact>& contacts,
                    const std::string& frame, std::int64_t stamp_ns);
/// The objects after a marker that deletes all earlier ones.
bool write_objects(dds::Writer<MarkerArray>& writer, const std::vector<ShownMarker>& objects, const std::string& frame,
                   std::int64_t stamp_ns);
bool write_transforms(dds::Writer<TfMessage>& writer, const std::vector<RosTransform>& transforms);
bool write_diagnostics(dds::Writer<Diagnostics>& writer, const std::vector<RosDiagnostic>& diagnostics,
                       std::int64_t stamp_ns);

}  // namespace collided::ros
